#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "core/gps_time.h"
#include "stages/import/cell.h"

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

// All fail at the cell that holds what cannot be read. Exact: no time is ever a double.

/// The instant at which the clock shows this date ("2023-07-11" or "2023/07/11") and time of day
/// ("06:04:30", with any decimals up to the ninth). Second 60 where UTC had a leap second.
GpsTime read_calendar(const Cell& date, const Cell& time_of_day, Clock clock);

/// The same from one cell: date, T or a blank, time of day. A final Z says UTC, and fails where
/// the clock is another.
GpsTime read_iso(const Cell& cell, Clock clock);

/// The instant at which the clock shows this full week number and these seconds of the week.
GpsTime read_week_time(const Cell& week, const Cell& seconds_of_week, Clock clock);

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

}  // namespace runcert
