#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// The text with U+FFFD in place of anything that would steer a terminal or change the writing
/// direction: control characters, bidirectional controls, and bytes that are not UTF-8. Line ends
/// and tabs become blanks.
std::string plain_text(std::string_view text);

/// The first character of a text that cannot be shown as it stands, such as "U+1FFFE", or "a byte
/// that is not UTF-8". These are noncharacters, control characters other than tab and line feed,
/// line separators, and characters that change the writing direction. Empty if there is none.
std::optional<std::string> hidden_character(std::string_view text);

/// Whether a text is one line that prints as it stands: UTF-8 without a `hidden_character` or a
/// line feed.
bool is_printable_line(std::string_view text);

}  // namespace runcert
