#include "stages/import/cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr double largest_deviation = 1e9;
constexpr const char* unreadable =
    "Hand in the recording as the logger wrote it, or describe its columns otherwise";

bool is_nan_or_inf(std::string_view text) {
    const std::string lower =
        lower_case(text.substr(text.starts_with('-') || text.starts_with('+') ? 1 : 0));
    return lower.starts_with("nan") || lower.starts_with("inf") || lower.starts_with("1.#");
}

/// Says why a cell is no number.
[[noreturn]] void refuse_number(const Cell& cell, std::string_view meaning) {
    const std::string quoted = escape_for_message(cell.text);
    if (cell.text.empty())
        cell.fail(fmt::format("the {} is missing", meaning),
                  "Hand in the recording as the receiver wrote it, or another export");
    if (is_nan_or_inf(cell.text))
        cell.fail(fmt::format("the {} is \"{}\", which is no number", meaning, quoted),
                  "A program wrote it where it had no value: hand in what the logger itself wrote");
    if (const auto number = with_decimal_point(cell.text))
        cell.fail(fmt::format("the {} \"{}\" has a decimal comma", meaning, quoted),
                  fmt::format("Export the recording with decimal points ({})", *number));
    cell.fail(fmt::format("the {} \"{}\" is not a number", meaning, quoted), unreadable);
}

/// A decimal number whose point is to stand `shift` digits further to the left.
std::optional<std::int64_t> parse_shifted(std::string_view text, int shift) {
    if (shift == 0) return parse_decimal_nanoseconds(text);
    const bool negative = text.starts_with('-');
    if (negative) text.remove_prefix(1);
    const std::size_t point = std::min(text.find('.'), text.size());
    const auto decimals = static_cast<std::size_t>(shift);
    std::string number(text.substr(0, point));
    if (number.size() <= decimals) number.insert(0, decimals + 1 - number.size(), '0');
    number.insert(number.size() - decimals, 1, '.');
    number += text.substr(std::min(point + 1, text.size()));
    return parse_decimal_nanoseconds(negative ? "-" + number : number);
}

/// A number with an exponent as the same without, where it shows whole seconds at least; empty
/// where it has been rounded to fewer digits, or is none.
std::string without_exponent(std::string_view text) {
    const std::size_t e = text.find_first_of("eE");
    const std::size_t point = text.find('.');
    if (e == std::string_view::npos || point == std::string_view::npos || point > e) return {};
    const auto exponent = parse_integer(text.substr(e + 1));
    const auto decimals = static_cast<std::int64_t>(e - point - 1);
    if (!exponent || *exponent < 0 || *exponent > decimals) return {};
    std::string plain(text.substr(0, point));
    plain += text.substr(point + 1, e - point - 1);
    plain.insert(point + static_cast<std::size_t>(*exponent), 1, '.');
    return plain;
}

}  // namespace

std::string place_in(const RecordingBytes& recording, std::int64_t line, std::size_t column) {
    return fmt::format("{}:{}:{}", recording.name, line, column);
}

std::string Cell::place() const {
    return place_in(*recording, line, column);
}

void Cell::fail(const std::string& what, const std::string& remedy) const {
    throw Failure(place(), what, remedy);
}

std::optional<int> digits_at(std::string_view text, std::size_t at, std::size_t size) {
    if (text.size() < at + size) return std::nullopt;
    int value = 0;
    for (const char c : text.substr(at, size)) {
        if (c < '0' || c > '9') return std::nullopt;
        value = value * 10 + (c - '0');
    }
    return value;
}

double read_real(const Cell& cell, std::string_view meaning) {
    const std::optional<double> value = parse_double(cell.text);
    if (!value) refuse_number(cell, meaning);
    return *value;
}

std::int64_t read_whole(const Cell& cell, std::string_view meaning, std::int64_t least,
                        std::int64_t most) {
    const double value = read_real(cell, meaning);
    if (value != std::floor(value) || value < static_cast<double>(least) ||
        value > static_cast<double>(most))
        cell.fail(fmt::format("the {} \"{}\" is not a whole number from {} to {}", meaning,
                              escape_for_message(cell.text), least, most),
                  unreadable);
    return static_cast<std::int64_t>(value);
}

