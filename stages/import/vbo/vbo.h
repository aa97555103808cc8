#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"
#include "stages/import/row_collector.h"

/// Racelogic VBO files. Layout: "VBO file structure" of Racelogic's developers' portal, "VBO File
/// Format" of its support centre, and the VBOX manuals.
namespace runcert::vbo {

inline constexpr const char* as_written = "Take the recording as the logger wrote it";

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
    std::string_view created;    ///< after "File created on"
    std::vector<Cell> channels;  ///< the lines of [header]
    std::vector<Cell> units;     ///< the lines of [channel units]
    std::vector<Cell> columns;   ///< the words of [column names]
    std::vector<Cell> comments;  ///< the first lines of [comments]

    /// The beginning of the line that names the columns.
    std::string names_place(const RecordingBytes& recording) const;
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
    std::size_t named = 0;       ///< columns that the header names, of `fields`
    std::size_t unnamed_at = 0;  ///< before which of these those without a name stand, from 0
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

/// Says type, serial number and firmware, where a comment of that name says it, and what device
/// the comments name.
void set_device(Observations& observations, const Header& header);

/// The words of a line, which blanks separate.
std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording);

using Row = RowCells<Column>;

/// Nanoseconds since midnight of a time of day, "062345.04", with or without its leading zeros, or
/// "06:23:45.04"; nothing for any other text. Second 60 at the end of the day only.
std::optional<std::int64_t> time_of_day_ns(std::string_view text);

/// What must be known before the rows are read.
struct Survey {
    Coordinates coordinates = Coordinates::minutes;
    /// Whether the recorded speeds are those of the positions; nothing where there is too little.
    std::optional<bool> speeds_fit;
    double misfit = 0.0;  ///< of the two ways, where speeds_fit is there: logarithm of their ratio
    std::optional<std::int64_t> first_time_ns;  ///< of the first row with a time; since midnight
    std::optional<bool> east_positive;  ///< longitudes; nothing where the headings do not show it
    std::optional<double> first_longitude_deg;  ///< east positive
};

/// Looks at the rows from here on, as few as needed.
///
/// Some writers have decimal degrees, or degrees and minutes (DDMM.MMMM), where Racelogic has
/// minutes of arc. Over the first 3 km the way between the positions is that of the recorded
/// speeds, within a quarter, in one of them alone: minutes and packed degrees differ by the
/// meridians' convergence. Without speeds, coordinates are what fits on the Earth, and degrees
/// where minutes would put them within 2 degrees of latitude 0 and 3 of longitude 0.
///
/// Racelogic counts longitudes positive to the west; other writers of the format do not, and no
/// file says so. But the rows hold a heading, clockwise from north, beside the longitude: a craft
/// that heads east moves to greater longitudes where they count to the east, to smaller ones
/// otherwise. Over the first 100 m of way to the east or west, three quarters of it must agree.
Survey survey(LineReader lines, const RecordingBytes& recording, const Layout& layout);

/// The day of the first epoch, and how it was found, as a note for the report.
struct FirstDay {
    std::optional<std::int64_t> utc;  ///< days since 1980-01-06; nothing where no date is to be had
    std::string note;
    bool by_start_gps = false;  ///< the attempt's start_gps was needed
};

/// Finds the UTC date of the first epoch, of which the recording gives the time of day alone: that
/// of the attempt's start_date; else by the header's local date and time, with the attempt's
/// utc_offset_h or else the sun's time at the first place (longitude / 15, in hours); else the one
/// nearest to the attempt's start_gps.
FirstDay find_first_day(const Receiver& receiver, const Header& header, const Survey& surveyed);

}  // namespace runcert::vbo
