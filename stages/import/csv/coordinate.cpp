#include "stages/import/csv/coordinate.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"

namespace runcert::csv {

std::array<Cell, 2> halves_of(const Cell& cell) {
    Cell first = cell, second = cell;
    const std::size_t end = std::min(cell.text.find_first_of(" \t,;/"), cell.text.size());
    const std::size_t begin =
        std::min(cell.text.find_first_not_of(" \t,;/", end), cell.text.size());
    first.text = cell.text.substr(0, end);
    second.text = cell.text.substr(begin);
    second.column += begin;
    return {first, second};
}

double Coordinate::value() const {
    const bool has_point = number.text.find('.') != std::string_view::npos;  // "1,5" is one
    if (has_point && parse_double(halves_of(number)[0].text) &&
        parse_double(halves_of(number)[1].text))
        number.fail(fmt::format("the {} \"{}\" is two numbers, both coordinates in one cell",
                                meaning, escape_for_message(number.text)),
                    "Name this column for latitude and for longitude: it is read in that order");
    const double degrees = read_real(number, meaning);
    if (letter != '\0' && degrees < 0.0)
        number.fail(fmt::format("the {} has a sign, and the letter of a hemisphere", meaning),
                    "Hand in the table as the logger wrote it, or another export");
    return letter == 's' || letter == 'w' ? -degrees : degrees;
}

Coordinate coordinate_in(const Cell& cell, std::string_view meaning, std::string_view letters) {
    Coordinate coordinate{.number = cell, .meaning = meaning};
    std::string_view& text = coordinate.number.text;
    if (text.empty()) return coordinate;
    const auto lower = [](char c) { return static_cast<char>(c | 0x20); };
    if (letters.find(lower(text.back())) != std::string_view::npos) {
        coordinate.letter = lower(text.back());
        text.remove_suffix(1);
    } else if (letters.find(lower(text.front())) != std::string_view::npos) {
        coordinate.letter = lower(text.front());
        text.remove_prefix(1);
        ++coordinate.number.column;
    }
    constexpr std::string_view degree_sign = "\xc2\xb0";
    if (text.ends_with(degree_sign)) text.remove_suffix(degree_sign.size());
    text = trim(text);
    return coordinate;
}

}  // namespace runcert::csv
