#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// The number that a text holds, correctly rounded, or nothing. The whole text must be one finite
/// decimal number: digits with an optional leading + or -, decimal point and exponent. Blanks,
/// hexadecimal, nan, inf, overflow and underflow to zero are refused.
std::optional<double> parse_double(std::string_view text);

/// Gives the same result as parse_double, without its fast path for short decimals.
std::optional<double> parse_any_double(std::string_view text);

/// The integer that a text holds, or nothing. Only decimal digits with an optional leading + or -
/// are accepted.
std::optional<std::int64_t> parse_integer(std::string_view text);

/// The text with its one comma made a point, where that makes it a number: "440.5" of "440,5".
/// Nothing for any other text.
std::optional<std::string> with_decimal_point(std::string_view text);

/// Whether the character is one of 0 to 9, independent of locale.
constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Whether every character is an ASCII letter or digit, or one of these others.
bool has_only(std::string_view text, std::string_view others);

/// The text with ASCII letters in lower or upper case. Other bytes stay as they are.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// The text with its first letter in upper case.
std::string capitalised(std::string_view text);

/// The text as a sentence: with a full stop at its end unless it ends with one of .?!:, and a
/// capital at its beginning if it begins with a word. A first item that is not letters alone, a
/// name or a key of a file, stays as it is.
std::string sentence(std::string_view text);

/// The text without leading and trailing blanks, tabs and line ends.
std::string_view trim(std::string_view text);

/// A finite number with `decimals` decimals (0 or more), correctly rounded, independent of locale.
/// A value that rounds to zero has no minus sign.
std::string format_fixed(double value, int decimals);

/// Gives the same result as format_fixed, without its fast path for common numbers.
std::string format_any_fixed(double value, int decimals);

/// The candidate to suggest as "did you mean". It is the shortest that begins with the word in any
/// case (two letters or more), or else the first with the smallest Levenshtein distance. Empty
/// if there are no candidates.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

/// Whether every byte is a printable ASCII character, blank included.
bool is_printable_ascii(std::string_view text);

/// Input as a message may quote it: printable ASCII as it is, and every other byte as \xNN. Input
/// longer than `max` bytes is cut to `max` and followed by "...".
std::string escape_for_message(std::string_view bytes, std::size_t max = 40);

/// As `escape_for_message`, with a larger limit, for the name of a file or a title.
std::string shown(std::string_view name);

/// Writes `by` for each `name` in a text. The name must not be empty.
void replace_all(std::string& text, std::string_view name, std::string_view by);

/// A text as one word of a shell command line: in single quotes unless it consists of letters,
/// digits and . _ - / alone. The caller must first remove what would steer a terminal.
std::string shell_word(std::string_view text);

/// The lines of a text, without line ends.
std::vector<std::string> lines_of(const std::string& text);

/// A text as one cell of a CSV file (RFC 4180), quoted if necessary. A text that a spreadsheet
/// would take for a formula gets an apostrophe before it (OWASP, "CSV Injection").
std::string csv_cell(std::string_view text);

/// The text with U+FFFD in place of anything that would steer a terminal, change the writing
/// direction or not be seen: control characters, Unicode's Default_Ignorable_Code_Point, and bytes
/// that are not UTF-8. Line ends and tabs become blanks.
std::string plain_text(std::string_view text);

/// The first character of a text that cannot be shown as it stands, such as "U+1FFFE", or "a byte
/// that is not UTF-8". Noncharacters, control characters other than tab and line feed, line
/// separators, and Unicode's Default_Ignorable_Code_Point. Empty if there is none.
std::optional<std::string> hidden_character(std::string_view text);

/// Whether a text is one line that prints as it stands: UTF-8 without a `hidden_character` or a
/// line feed.
bool is_printable_line(std::string_view text);

}  // namespace runcert
