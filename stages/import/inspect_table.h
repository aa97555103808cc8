#pragma once

#include <optional>
#include <string>

#include "stages/import/recording.h"

namespace runcert {

/// Of a table that no format recognises: the lines of an attempt that would describe it, what they
/// leave unsure, and what `inspect` says of the recording so described. Nothing for a text that is
/// no table.
std::optional<std::string> table_text(const RecordingBytes& recording);

}  // namespace runcert
