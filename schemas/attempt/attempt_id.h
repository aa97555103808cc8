#pragma once

#include <string_view>

namespace runcert {

/// Whether a text can be an id: 1 to 64 letters, digits, - and _, not beginning with -. An id names
/// files: nothing that a file system or a shell could read otherwise.
bool is_id(std::string_view text);

}  // namespace runcert