double read_deviation(const Cell& cell, std::string_view meaning) {
    const double value = read_real(cell, meaning);
    if (value < 0.0 || value > largest_deviation)
        cell.fail(fmt::format("the {} {} cannot be one", meaning, escape_for_message(cell.text)),
                  "A standard deviation is positive, in metres or metres a second");
    return value;
}

std::int64_t read_nanoseconds(const Cell& cell, std::string_view meaning, int shift) {
    const std::optional<std::int64_t> value = parse_shifted(cell.text, shift);
    if (value) return *value;
    if (const auto plain = parse_shifted(without_exponent(cell.text), shift)) return *plain;
    if (parse_double(cell.text))
        cell.fail(fmt::format("the {} \"{}\" is not a plain count of seconds with at most nine "
                              "decimals",
                              meaning, escape_for_message(cell.text)),
                  "A program or spreadsheet has rounded it: hand in what the logger itself wrote");
    refuse_number(cell, meaning);
}

FixType read_rtklib_quality(const Cell& cell) {
    static constexpr std::array<FixType, 8> kinds{
        FixType::none,   FixType::fixed, FixType::float_ambiguities, FixType::sbas, FixType::dgps,
        FixType::single, FixType::ppp,   FixType::dead_reckoning};
    const std::optional<double> value = parse_double(cell.text);
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (value == static_cast<double>(i)) return kinds[i];
    cell.fail(fmt::format("Q \"{}\" is not a fix type", escape_for_message(cell.text)),
              "RTKLIB writes 1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP, 7 dead reckoning, "
              "0 none");
}

std::int16_t read_satellites(const Cell& cell) {
    return static_cast<std::int16_t>(read_whole(cell, "count of satellites", 0, 1000));
}

std::vector<Cell> split_at(const SourceLine& line, const RecordingBytes& recording,
                           char separator) {
    std::vector<Cell> cells;
    for (std::size_t at = 0;;) {
        const std::size_t end = line.text.find(separator, at);
        cells.push_back({line.text.substr(at, end - at), &recording, line.number, at + 1});
        if (end == std::string_view::npos) return cells;
        at = end + 1;
    }
}

std::vector<Cell> split_words(const SourceLine& line, std::string_view text,
                              const RecordingBytes& recording, char separator,
                              std::string_view blanks) {
    const auto is_blank = [&](char c) { return blanks.find(c) != std::string_view::npos; };
    std::vector<Cell> cells;
    cells.reserve(24);
    const auto offset = static_cast<std::size_t>(text.data() - line.text.data());
    const auto cell = [&](std::size_t from, std::size_t to) {
        return Cell{text.substr(from, to - from), &recording, line.number, offset + from + 1};
    };
    const auto skip_blanks = [&](std::size_t at) {
        while (at < text.size() && is_blank(text[at]) && text[at] != separator)
            ++at;
        return at;
    };
    for (std::size_t at = skip_blanks(0); at < text.size();) {
        if (separator != '\0' && text[at] == separator)
            cell(at, at + 1)
                .fail("a field is empty", "Hand in the recording as the logger wrote it");
        std::size_t end = at;
        while (end < text.size() && !is_blank(text[end]) &&
               (separator == '\0' || text[end] != separator))
            ++end;
        cells.push_back(cell(at, end));
        at = skip_blanks(end);
        if (separator != '\0' && at < text.size() && text[at] == separator)
            at = skip_blanks(at + 1);
    }
    return cells;
}

void require_count(std::size_t count, std::size_t expected, const SourceLine& line,
                   const RecordingBytes& recording, bool last, std::string_view header_has,
                   const std::string& remedy) {
    if (count == expected) return;
    const Cell start{line.text, &recording, line.number, 1};
    if (count < expected && last)
        start.fail(fmt::format("the last line is cut off: it has {} fields of {}", count, expected),
                   "Hand in the whole recording, as the logger wrote it");
    start.fail(fmt::format("the line has {} fields; {} {}", count, header_has, expected), remedy);
}

}  // namespace runcert
