#pragma once

#include <string>

#include "stages/import/gpsbabel/gpsbabel.h"

namespace runcert::gpsbabel {

/// Has gpsbabel read a recording as its format `type` (checked by type_of) and write GPX 1.0, which
/// keeps speeds, courses and decimals of seconds. gpsbabel runs for at most two minutes, with 2 GiB
/// of memory and of output. Failure where it is not installed, and with its own words where it
/// cannot read the recording.
Converted convert(const std::string& type, const RecordingBytes& recording);

}  // namespace runcert::gpsbabel
