#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "stages/import/cell.h"

// For recordings that give times of day, and a date once, now and then, or never. Days are counted
// from 1980-01-06, times of day in nanoseconds since midnight.
namespace runcert {

/// What a recording's clock shows: GPS time, UTC, or a local time by its offset from UTC.
struct Clock {
    bool is_gps = true;
    std::int64_t ahead_of_utc_ns = 0;

    static const Clock gps, utc, jst;  ///< jst: Japan Standard Time, UTC + 9 h
    static Clock local(double utc_offset_h) {
        return {false, std::llround(utc_offset_h * 3600.0) * GpsTime::nanoseconds_per_second};
    }
    friend constexpr bool operator==(const Clock&, const Clock&) = default;
};

inline constexpr Clock Clock::gps{true, 0};

inline constexpr Clock Clock::utc{false, 0};

inline constexpr Clock Clock::jst{false, std::int64_t{9} * 3600 * GpsTime::nanoseconds_per_second};

/// The nearest whole number of seconds.
constexpr std::int64_t whole_seconds(std::int64_t nanoseconds) {
    constexpr std::int64_t second = GpsTime::nanoseconds_per_second;
    return (nanoseconds + (nanoseconds < 0 ? -second : second) / 2) / second;
}

// All fail at the cell that holds what cannot be read. Exact: no time is ever a double.

/// What a time of day says of its zone, behind it: Z, UTC, GMT, CET, "+02:00", "-0500",
/// "GMT+09:30".
struct WrittenZone {
    std::size_t begin = 0;  ///< where it begins in the text
    std::int64_t ahead_of_utc_min = 0;
};

/// Nothing where there is none, or none that is read.
std::optional<WrittenZone> zone_of(std::string_view time_of_day);

/// The clock of a time of day that may say its zone, which is taken off `text`; else the stated
/// one. Failure where it says one and the attempt another.
Clock clock_at(const Cell& time_of_day, Clock stated, std::string_view& text);

/// The instant at which the clock shows this date ("2023-07-11" or "2023/07/11") and time of day
/// ("06:04:30", with any decimals up to the ninth, and its zone). Second 60 where UTC had a leap
/// second.
GpsTime read_calendar(const Cell& date, const Cell& time_of_day, Clock clock);

/// The same from one cell: date, T or a blank, time of day.
GpsTime read_iso(const Cell& cell, Clock clock);

/// The instant at which the clock shows this full week number and these seconds of the week, or
/// milliseconds where `shift` is 3.
GpsTime read_week_time(const Cell& week, const Cell& seconds_of_week, Clock clock, int shift = 0);

/// What `find` gives; its Failure becomes one at the record's place.
GpsTime instant_of_record(const RecordingBytes& recording, const RecordPlace& place,
                          const std::function<GpsTime()>& find);

/// The instant of a UTC calendar time that a binary record gives. Failure at its place.
GpsTime instant_of_utc(const CalendarTime& utc, const RecordingBytes& recording,
                       const RecordPlace& place);

/// The instant of a count of seconds since 1970-01-01 UTC, without leap seconds; of milliseconds
/// where `shift` is 3, as in read_nanoseconds.
GpsTime read_unix(const Cell& cell, int shift = 0);

/// The instant at which the clock shows a calendar time. Failure at the cell where there is none.
GpsTime instant_of(const CalendarTime& shown, Clock clock, const Cell& cell);

/// The same of nanoseconds that a binary record gives. Failure at its place.
GpsTime instant_of_unix(std::int64_t nanoseconds, const RecordingBytes& recording,
                        const RecordPlace& place);

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

/// Nanoseconds since midnight of "hhmmss" or "hhmmss.ss", exact; nothing for any other text. Digits
/// after the ninth decimal must be zero. A second 60 is one at 23:59 only.
std::optional<std::int64_t> nanoseconds_of_day(std::string_view text);

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
