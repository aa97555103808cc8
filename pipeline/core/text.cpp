#include "core/text.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/decimal.h"

namespace runcert {

namespace {

constexpr std::uint64_t exactly_in_double = std::uint64_t{1} << 53;

bool is_printable(char c) {
    return c >= ' ' && c <= '~';
}

std::string_view without_plus(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    return text;
}

/// Whether a digit other than 0 stands before the exponent.
bool has_nonzero_mantissa(std::string_view number) {
    const std::string_view mantissa = number.substr(0, number.find_first_of("eE"));
    return mantissa.find_first_of("123456789") != std::string_view::npos;
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::optional<double> parse_double(std::string_view text) {
    // The quotient of two exact doubles is correctly rounded, which covers nearly all numbers in
    // tables.
    if (const auto plain = read_plain_decimal(text); plain && plain->digits <= exactly_in_double) {
        const double value = static_cast<double>(plain->digits) /
                             exact_powers_of_ten[static_cast<std::size_t>(plain->decimals)];
        return plain->negative ? -value : value;
    }
    return parse_any_double(text);
}

std::optional<double> parse_any_double(std::string_view text) {
    const bool has_sign = text.starts_with('+') || text.starts_with('-');
    const std::string_view unsigned_text = text.substr(has_sign ? 1 : 0);
    // Refuses nan, inf and a second sign.
    if (unsigned_text.empty() || !(is_digit(unsigned_text[0]) || unsigned_text[0] == '.'))
        return std::nullopt;
    const std::string_view number = without_plus(text);
    const char* const end = number.data() + number.size();
    double value = 0.0;
    const auto result = fast_float::from_chars(number.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end || !std::isfinite(value)) return std::nullopt;
    if (value == 0.0 && has_nonzero_mantissa(number)) return std::nullopt;
    return value;
}

std::optional<std::string> with_decimal_point(std::string_view text) {
    if (std::count(text.begin(), text.end(), ',') != 1) return std::nullopt;
    std::string number(text);
    number[number.find(',')] = '.';
    if (!parse_double(number)) return std::nullopt;
    return number;
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
    const std::string_view number = without_plus(text);
    if (number.size() < text.size() && number.starts_with('-')) return std::nullopt;
    const char* const end = number.data() + number.size();
    std::int64_t value = 0;
    const auto result = std::from_chars(number.data(), end, value);
    if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
    return value;
}

std::string lower_case(std::string_view text) {
    std::string lower(text);
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return lower;
}

std::string upper_case(std::string_view text) {
    std::string upper(text);
    for (char& c : upper)
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    return upper;
}

bool has_only(std::string_view text, std::string_view others) {
    return std::ranges::all_of(text, [&](char c) {
        return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
               others.find(c) != std::string_view::npos;
    });
}

std::string capitalised(std::string_view text) {
    return upper_case(text.substr(0, 1)).append(text.substr(std::min<std::size_t>(1, text.size())));
}

std::string sentence(std::string_view text) {
    if (text.empty()) return {};
    const std::string_view word = text.substr(0, text.find_first_of(" ,"));
    const bool plain = std::all_of(word.begin(), word.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-';
    });
    std::string whole = plain ? capitalised(text) : std::string(text);
    if (std::string_view(".?!:").find(whole.back()) == std::string_view::npos) whole += '.';
    return whole;
}

std::string_view trim(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n\v\f";
    const std::size_t first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string format_fixed(double value, int decimals) {
    std::array<char, fixed_text_room> quick;
    if (char* const end = write_fixed_quickly(quick.data(), value, decimals))
        return std::string(quick.data(), end);
    return format_any_fixed(value, decimals);
}

std::string format_any_fixed(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (text.starts_with('-') && text.find_first_not_of("-0.") == std::string::npos)
        text.erase(0, 1);
    return text;
}

std::string shown(std::string_view name) {
    return escape_for_message(name, 120);
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates) {
    std::string_view begun;
    for (const std::string_view candidate : candidates)
        if (word.size() >= 2 && lower_case(candidate).starts_with(lower_case(word)) &&
            (begun.empty() || candidate.size() < begun.size()))
            begun = candidate;
    if (!begun.empty()) return begun;
    const auto found = std::min_element(candidates.begin(), candidates.end(),
                                        [word](std::string_view a, std::string_view b) {
                                            return edit_distance(word, a) < edit_distance(word, b);
                                        });
    return found == candidates.end() ? std::string_view{} : *found;
}

bool is_printable_ascii(std::string_view text) {
    return std::all_of(text.begin(), text.end(), is_printable);
}

std::string escape_for_message(std::string_view bytes, std::size_t max) {
    std::string escaped;
    for (const char c : bytes.substr(0, max)) {
        if (is_printable(c))
            escaped += c;
        else
            escaped += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
    if (bytes.size() > max) escaped += "...";
    return escaped;
}

void replace_all(std::string& text, std::string_view name, std::string_view by) {
    for (std::size_t at = text.find(name); at != std::string::npos;
         at = text.find(name, at + by.size()))
        text.replace(at, name.size(), by);
}

std::string shell_word(std::string_view text) {
    if (!text.empty() && has_only(text, "._-/")) return std::string(text);
    std::string quoted = "'";
    for (const char c : text)
        quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        lines.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return lines;
}

namespace {

/// Characters that make a spreadsheet take a cell for a formula.
constexpr std::string_view formula_begins = "=+-@\t\r";

}  // namespace

std::string csv_cell(std::string_view text) {
    std::string cell;
    if (!text.empty() && formula_begins.find(text.front()) != std::string_view::npos) cell = "'";
    cell += text;
    if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
    std::string quoted = "\"";
    for (const char c : cell)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

namespace {

constexpr std::string_view replacement = "\xEF\xBF\xBD";

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 1;
};

/// The first character of a text that is not empty. Nothing if it is not UTF-8.
std::optional<Character> first_character(std::string_view text) {
    const auto byte = [&](std::size_t at) {
        return static_cast<std::uint32_t>(static_cast<unsigned char>(text[at]));
    };
    const std::uint32_t lead = byte(0);
    if (lead < 0x80) return Character{lead, 1};
    const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return std::nullopt;
    std::uint32_t code = lead & (0xFFU >> (bytes + 1));
    for (std::size_t at = 1; at < bytes; ++at) {
        if ((byte(at) & 0xC0U) != 0x80U) return std::nullopt;
        code = code << 6U | (byte(at) & 0x3FU);
    }
    constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
    if (code < least[bytes] || code > 0x10FFFF || surrogate) return std::nullopt;
    return Character{code, bytes};
}

/// Unicode's Default_Ignorable_Code_Point, of version 15.1: first and last of each range.
constexpr std::uint32_t default_ignorable[][2] = {
    {0xAD, 0xAD},       {0x34F, 0x34F},    {0x61C, 0x61C},   {0x115F, 0x1160}, {0x17B4, 0x17B5},
    {0x180B, 0x180F},   {0x200B, 0x200F},  {0x202A, 0x202E}, {0x2060, 0x206F}, {0x3164, 0x3164},
    {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF},  {0xFFA0, 0xFFA0}, {0xFFF0, 0xFFF8}, {0x1BCA0, 0x1BCA3},
    {0x1D173, 0x1D17A}, {0xE0000, 0xE0FFF}};

bool is_shown(std::uint32_t code) {
    const bool control = code < 0x20 || (code >= 0x7F && code < 0xA0);
    const bool separator = code == 0x2028 || code == 0x2029;
    const bool ignorable = std::ranges::any_of(default_ignorable, [code](const auto& range) {
        return code >= range[0] && code <= range[1];
    });
    const bool no_character = (code & 0xFFFEU) == 0xFFFE || (code >= 0xFDD0 && code <= 0xFDEF);
    return !control && !separator && !ignorable && !no_character;
}

}  // namespace

std::string plain_text(std::string_view text) {
    std::string plain;
    plain.reserve(text.size());
    while (!text.empty()) {
        const auto character = first_character(text);
        const std::size_t bytes = character ? character->bytes : 1;
        if (text.front() == '\n' || text.front() == '\r' || text.front() == '\t')
            plain += ' ';
        else if (character && is_shown(character->code))
            plain += text.substr(0, bytes);
        else
            plain += replacement;
        text.remove_prefix(bytes);
    }
    return plain;
}

std::optional<std::string> hidden_character(std::string_view text) {
    while (!text.empty()) {
        const auto character = first_character(text);
        if (!character) return "a byte that is not UTF-8";
        const std::uint32_t code = character->code;
        if (code != '\t' && code != '\n' && !is_shown(code)) return fmt::format("U+{:04X}", code);
        text.remove_prefix(character->bytes);
    }
    return std::nullopt;
}

bool is_printable_line(std::string_view text) {
    return text.find('\n') == std::string_view::npos && !hidden_character(text);
}

}  // namespace runcert
