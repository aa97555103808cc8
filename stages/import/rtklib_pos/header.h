#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodesy.h"
#include "schemas/observations/observations.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/row_collector.h"

namespace runcert::rtklib_pos {

/// How the rows under a column header line state positions.
enum class Coordinates { degrees, degrees_minutes_seconds, earth_centred, baseline };

/// What a column holds, towards east, north, up or along the Earth-centred axes. A covariance is
/// six columns from its first one on: three standard deviations, then sign times square root of the
/// covariances of axes (0, 1), (1, 2), (2, 0). Of velocities the other two axes follow, too.
enum class Column : std::size_t {
    latitude,
    longitude,
    height,
    x,
    y,
    z,
    east,
    north,
    up,
    quality,
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

/// What a column header line says about the rows below it. Two fields, the time, stand before those
/// of the columns.
struct Layout : ColumnPlaces<Column> {
    Clock clock = Clock::gps;
    Coordinates coordinates = Coordinates::degrees;
    char separator = '\0';  ///< ',', ';' or tab; NUL where only blanks stand between fields
    std::vector<std::string> passed_over;  ///< columns of other programs, behind all known ones
};

/// Whether a header line is the one that names the columns.
bool is_column_line(std::string_view line);

/// Reads it. Columns that are not RTKLIB's are passed over where they stand behind all of its own,
/// as other programs add them. Failure on a time system or unit that is not known, another column
/// among RTKLIB's, one that stands twice, or a set of columns that is not complete.
Layout read_column_line(const SourceLine& line, const RecordingBytes& recording);

/// The base's position from a "% ref pos" line in degrees, degrees-minutes-seconds or ECEF;
/// nothing for any other line.
std::optional<Geodetic> read_reference_position(const SourceLine& line,
                                                const RecordingBytes& recording);

/// Adds what a line "% key : value" says of how the solution was made (RTKLIB 2.4.3, outheader() of
/// postpos.c): program, files without their folders, first and last observation, options, 40 at
/// most.
void read_processing(std::string_view line, std::optional<Processing>& processing);

/// Degrees from three fields, the sign (also of "-0") on the degrees.
Angle read_dms(const Cell& degrees, const Cell& minutes, const Cell& seconds,
               std::string_view meaning);

/// Failure for a header line that says that the datum is not WGS 84, or that heights are not above
/// the ellipsoid.
void require_datum(const SourceLine& line, const RecordingBytes& recording);

/// Reads the fields of a row, as many as the layout says. `base` is needed, and given, where the
/// coordinates are a baseline.
TimedRow read_row(std::span<const Cell> fields, const Layout& layout,
                  const std::optional<LocalFrame>& base);

}  // namespace runcert::rtklib_pos
