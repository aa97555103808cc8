#pragma once

#include <span>

#include "core/gps_time.h"

namespace runcert {

/// From the start of this UTC day on, GPS time is ahead of UTC by `gps_minus_utc_s` seconds.
struct LeapSecondStep {
    int year;
    int month;
    int day;
    int gps_minus_utc_s;
};

/// Every step of GPS - UTC from the GPS epoch (0 s) to the latest (18 s since 2017-01-01), in
/// order: IERS Bulletin C, as in leap-seconds.list of the Paris Observatory.
std::span<const LeapSecondStep> leap_second_table();

/// The UTC day up to which no further leap second can occur: the expiry of the source, 2027-06-28.
CalendarTime leap_seconds_known_until();

}  // namespace runcert
