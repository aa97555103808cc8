#pragma once

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// Says where times and fix types come from: by the format, and where that leaves it open,
/// by what the attempt states (`receivers[].time_source`, `receivers[].solution`), which is a claim
/// that somebody must answer for. Rows whose fix type the recording does not say get the
/// stated one.
void note_origins(const Receiver& receiver, Observations& observations);

/// The same of a table whose rows say their fix type themselves.
void note_origins_of_head(const Receiver& receiver, Observations& head);

}  // namespace runcert
