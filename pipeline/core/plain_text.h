#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// The text without what would steer a terminal or turn the direction of writing: control
/// characters (line ends too, which become blanks), bidirectional controls, bytes that are not
/// UTF-8. Each is shown as U+FFFD.
std::string plain_text(std::string_view text);

/// The first character of a text that cannot be shown as it stands: one that is no character, a
/// control character other than tab and line feed, a line separator, or one that changes the
/// direction of writing. As "U+1FFFE"; bytes that are not UTF-8 as "a byte that is not UTF-8".
/// Nothing where there is none.
std::optional<std::string> hidden_character(std::string_view text);

/// Whether a text is one line that prints as it stands: UTF-8, and none of those, nor a line feed.
bool is_printable_line(std::string_view text);

}  // namespace runcert
