#pragma once

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// Reads a recording in any supported format into WGS 84 positions (or local-plane ones), with the
/// accuracy they state, in GPS time; every row keeps the line and byte it comes from, and the
/// rows keep the recording's order. `header` is left for the caller.
///
/// `receiver.format` "auto" recognises the format by content, or takes CSV where the receiver
/// names columns. Failure with "file:line:column" where anything is not understood.
Observations import_recording(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert
