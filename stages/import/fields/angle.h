#pragma once

#include <optional>
#include <string_view>

#include "stages/import/cell.h"
#include "stages/import/resolution.h"

namespace runcert {

// Latitudes and longitudes as any text writes them.

/// How a table writes angles that are one number.
enum class AngleForm { degrees, degrees_and_minutes };  ///< the second as NMEA does, dddmm.mmmm

/// The halves of a cell that holds two values, which blanks or one , ; or / parts; the second is
/// empty where nothing does.
std::array<Cell, 2> halves_of(const Cell& cell);

/// A latitude or longitude as written: with a sign, or with the letter of its hemisphere before or
/// behind it or in a cell of its own; in degrees, or in degrees and minutes, or degrees, minutes
/// and seconds ("-31 36 00.00", "31°36'00.0\"S", "31:36:00").
class WrittenAngle {
  public:
    /// `hemisphere` is the cell of its own, null where there is none.
    WrittenAngle(const Cell& cell, bool is_latitude, AngleForm form = AngleForm::degrees,
                 const Cell* hemisphere = nullptr);

    /// In degrees, south and west negative. Failure where it is no angle, or two, or where sign and
    /// letter contradict each other.
    double degrees() const;

    /// Its last number, and what that counts, for the decimals that are written.
    std::string_view last_number() const { return count_ == 1 ? cell_.text : parts_[count_ - 1]; }
    CoordinateUnit unit() const;

  private:
    Cell part(std::size_t i) const;

    std::string_view meaning_;
    Cell cell_;  ///< without the letter
    const Cell* hemisphere_;
    AngleForm form_;
    char letter_ = '\0';                     ///< lower case; of the cell itself
    std::size_t count_ = 1;                  ///< numbers in the cell
    std::array<std::string_view, 3> parts_;  ///< those, where there are several
};

/// The hemisphere that a cell of its own names by a letter or word: 1 north or east, -1 south or
/// west, 0 for another text.
int hemisphere_in(std::string_view cell, bool of_latitude);

}  // namespace runcert
