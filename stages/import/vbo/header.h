#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/import/fields.h"

namespace runcert::vbo {

/// The columns that are read.
enum class Column : std::size_t {
    satellites,
    time,
    latitude,
    longitude,
    velocity,
    heading,
    height,
    vertical_velocity,
    solution_type,
    count
};

/// What stands before the data.
struct Header {
    std::string_view created;                ///< after "File created on"
    std::vector<std::string_view> channels;  ///< the lines of [header]
    std::vector<std::string_view> units;     ///< the lines of [channel units]
    std::vector<std::string_view> columns;   ///< the words of [column names]
    std::vector<std::string_view> comments;  ///< the first lines of [comments]
    std::int64_t names_line = 1;             ///< of the first of `columns`, or of [header]
};

/// What coordinates are written in.
enum class Coordinates {
    minutes,  ///< of arc, the rule of the format
    degrees,
    packed  ///< degrees times 100, plus minutes: DDMM.MMMM
};

/// A coordinate in degrees. Nothing for a packed one of 60 minutes or more.
std::optional<double> degrees_of(double written, Coordinates coordinates);

/// How a row of data is laid out.
struct Layout : ColumnPlaces<Column> {
    Coordinates coordinates = Coordinates::minutes;
    std::size_t named = 0;  ///< columns that the header names, of `fields`
    /// Before which of these the fields without a name stand, from 0; empty where behind all.
    std::optional<std::size_t> unnamed_at;
    std::optional<double> velocity_m_s;           ///< of one unit; empty without such a column
    std::optional<double> vertical_velocity_m_s;  ///< the same; also empty for an unknown unit
};

/// Reads up to and with the line [data]. Failure where there is none.
Header read_header(LineReader& lines, const RecordingBytes& recording);

/// The layout of rows of so many fields. The columns are named by [column names], or by [header]
/// where only that has as many; where neither has, by the one that names time and place, from the
/// left. Units of speed stand behind the names, or in [channel units]; a velocity without one is in
/// km/h. Coordinates are minutes of arc unless their names say degrees. Failure where time,
/// latitude or longitude is not named, or stands behind the fields.
Layout find_layout(const Header& header, std::size_t fields, const RecordingBytes& recording);

/// The device that the comments name, with its serial number and firmware.
std::string device_of(const Header& header);

/// The words of a line, which blanks separate.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording);

}  // namespace runcert::vbo
