#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "stages/import/clock.h"

// Dates and times as tables have them, beside ISO 8601: "3/14/2026 1:00:00.000 PM", "14.03.2026",
// "140613".

namespace runcert::csv {

/// The order of a date's parts.
enum class DateOrder { year_first, month_first, day_first };

/// Whether a text is a date in any order. Parts are parted by /, - or points, or stand in six or
/// eight digits; points part no month from a day behind it, and years of two digits are from 2000
/// on.
bool is_date(std::string_view text);

/// Date and time of day of one cell, which a blank or T parts; the second is empty where nothing
/// does.
std::array<Cell, 2> split_date_time(const Cell& cell);

/// Whether read_calendar (stages/import/clock.h) reads them.
bool is_iso(std::string_view date, std::string_view time_of_day);

/// The seconds of a time of day, with or without its date, for their decimals.
std::string_view seconds_text(std::string_view time_of_day);

/// The instant at which the clock shows this date in that order and this time of day: hours of one
/// or two digits, with AM or PM or without, "13:00", "1:00:00.5 pm"; or six digits, "095959.5". A
/// final Z says UTC. Failure at the cell that is neither.
GpsTime read_date_time(const Cell& date, const Cell& time_of_day, DateOrder order, Clock clock);

/// What the size of a count since 1970 says of its unit, by the digits that make it seconds: 0, 3
/// (milliseconds), 6 or 9. Nothing where it is in none of them between 1980 and 2100.
std::optional<int> unix_shift(std::string_view text);

}  // namespace runcert::csv
