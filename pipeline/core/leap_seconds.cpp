#include "core/leap_seconds.h"

#include <fmt/format.h>

#include <iterator>

#include "core/calendar.h"
#include "core/failure.h"

namespace runcert {

namespace {

constexpr LeapSecondStep table[] = {
    {1980, 1, 6, 0},  {1981, 7, 1, 1},  {1982, 7, 1, 2},  {1983, 7, 1, 3},  {1985, 7, 1, 4},
    {1988, 1, 1, 5},  {1990, 1, 1, 6},  {1991, 1, 1, 7},  {1992, 7, 1, 8},  {1993, 7, 1, 9},
    {1994, 7, 1, 10}, {1996, 1, 1, 11}, {1997, 7, 1, 12}, {1999, 1, 1, 13}, {2006, 1, 1, 14},
    {2009, 1, 1, 15}, {2012, 7, 1, 16}, {2015, 7, 1, 17}, {2017, 1, 1, 18},
};

/// The UTC midnight that starts the step's day, on the GPS time scale, whole seconds.
std::int64_t start_gps_s(const LeapSecondStep& step) {
    return calendar::days_since_gps_epoch(step.year, step.month, step.day) * 86'400 +
           step.gps_minus_utc_s;
}

/// The last step for which `begun` holds, or the first step where it holds for none.
template <typename Begun>
const LeapSecondStep& last_step(Begun begun) {
    // Searched from the latest step, because most times come after it.
    for (auto step = std::rbegin(table); step != std::rend(table); ++step)
        if (begun(*step)) return *step;
    return table[0];
}

bool day_ends_in_leap_second(std::int64_t day) {
    for (const LeapSecondStep& step : std::span(table).subspan(1))
        if (calendar::days_since_gps_epoch(step.year, step.month, step.day) == day + 1) return true;
    return false;
}

}  // namespace

std::span<const LeapSecondStep> leap_second_table() {
    return table;
}

CalendarTime leap_seconds_known_until() {
    return {.year = 2027, .month = 6, .day = 28};
}

GpsTime gps_from_utc(const CalendarTime& utc) {
    const std::string remedy = "Give a valid date and time in UTC";
    if (const auto problem = calendar::find_problem(utc, 60))
        throw Failure("time", problem->what, remedy);
    const std::int64_t day = calendar::days_since_gps_epoch(utc.year, utc.month, utc.day);
    if (utc.second == 60 && !(utc.hour == 23 && utc.minute == 59 && day_ends_in_leap_second(day)))
        throw Failure("time",
                      fmt::format("no leap second is known at {:04}-{:02}-{:02}T{:02}:{:02}:60Z",
                                  utc.year, utc.month, utc.day, utc.hour, utc.minute),
                      remedy);
    const LeapSecondStep& step = last_step([day](const LeapSecondStep& s) {
        return calendar::days_since_gps_epoch(s.year, s.month, s.day) <= day;
    });
    // Second 60 is checked above; GPS time has none, so it is added after the conversion.
    CalendarTime same_on_gps = utc;
    same_on_gps.second = 0;
    return GpsTime::from_calendar(same_on_gps)
        .plus_nanoseconds((utc.second + step.gps_minus_utc_s) * GpsTime::nanoseconds_per_second);
}

UtcTime utc_from_gps(GpsTime time) {
    constexpr std::int64_t second_ns = GpsTime::nanoseconds_per_second;
    // Steps are compared one second early: that second is the leap second itself.
    const LeapSecondStep& step = last_step([time](const LeapSecondStep& s) {
        return (start_gps_s(s) - 1) * second_ns <= time.nanoseconds();
    });
    const bool in_leap_second =
        step.gps_minus_utc_s > 0 && time.nanoseconds() < start_gps_s(step) * second_ns;
    UtcTime utc;
    utc.time = calendar::from_nanoseconds_since_gps_epoch(time.nanoseconds() -
                                                          step.gps_minus_utc_s * second_ns);
    // Counted with the new offset, the leap second repeats 23:59:59.
    if (in_leap_second) utc.time.second = 60;
    utc.leap_seconds_known = time >= GpsTime() && utc.time < leap_seconds_known_until();
    return utc;
}

}  // namespace runcert
