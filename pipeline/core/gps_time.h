#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

namespace runcert {

/// A date of the Gregorian calendar and a time of day. The code that uses it names the time scale.
struct CalendarTime {
    int year = 1980;
    int month = 1;                ///< 1 to 12
    int day = 6;                  ///< 1 to 31
    int hour = 0;                 ///< 0 to 23
    int minute = 0;               ///< 0 to 59
    int second = 0;               ///< 0 to 59; 60 in UTC, inside a leap second
    std::int64_t nanosecond = 0;  ///< 0 to 999 999 999

    friend constexpr bool operator==(const CalendarTime&, const CalendarTime&) = default;
    friend constexpr auto operator<=>(const CalendarTime&, const CalendarTime&) = default;
};

/// An instant on the GPS time scale: whole nanoseconds since 1980-01-06T00:00:00, the GPS epoch.
///
/// GPS time has no leap seconds. It spans the years 1687 to 2272. A result outside this span is a
/// Failure at "time", never a wrapped value.
class GpsTime {
  public:
    static constexpr std::int64_t nanoseconds_per_second = 1'000'000'000;
    static constexpr std::int64_t nanoseconds_per_day = 86'400 * nanoseconds_per_second;
    static constexpr std::int64_t nanoseconds_per_week = 7 * nanoseconds_per_day;

    /// The GPS epoch.
    constexpr GpsTime() = default;

    /// The instant this many nanoseconds after the GPS epoch, exact. Negative counts lie before it.
    static constexpr GpsTime from_nanoseconds(std::int64_t nanoseconds) {
        return GpsTime(nanoseconds);
    }

    /// The instant `nanoseconds_of_week` after the start of the full week number `week` (no
    /// rollover). Some receivers round up to the very end of the week, so exactly one week is
    /// accepted. Failure if `nanoseconds_of_week` is outside 0 to one week, or the instant is
    /// out of span.
    static GpsTime from_week(int week, std::int64_t nanoseconds_of_week);

    /// The instant of a calendar time on the GPS time scale. Failure if a field is invalid
    /// (month 13, 30 February, second 60) or the instant out of span.
    static GpsTime from_calendar(const CalendarTime& gps);

    /// Nanoseconds since the GPS epoch, negative before it.
    constexpr std::int64_t nanoseconds() const { return nanoseconds_; }

    /// Full week number, negative before the epoch.
    constexpr int week() const {
        const std::int64_t quotient = nanoseconds_ / nanoseconds_per_week;
        return static_cast<int>(nanoseconds_ % nanoseconds_per_week < 0 ? quotient - 1 : quotient);
    }

    /// Nanoseconds since the start of the week, from 0 to just under one week.
    constexpr std::int64_t nanoseconds_of_week() const {
        const std::int64_t remainder = nanoseconds_ % nanoseconds_per_week;
        return remainder < 0 ? remainder + nanoseconds_per_week : remainder;
    }

    /// The calendar time on the GPS time scale, exact.
    CalendarTime calendar() const;

    /// This instant minus `earlier`, exact, in nanoseconds. Failure if the two are more than 292
    /// years apart.
    std::int64_t nanoseconds_since(GpsTime earlier) const;

    /// This instant minus `earlier` in seconds: the exact difference, to within 1 ulp. Failure as
    /// for `nanoseconds_since`.
    double seconds_since(GpsTime earlier) const;

    /// The instant `nanoseconds` later. Failure if it is out of span.
    GpsTime plus_nanoseconds(std::int64_t nanoseconds) const;

    friend constexpr bool operator==(GpsTime, GpsTime) = default;
    friend constexpr auto operator<=>(GpsTime, GpsTime) = default;

  private:
    explicit constexpr GpsTime(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}

    std::int64_t nanoseconds_ = 0;
};

/// ISO 8601 text of an instant on the GPS time scale, such as "2022-03-18T08:51:22.300", with 0 to
/// 9 decimals. Rounds to nearest, with carries; a half goes up, to the later instant. There is no
/// suffix, because ISO 8601 has none for GPS time. Failure if rounding leaves the span.
std::string to_iso(GpsTime time, int decimals = 3);

/// Reads an instant written "YYYY-MM-DDTHH:MM:SS[.fffffffff]" on the GPS time scale. A blank may
/// replace the T, and two '/' the two '-'. One to nine decimals are allowed; text before or after
/// and a zone are not. Failure at "time" with the column (from 1) and what was expected there.
GpsTime parse_gps_iso(std::string_view text);

/// A UTC calendar time, and whether the leap seconds at that instant are announced. Where they are
/// not (after leap_seconds_known_until(), or before the GPS epoch), the nearest known offset is
/// used. The time may then be off by whole seconds.
struct UtcTime {
    CalendarTime time;
    bool leap_seconds_known = false;
};

/// The instant of a UTC calendar time. Second 60 is accepted only where UTC had a leap second.
/// Failure if a field is invalid or the instant is out of span.
GpsTime gps_from_utc(const CalendarTime& utc);

/// The UTC calendar time of an instant. Inside a leap second its `second` is 60.
UtcTime utc_from_gps(GpsTime time);

/// ISO 8601 text in UTC, such as "2022-03-18T08:51:04.300Z", rounded as by `to_iso`.
std::string to_utc_iso(GpsTime time, int decimals = 3);

}  // namespace runcert
