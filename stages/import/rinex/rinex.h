#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "stages/import/recording.h"

namespace runcert::rinex {

/// Whether the bytes begin as a RINEX observation file, version 2 or 3.
bool recognises(std::string_view bytes);

/// Whether the receiver's recording is RINEX: as the attempt says, or by its content.
bool is_chosen(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::rinex
