#pragma once

#include <array>
#include <string_view>

#include "stages/import/cell.h"

namespace runcert::csv {

/// The halves of a cell that holds two values, which blanks or one , ; or / parts; the second is
/// empty where nothing does.
std::array<Cell, 2> halves_of(const Cell& cell);

/// A latitude or longitude as written: with a sign, or with the letter of its hemisphere.
struct Coordinate {
    Cell number;
    std::string_view meaning;
    char letter = '\0';  ///< lower case

    /// In degrees, south and west negative. Failure where it is no number, or two.
    double value() const;
};

/// The coordinate in a cell; `letters` are those of its two hemispheres, in lower case ("ns").
Coordinate coordinate_in(const Cell& cell, std::string_view meaning, std::string_view letters);

}  // namespace runcert::csv
