#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodesy.h"
#include "schemas/observations/observations.h"
#include "stages/import/clock.h"
#include "stages/import/cell.h"
#include "stages/import/row_collector.h"

namespace runcert::rtklib_pos {

/// How the rows under a column header line state positions.
enum class Coordinates { degrees, degrees_minutes_seconds, earth_centred, baseline };

/// What a column holds. Towards east, north, up, or along the Earth-centred axes; `root_*` are
/// sign times square root of covariances.
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
    sigma_east,
    sigma_north,
    sigma_up,
    root_east_north,
    root_north_up,
    root_up_east,
    sigma_x,
    sigma_y,
    sigma_z,
    root_xy,
    root_yz,
    root_zx,
    velocity_east,
    velocity_north,
    velocity_up,
    velocity_x,
    velocity_y,
    velocity_z,
    sigma_velocity_east,
    sigma_velocity_north,
    sigma_velocity_up,
    root_velocity_east_north,
    root_velocity_north_up,
    root_velocity_up_east,
    sigma_velocity_x,
    sigma_velocity_y,
    sigma_velocity_z,
    root_velocity_xy,
    root_velocity_yz,
    root_velocity_zx,
    count
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
