#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/csv/date_time.h"
#include "stages/import/csv/head.h"

namespace runcert::csv {

enum class Quantity { speed, length, angle, time };

/// A unit as the headers of tables write it ("Km/h", "mph", "ft"), in metres a second, metres,
/// degrees or seconds.
struct Unit {
    std::string_view name;  ///< "km/h", "ft", as the attempt writes it
    Quantity quantity = Quantity::speed;
    double factor = 1.0;
};

/// The unit by any of its spellings, in any case; nothing for any other text.
std::optional<Unit> find_unit(std::string_view text);

/// The name without a unit in brackets at its end: "Speed" of "Speed (km/h)".
std::string_view without_unit(std::string_view name);

/// The unit of speeds that a speed in metres a second, times `ratio`, would have: what fits within
/// a tenth.
std::optional<Unit> speed_unit_of_ratio(double ratio);

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

/// What a column holds.
struct ColumnKind {
    std::string_view name;                            ///< its key in an attempt ("sigma_east")
    std::optional<Quantity> quantity = std::nullopt;  ///< of its numbers, where they have a unit
    bool keeps_unit = false;  ///< coordinates and times keep the decimals they are written with
};

/// In the order of Column.
inline constexpr std::array<ColumnKind, static_cast<std::size_t>(Column::count)> column_kinds{
    {{"time", Quantity::time, true},
     {"week"},
     {"date"},
     {"east", Quantity::length, true},
     {"north", Quantity::length, true},
     {"up", Quantity::length},
     {"latitude", Quantity::angle, true},
     {"longitude", Quantity::angle, true},
     {"height", Quantity::length},
     {"x", Quantity::length, true},
     {"y", Quantity::length, true},
     {"z", Quantity::length, true},
     {"sigma_east", Quantity::length},
     {"sigma_north", Quantity::length},
     {"sigma_up", Quantity::length},
     {"quality_2d", Quantity::length},
     {"quality_height", Quantity::length},
     {"velocity_east", Quantity::speed},
     {"velocity_north", Quantity::speed},
     {"velocity_up", Quantity::speed},
     {"speed", Quantity::speed},
     {"course", Quantity::angle},
     {"sigma_speed", Quantity::speed},
     {"fix"},
     {"satellites"},
     {"new_fix"}}};

constexpr std::string_view name_of(Column column) {
    return column_kinds[static_cast<std::size_t>(column)].name;
}

/// The three columns of a position in a frame, the one of heights last.
std::span<const Column> position_columns(CoordinateFrame frame);

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
    /// Of times of day that no column has a date for: the UTC date of the first row.
    std::string start_date;
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
/// beyond the last column, and on a unit that contradicts the attempt or is not read.
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

/// The dates that the first row's may be, as the attempt writes them, where its order shows neither
/// in the dates nor elsewhere; none where it does. Failures as of describe and read_layout.
std::vector<std::string> dates_in_doubt(const Receiver& receiver, const RecordingBytes& recording);

/// Notes what of the head was passed over.
void note_head(Layout& layout);

}  // namespace runcert::csv
