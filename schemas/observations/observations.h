#pragma once

#include <cstddef>

#include "schemas/observations/declared.h"

namespace runcert {

/// Bad records of a recording that are listed one by one, at most.
constexpr std::size_t bad_records_listed_at_most = 1000;

/// "solved by RTKLIB ver.2.4.3 from rover.obs, as the recording's header says", as far as it does.
std::string processing_text(const Processing& processing);

/// The stretch between two epochs of a recording.
WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last);

}  // namespace runcert
