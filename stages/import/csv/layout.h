#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "stages/import/clock.h"
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
};

/// Failure at the receiver's place in the attempt.
Description describe(const Receiver& receiver);

/// Where in a table the columns are.
struct Layout : ColumnPlaces<Column> {
    char delimiter = ',';
    bool has_header_line = true;
};

/// Reads the first line of a table that is no comment. It is a row already if all columns are
/// given by number and its time is a number or begins with a digit. Failure on a name that is not
/// there or there twice, and on a number beyond the last column.
Layout read_layout(const Receiver& receiver, const Description& description,
                   const SourceLine& first, const RecordingBytes& recording);

}  // namespace runcert::csv
