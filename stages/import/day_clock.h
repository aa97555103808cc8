#pragma once

#include <cstdint>
#include <optional>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"

// For recordings that give times of day, and a date once, now and then, or never. Days are counted
// from 1980-01-06, times of day in nanoseconds since midnight.

namespace runcert {

/// Nothing for a date that is not in the calendar, or not from 1980 to 2200.
std::optional<std::int64_t> day_number(int year, int month, int day);

/// The day of the attempt's start_date; nothing where it states none. Failure at the receiver's
/// place in the attempt where that is no date.
std::optional<std::int64_t> attempted_day(const Receiver& receiver);

/// Carries the day from one time of day to the next: a step back of more than half a day is
/// midnight passed, one forward is midnight passed backwards.
class DayCount {
  public:
    /// The day of the next time of day, counted from that of the first.
    std::int64_t next(std::int64_t time_of_day_ns);

  private:
    std::optional<std::int64_t> last_ns_;
    std::int64_t days_ = 0;
};

/// Whether a time of day is within a minute of midnight, where a date that stands beside it may be
/// that of the other side: loggers write some a few records early or late.
bool is_near_midnight(std::int64_t time_of_day_ns);

/// Gives times of day of UTC, in the order of the recording, their instants.
class DayClock {
  public:
    /// `first_day` is that of the first time of day. Without one, instants count from the midnight
    /// before it as if that were the GPS epoch.
    explicit DayClock(std::optional<std::int64_t> first_day) : first_day_(first_day) {}

    /// The instant of the next time of day, which is on `dated` where the record says so. Within a
    /// minute before midnight the next day's date is early, within one after it that of the day
    /// before is late: both days are counted on all the same. Failure at "time" where the day has
    /// no such second, or is out of span.
    GpsTime next(std::int64_t time_of_day_ns, std::optional<std::int64_t> dated = {});

  private:
    GpsTime midnight_of(std::int64_t day) const;
    void set_date(std::int64_t dated, std::int64_t passed, std::int64_t time_of_day_ns);

    std::optional<std::int64_t> first_day_;
    DayCount count_;
    std::optional<std::int64_t> known_day_;  ///< of which midnight_ and length_ns_ are
    GpsTime midnight_;
    std::int64_t length_ns_ = 0;
};

}  // namespace runcert
