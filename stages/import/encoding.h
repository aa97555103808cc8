#pragma once

#include <optional>
#include <string>

#include "stages/import/recording.h"

namespace runcert {

/// Whether the bytes begin as UTF-16 text: with its byte order mark, or with every second byte NUL
/// as of letters that ASCII has, too.
bool is_utf16(std::string_view bytes);

/// A UTF-16 recording as UTF-8 (Unicode 15, section 3.9), without its byte order mark. Failure,
/// with the byte, for a surrogate that stands alone and for half a code unit at the end.
std::string utf8_of_utf16(const RecordingBytes& recording);

}  // namespace runcert
