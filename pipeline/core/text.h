#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// The number a text holds, correctly rounded, or nothing. The whole text must be one finite
/// decimal number: digits with an optional leading + or -, decimal point and exponent. No blanks,
/// hexadecimal, nan or inf; nothing too large, and nothing so small that it would become zero.
std::optional<double> parse_double(std::string_view text);

/// The same, the plain way for every text: parse_double has a quicker one for short decimals.
std::optional<double> parse_any_double(std::string_view text);

/// The integer a text holds, or nothing: decimal digits with an optional leading + or -, no more.
std::optional<std::int64_t> parse_integer(std::string_view text);

/// Whether this is one of 0 to 9, independent of locale.
constexpr bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// The text with A to Z in lower case, a to z in upper case; other bytes as they are.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// The text with its first letter in upper case.
std::string capitalised(std::string_view text);

/// A text as a sentence: a full stop at its end, and a capital at its beginning where it begins
/// with a word. What is no word of letters alone, a name or a key of a file, stays as it is.
std::string sentence(std::string_view text);

/// The text without blanks, tabs and line ends at both ends.
std::string_view trim(std::string_view text);

/// A finite number with this many decimals (0 or more), correctly rounded, independent of locale. A
/// value that rounds to zero has no minus sign.
std::string format_fixed(double value, int decimals);

/// The same, the plain way for every number: format_fixed has a quicker one for most.
std::string format_any_fixed(double value, int decimals);

/// For "did you mean": of the candidates that begin with the word in any case (two letters or
/// more), the shortest; else that with the smallest edit distance (Levenshtein), the first of
/// equals. Empty where there are no candidates.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

/// Whether every byte is a printable ASCII character, blank included.
bool is_printable_ascii(std::string_view text);

/// A piece of input as a message may quote it: printable ASCII as it is, every other byte as
/// \xNN, and "..." where more than `max` bytes of input were cut to `max`.
std::string escape_for_message(std::string_view bytes, std::size_t max = 40);

/// The same of a file's name or a title, which may be longer.
std::string shown(std::string_view name);

/// A text as one word of a command line to be pasted into a shell: in single quotes unless it is
/// made of letters, digits and . _ - / alone. What would steer a terminal must be taken out before.
std::string shell_word(std::string_view text);

/// The lines of a text, without their ends.
std::vector<std::string> lines_of(const std::string& text);

/// A text as one cell of a CSV file (RFC 4180), quoted where it must be. One that a spreadsheet
/// would take for a formula gets an apostrophe before it (OWASP, "CSV Injection").
std::string csv_cell(std::string_view text);

}  // namespace runcert
