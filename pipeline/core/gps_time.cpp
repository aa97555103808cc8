#include "core/gps_time.h"

#include <fmt/format.h>

#include <cassert>
#include <chrono>

#include "core/calendar.h"
#include "core/failure.h"

namespace runcert {

namespace {

using std::chrono::sys_days;

constexpr sys_days gps_epoch{std::chrono::year{1980} / 1 / 6};

Failure out_of_span() {
    return {"time", "the instant is outside the years 1687 to 2272",
            "Check the date, the week number or the time offset"};
}

std::int64_t checked_sum(std::int64_t a, std::int64_t b) {
    std::int64_t sum = 0;
    if (__builtin_add_overflow(a, b, &sum)) throw out_of_span();
    return sum;
}

std::int64_t checked_product(std::int64_t a, std::int64_t b) {
    std::int64_t product = 0;
    if (__builtin_mul_overflow(a, b, &product)) throw out_of_span();
    return product;
}

}  // namespace

namespace calendar {

std::optional<Problem> find_problem(const CalendarTime& time, int last_second) {
    using namespace std::chrono;
    // Wider than the span of GpsTime: years in between are reported as out of span.
    if (time.year < 1600 || time.year > 2400)
        return Problem{0, fmt::format("the year {} is not 1687 to 2272", time.year)};
    if (time.month < 1 || time.month > 12)
        return Problem{1, fmt::format("the month {} is not 1 to 12", time.month)};
    const auto month_number = static_cast<unsigned>(time.month);
    const auto last_day = static_cast<unsigned>(
        year_month_day_last{year{time.year}, month_day_last{month{month_number}}}.day());
    if (time.day < 1 || time.day > static_cast<int>(last_day))
        return Problem{2, fmt::format("the day {} is not 1 to {} in {:04}-{:02}", time.day,
                                      last_day, time.year, time.month)};
    if (time.hour < 0 || time.hour > 23)
        return Problem{3, fmt::format("the hour {} is not 0 to 23", time.hour)};
    if (time.minute < 0 || time.minute > 59)
        return Problem{4, fmt::format("the minute {} is not 0 to 59", time.minute)};
    if (time.second < 0 || time.second > last_second)
        return Problem{5, fmt::format("the second {} is not 0 to {}", time.second, last_second)};
    if (time.nanosecond < 0 || time.nanosecond >= GpsTime::nanoseconds_per_second)
        return Problem{6, fmt::format("the nanosecond {} is not 0 to 999999999", time.nanosecond)};
    return std::nullopt;
}

std::int64_t days_since_gps_epoch(int year, int month, int day) {
    const sys_days date{std::chrono::year{year} / std::chrono::month{static_cast<unsigned>(month)} /
                        std::chrono::day{static_cast<unsigned>(day)}};
    return (date - gps_epoch).count();
}

std::int64_t seconds_since_gps_epoch(const CalendarTime& time) {
    const std::int64_t days = days_since_gps_epoch(time.year, time.month, time.day);
    return ((days * 24 + time.hour) * 60 + time.minute) * 60 + time.second;
}

CalendarTime from_nanoseconds_since_gps_epoch(std::int64_t nanoseconds) {
    std::int64_t days = nanoseconds / GpsTime::nanoseconds_per_day;
    std::int64_t rest = nanoseconds % GpsTime::nanoseconds_per_day;
    if (rest < 0) {
        rest += GpsTime::nanoseconds_per_day;
        --days;
    }
    const std::chrono::year_month_day date{gps_epoch + std::chrono::days{days}};
    const auto second_of_day = static_cast<int>(rest / GpsTime::nanoseconds_per_second);
    return {.year = static_cast<int>(date.year()),
            .month = static_cast<int>(static_cast<unsigned>(date.month())),
            .day = static_cast<int>(static_cast<unsigned>(date.day())),
            .hour = second_of_day / 3600,
            .minute = second_of_day / 60 % 60,
            .second = second_of_day % 60,
            .nanosecond = rest % GpsTime::nanoseconds_per_second};
}

std::int64_t power_of_ten(int exponent) {
    assert(exponent >= 0 && exponent <= 9);
    std::int64_t power = 1;
    for (int i = 0; i < exponent; ++i)
        power *= 10;
    return power;
}

}  // namespace calendar

GpsTime GpsTime::from_week(int week, std::int64_t nanoseconds_of_week) {
    if (nanoseconds_of_week < 0 || nanoseconds_of_week > nanoseconds_per_week)
        throw Failure("time",
                      fmt::format("{} ns of the week is not 0 to 604800 s", nanoseconds_of_week),
                      "Give a time of week");
    return GpsTime(checked_sum(checked_product(week, nanoseconds_per_week), nanoseconds_of_week));
}

GpsTime GpsTime::from_calendar(const CalendarTime& gps) {
    if (const auto problem = calendar::find_problem(gps, 59))
        throw Failure("time", problem->what, "Give a valid date and time on the GPS time scale");
    const std::int64_t seconds = calendar::seconds_since_gps_epoch(gps);
    return GpsTime(checked_sum(checked_product(seconds, nanoseconds_per_second), gps.nanosecond));
}

CalendarTime GpsTime::calendar() const {
    return calendar::from_nanoseconds_since_gps_epoch(nanoseconds_);
}

std::int64_t GpsTime::nanoseconds_since(GpsTime earlier) const {
    std::int64_t difference = 0;
    if (__builtin_sub_overflow(nanoseconds_, earlier.nanoseconds_, &difference))
        throw Failure("time", "the two instants are more than 292 years apart", "Check the dates");
    return difference;
}

double GpsTime::seconds_since(GpsTime earlier) const {
    constexpr std::int64_t exact_in_double = std::int64_t{1} << 53;
    const std::int64_t difference = nanoseconds_since(earlier);
    if (difference > -exact_in_double && difference < exact_in_double)
        return static_cast<double>(difference) / 1e9;
    const std::int64_t whole_s = difference / nanoseconds_per_second;
    return static_cast<double>(whole_s) +
           static_cast<double>(difference % nanoseconds_per_second) / 1e9;
}

GpsTime GpsTime::plus_nanoseconds(std::int64_t nanoseconds) const {
    return GpsTime(checked_sum(nanoseconds_, nanoseconds));
}

}  // namespace runcert
