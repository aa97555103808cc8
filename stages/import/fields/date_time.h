#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "stages/import/clock.h"

namespace runcert {

// Dates and times as any text writes them, beside ISO 8601: "3/14/2026 1:00:00.000 PM",
// "14.03.2026", "140613", "14-MAR-26", "Sat Mar 14 10:00:00 GMT 2026", days of a spreadsheet.

/// The order of a date's parts.
enum class DateOrder { year_first, month_first, day_first };
inline constexpr std::array date_orders{DateOrder::year_first, DateOrder::month_first,
                                        DateOrder::day_first};

/// The days (since 1980-01-06) that a date is in each of these orders; nothing where it is no date.
/// Parts are parted by /, - or points, or stand in six or eight digits; points part no month from a
/// day behind it, and years of two digits are from 2000 on. With the month's name all orders are
/// one; what else may stand beside it is a day of the week, a time of day and its zone.
std::array<std::optional<std::int64_t>, 3> days_of(std::string_view date);

/// Whether a text is a date in any order.
bool is_date(std::string_view text);

/// Date and time of day of one cell, which a blank or T parts; the second is empty where nothing
/// does. With the month's name the first is the whole cell.
std::array<Cell, 2> split_date_time(const Cell& cell);

/// Whether read_calendar (stages/import/clock.h) reads them.
bool is_iso(std::string_view date, std::string_view time_of_day);

/// The seconds of a time of day, with or without its date and zone, for their decimals.
std::string_view seconds_text(std::string_view time_of_day);

/// The instant at which the clock shows this date in that order and this time of day: hours of one
/// or two digits, with AM or PM or without, "13:00", "1:00:00.5 pm"; or six digits, "095959.5". A
/// zone behind it counts (clock_at). Failure at the cell that is neither.
GpsTime read_date_time(const Cell& date, const Cell& time_of_day, DateOrder order, Clock clock);

/// What the size of a count since 1970 says of its unit, by the digits that make it seconds: 0, 3
/// (milliseconds), 6 or 9. Nothing where it is in none of them between 1980 and 2100.
std::optional<int> unix_shift(std::string_view text);

/// What a count of days begins with: day 0 by the GPS epoch's count of days, with the fraction that
/// Julian dates begin at noon by.
struct DayCountKind {
    std::string_view name;  ///< "a spreadsheet's days"
    double first_day = 0.0;
};

/// The count of days whose numbers from 2000 to 2040 are so large, where the text has the decimals
/// of a time of day (four or more); nothing for another text.
std::optional<DayCountKind> day_count_of(std::string_view text);

/// The instant at which the clock shows a count of days, to the nanosecond.
GpsTime read_days(const Cell& cell, const DayCountKind& kind, Clock clock);

}  // namespace runcert
