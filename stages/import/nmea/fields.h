#pragma once

#include <cstdint>
#include <limits>

#include "core/angle.h"
#include "core/optional_number.h"
#include "schemas/observations/observations.h"
#include "stages/import/cell.h"

namespace runcert::nmea {

// All fail at the cell whose text they do not understand.

/// Nanoseconds since midnight of "hhmmss" or "hhmmss.ss" with up to nine decimals, exact. A second
/// 60 is one at 23:59 only.
std::int64_t read_time_of_day(const Cell& cell);

/// The day of "ddmmyy", counted from 1980-01-06; years 80 to 99 are 1980 to 1999.
std::int64_t read_date(const Cell& cell);

/// The day of separate day, month and full year.
std::int64_t read_date(const Cell& day, const Cell& month, const Cell& year);

/// The angle of "ddmm.mmmm" or "dddmm.mmmm", with any decimals, rounded once; `positive` and
/// `negative` are the letters of its hemispheres. From 0 to `most_degrees` either way.
Angle read_angle(const Cell& cell, const Cell& hemisphere, char positive, char negative,
                 int most_degrees);

/// A number, and the step of its last decimal: how finely it is written.
struct WrittenNumber {
    OptionalReal value;
    double step = std::numeric_limits<double>::infinity();

    /// The same in another unit.
    WrittenNumber times(double factor) const;
};

/// An empty cell is an unknown number. Anything outside `least` to `most` fails.
WrittenNumber read_written(const Cell& cell, std::string_view meaning, double least, double most);

/// The more finely written of two; the first of equals.
const WrittenNumber& finer(const WrittenNumber& a, const WrittenNumber& b);

/// The fix type of GGA's quality, 0 to 9; unknown for an empty one.
FixType read_quality(const Cell& cell);

/// The fix type of a letter of the mode indicator (NMEA 0183 version 2.3 on).
FixType fix_of_mode(char mode);

}  // namespace runcert::nmea
