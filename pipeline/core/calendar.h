#pragma once

// How the sources of `gps_time.h` share the calendar; of no use outside this folder.

#include <cstdint>
#include <optional>
#include <string>

#include "core/gps_time.h"

namespace runcert::calendar {

/// The first field of a calendar time that is out of range: 0 for the year, 1 for the month, and
/// so on to 5 for the second and 6 for the nanosecond.
struct Problem {
    int field;
    std::string what;
};

/// What is wrong with a calendar time, if anything. `last_second` is 59, or 60 where a leap second
/// is possible. Years from 1600 to 2400 pass: those out of the span of GpsTime are found later.
std::optional<Problem> find_problem(const CalendarTime& time, int last_second);

/// Whole days from 1980-01-06 to a valid date of the Gregorian calendar, negative before it. The
/// date is not checked.
std::int64_t days_since_gps_epoch(int year, int month, int day);

/// Whole seconds from 1980-01-06T00:00:00 to a valid calendar time, days of 86 400 s;
/// negative before it. Leap seconds are not counted, nanoseconds are left out.
std::int64_t seconds_since_gps_epoch(const CalendarTime& time);

/// The inverse, exact, for nanoseconds, days of 86 400 s.
CalendarTime from_nanoseconds_since_gps_epoch(std::int64_t nanoseconds);

/// 10^exponent, exponent 0 to 9 (asserted).
std::int64_t power_of_ten(int exponent);

}  // namespace runcert::calendar
