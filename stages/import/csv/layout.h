#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "stages/import/clock.h"
#include "stages/import/csv/date_time.h"
#include "stages/import/csv/head.h"
#include "stages/import/csv/unit.h"
#include "stages/import/fields.h"

namespace runcert::csv {

/// What a column may hold: the keys of `columns` in an attempt.
enum class Column : std::size_t {
    time,
    week,
    date,
    east,
    north,
    up,
    latitude,
    longitude,
    height,
    x,
    y,
    z,
    sigma_east,
    sigma_north,
    sigma_up,
    quality_2d,
    quality_height,
    velocity_east,
    velocity_north,
    velocity_up,
    speed,
    course,
    sigma_speed,
    fix,
    satellites,
    new_fix,
    count
};

/// The key of a column in an attempt ("sigma_east").
std::string_view name_of(Column column);

enum class TimeFormat { seconds, seconds_of_week, unix, iso, time_of_day };

/// What the attempt says of a table, checked: every column it names is of use, and none that is
/// needed is missing.
struct Description {
    CoordinateFrame frame = CoordinateFrame::geodetic;
    TimeFormat time_format = TimeFormat::seconds;
    Clock clock = Clock::gps;
    std::optional<char> delimiter;            ///< empty: to be found
    std::optional<double> constant_height_m;  ///< where geodetic coordinates have no heights
    bool has_up = false;                      ///< a height or third plane coordinate is recorded
    std::optional<Unit> speed_unit;           ///< of speeds and velocities, where it is stated
    bool between_fixes = false;  ///< rows between fixes are interpolated, satellite counts too
    /// Of counts of time: so many more digits are decimals (3: milliseconds).
    int time_shift = 0;
    std::optional<DateOrder> date_order;  ///< of dates and times that are not ISO 8601
};

/// Failure at the receiver's place in the attempt.
Description describe(const Receiver& receiver);

/// Where in a table the columns are, and what their numbers are in.
struct Layout : ColumnPlaces<Column> {
    Layout() { factor.fill(1.0); }

    Head head;
    /// Of each column's numbers, in metres or metres a second.
    std::array<double, static_cast<std::size_t>(Column::count)> factor{};
    bool both_in_one = false;        ///< one column holds latitude, then longitude
    std::vector<std::string> notes;  ///< on what was passed over, and on units
};

/// Finds the header line and reads it: the first line that has all the names that the attempt gives
/// to columns. Where it gives numbers alone, the table begins with the first line whose time is a
/// number or begins with a digit. Failure on a name that is not there or there twice, on a number
/// beyond the last column, and on a unit that contradicts the attempt or is none that is read.
Layout read_layout(const Receiver& receiver, const Description& description,
                   const RecordingBytes& recording);

/// The columns' units, by the header's names, by a line of units under it, and by the attempt.
void set_units(Layout& layout, const Description& description, const Receiver& receiver);

/// The unit that header and lines under it give a column; nothing where they do not.
std::optional<Unit> unit_of_column(const Head& head, std::size_t column);

/// Finds how the rows write their times: the unit of counts, and the order of dates that are not
/// ISO 8601. Failure where that order shows neither in the dates nor in the attempt's start_date.
void settle_times(Layout& layout, Description& description, const Receiver& receiver,
                  const RecordingBytes& recording);

/// Notes what of the head was passed over.
void note_head(Layout& layout);

}  // namespace runcert::csv
