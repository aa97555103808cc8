#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// The text without what would steer a terminal or turn the direction of writing: control
/// characters (line ends too, which become blanks), bidirectional controls, bytes that are not
/// UTF-8. Each is shown as U+FFFD.
std::string plain_text(std::string_view text);

/// Whether a text is one line that prints as it stands: UTF-8, tabs but no other control
/// characters, no line separators, and nothing that is invisible or changes the direction of what
/// follows.
bool is_printable_line(std::string_view text);

}  // namespace runcert
