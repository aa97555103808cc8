#include "stages/import/day_clock.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"

namespace runcert {
namespace {

constexpr std::int64_t day_ns = GpsTime::nanoseconds_per_day;
constexpr std::int64_t most_days = 36'500;
constexpr std::int64_t near_midnight_ns = 60 * GpsTime::nanoseconds_per_second;

}  // namespace

std::optional<std::int64_t> day_number(int year, int month, int day) {
    using namespace std::chrono;
    const year_month_day date{std::chrono::year{year} /
                              std::chrono::month{static_cast<unsigned>(month)} /
                              std::chrono::day{static_cast<unsigned>(day)}};
    if (!date.ok() || year < 1980 || year > 2200) return std::nullopt;
    constexpr sys_days gps_epoch{std::chrono::year{1980} / 1 / 6};
    return (sys_days{date} - gps_epoch).count();
}

std::optional<std::int64_t> attempted_day(const Receiver& receiver) {
    const std::string_view text = receiver.start_date;
    if (text.empty()) return std::nullopt;
    const auto year = digits_at(text, 0, 4);
    const auto month = digits_at(text, 5, 2);
    const auto day = digits_at(text, 8, 2);
    const bool separated = text.size() == 10 && text[4] == '-' && text[7] == '-';
    const auto found =
        separated && year && month && day ? day_number(*year, *month, *day) : std::nullopt;
    if (!found)
        throw Failure(receiver.place,
                      fmt::format("start_date \"{}\" is not a date", escape_for_message(text)),
                      "Write it as 2023-07-11: year, month, day");
    return found;
}

std::int64_t DayCount::next(std::int64_t time_of_day_ns) {
    if (last_ns_ && time_of_day_ns < *last_ns_ - day_ns / 2) ++days_;
    if (last_ns_ && time_of_day_ns > *last_ns_ + day_ns / 2) --days_;
    last_ns_ = time_of_day_ns;
    return days_;
}

bool is_near_midnight(std::int64_t time_of_day_ns) {
    return time_of_day_ns < near_midnight_ns || time_of_day_ns >= day_ns - near_midnight_ns;
}

void DayClock::set_date(std::int64_t dated, std::int64_t passed, std::int64_t time_of_day_ns) {
    const std::int64_t ahead = first_day_ ? dated - *first_day_ - passed : 0;
    const bool before_midnight = time_of_day_ns > day_ns / 2;
    if (is_near_midnight(time_of_day_ns) && ahead == (before_midnight ? 1 : -1)) return;
    first_day_ = dated - passed;
}

GpsTime DayClock::midnight_of(std::int64_t day) const {
    const GpsTime shown = GpsTime::from_nanoseconds(day * day_ns);
    return first_day_ ? gps_from_utc(shown.calendar()) : shown;
}

GpsTime DayClock::next(std::int64_t time_of_day_ns, std::optional<std::int64_t> dated) {
    DayCount count = count_;
    const std::int64_t passed = count.next(time_of_day_ns);
    if (std::abs(passed) > most_days)
        throw Failure("time", "midnight has passed more often than in a hundred years",
                      "Hand in the recording as the logger wrote it");
    if (dated) set_date(*dated, passed, time_of_day_ns);
    const std::int64_t day = first_day_.value_or(0) + passed;
    if (known_day_ != day) {
        midnight_ = midnight_of(day);
        length_ns_ = midnight_of(day + 1).nanoseconds_since(midnight_);
        known_day_ = day;
    }
    // A day without a date may have had a leap second.
    if (first_day_ && time_of_day_ns >= length_ns_)
        throw Failure("time", "that day had no second 60",
                      "The record is unreadable; hand in the recording as the logger wrote it");
    count_ = count;
    return midnight_.plus_nanoseconds(time_of_day_ns);
}

}  // namespace runcert
