#pragma once

// Calendar functions that the sources of `gps_time.h` share. Not for use outside this folder.

#include <cstdint>
#include <optional>
#include <string>

#include "core/gps_time.h"

namespace runcert::calendar {

/// The first calendar field that is out of range: 0 for the year, 1 for the month, and so on to 5
/// for the second and 6 for the nanosecond.
struct Problem {
    int field;
    std::string what;
};

/// The first invalid field of a calendar time, if any. `last_second` is 59, or 60 where a leap
/// second is possible. Years from 1600 to 2400 pass; those outside the span of GpsTime are caught
/// later.
std::optional<Problem> find_problem(const CalendarTime& time, int last_second);

/// Whole days from 1980-01-06 to a date of the Gregorian calendar, negative before it. The date
/// must be valid, which is not checked.
std::int64_t days_since_gps_epoch(int year, int month, int day);

/// Whole seconds from 1980-01-06T00:00:00 to a valid calendar time, with days of 86 400 s. Negative
/// before that instant. Leap seconds are not counted, and nanoseconds are ignored.
std::int64_t seconds_since_gps_epoch(const CalendarTime& time);

/// The calendar time a number of nanoseconds after 1980-01-06T00:00:00, exact, with days of
/// 86 400 s.
CalendarTime from_nanoseconds_since_gps_epoch(std::int64_t nanoseconds);

/// 10^exponent, for exponents 0 to 9 (asserted).
std::int64_t power_of_ten(int exponent);

}  // namespace runcert::calendar
