#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"
#include "stages/import/clock.h"

namespace runcert::rtklib_pos {

/// What to do about a solution that is damaged or was changed.
inline constexpr const char* as_written =
    "Hand in the solution as the program wrote it, or solve it again";

/// The first columns of what stands in several: positions and velocities towards east, north, up or
/// along the Earth-centred axes; and covariances, three standard deviations, then sign times square
/// root of the covariances of axes (0, 1), (1, 2), (2, 0).
enum class Column : std::size_t {
    latitude,
    longitude,
    height,
    x,
    east = x + 3,
    quality = east + 3,
    satellites,
    age,
    ratio,
    covariance_enu,
    covariance_xyz = covariance_enu + 6,
    velocity_enu = covariance_xyz + 6,
    velocity_xyz = velocity_enu + 3,
    velocity_covariance_enu = velocity_xyz + 3,
    velocity_covariance_xyz = velocity_covariance_enu + 6,
    count = velocity_covariance_xyz + 6
};

/// The column so many behind another in the list of columns.
constexpr Column after(Column column, std::size_t steps) {
    return static_cast<Column>(static_cast<std::size_t>(column) + steps);
}

/// What a column header line says about the rows below it. Two fields, the time, stand before those
/// of the columns.
struct Layout : ColumnPlaces<Column> {
    Clock clock = Clock::gps;
    Column coordinates = Column::latitude;  ///< the first of those that are there
    bool dms = false;       ///< latitude and longitude in three fields: degrees, minutes, seconds
    char separator = '\0';  ///< ',', ';' or tab; NUL where only blanks stand between fields
    std::vector<std::string> passed_over;  ///< columns of other programs, behind all known ones
};

/// The first of the separators that a text holds; NUL where only blanks part its fields.
char find_separator(std::string_view text);

/// Reads the header line that names the columns. Columns that are not RTKLIB's are passed over
/// where they stand behind all of its own, as other programs add them. Failure on a time system or
/// unit that is not known, another column among RTKLIB's, one that stands twice, or a set of
/// columns that is not complete.
Layout read_column_line(const SourceLine& line, const RecordingBytes& recording);

}  // namespace runcert::rtklib_pos
