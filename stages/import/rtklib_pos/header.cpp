#include "stages/import/rtklib_pos/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "stages/import/earth.h"

// What the header lines before the column names say about base and datum (RTKLIB 2.4.3,
// outheader() of postpos.c and outsolheads() of solution.c).
namespace runcert::rtklib_pos {
namespace {

/// How RTKLIB calls its columns, in the order of Column.
constexpr std::array<std::string_view, static_cast<std::size_t>(Column::count)> column_names{
    "latitude",   "longitude", "height", "x-ecef", "y-ecef", "z-ecef", "e-baseline", "n-baseline",
    "u-baseline", "Q",         "ns",     "age",    "ratio",  "sde",    "sdn",        "sdu",
    "sdne",       "sdun",      "sdeu",   "sdx",    "sdy",    "sdz",    "sdxy",       "sdyz",
    "sdzx",       "ve",        "vn",     "vu",     "vx",     "vy",     "vz",         "sdve",
    "sdvn",       "sdvu",      "sdvne",  "sdvun",  "sdveu",  "sdvx",   "sdvy",       "sdvz",
    "sdvxy",      "sdvyz",     "sdvzx"};

/// Other names of columns, covariances with their axes the other way round.
struct OtherName {
    std::string_view name, other;
};
constexpr OtherName other_names[] = {
    // Of positions, then of velocities.
    {"sdne", "sden"},   {"sdun", "sdnu"},   {"sdeu", "sdue"},
    {"sdvne", "sdven"}, {"sdvun", "sdvnu"}, {"sdveu", "sdvue"}};

/// The unit of a column, which the header may leave out.
std::string_view unit_of(Column column) {
    if (column <= Column::longitude) return "deg";
    if (column >= Column::velocity_enu) return "m/s";
    if (column == Column::quality || column == Column::satellites || column == Column::ratio)
        return "";
    return column == Column::age ? "s" : "m";
}

constexpr const char* as_written = "Take the solution as RTKLIB wrote it";
constexpr std::string_view dms_unit = "d'\"";

/// Columns that are of use only together, so many from the first on.
struct ColumnSet {
    Column first;
    std::size_t columns;
    std::string_view names;
};
constexpr ColumnSet column_sets[] = {
    {Column::latitude, 3, "latitude, longitude, height"},
    {Column::x, 3, "x-ecef, y-ecef, z-ecef"},
    {Column::east, 3, "e-baseline, n-baseline, u-baseline"},
    {Column::covariance_enu, 6, "sdn, sde, sdu, sdne, sdeu, sdun"},
    {Column::covariance_xyz, 6, "sdx, sdy, sdz, sdxy, sdyz, sdzx"},
    {Column::velocity_enu, 3, "vn, ve, vu"},
    {Column::velocity_xyz, 3, "vx, vy, vz"},
    {Column::velocity_covariance_enu, 6, "sdvn, sdve, sdvu, sdvne, sdveu, sdvun"},
    {Column::velocity_covariance_xyz, 6, "sdvx, sdvy, sdvz, sdvxy, sdvyz, sdvzx"}};

Clock read_time_system(const Cell& cell) {
    if (cell.text == "GPST") return Clock::gps;
    if (cell.text == "UTC") return Clock::utc;
    if (cell.text == "JST") return Clock::jst;
    if (cell.text == "LMT")
        cell.fail("the times are LMT, local mean time, whose offset the file does not say",
                  "Export the solution again in GPST or UTC");
    cell.fail(fmt::format("\"{}\" is not a time system of RTKLIB", escape_for_message(cell.text)),
              "The column header line begins with %, then GPST, UTC or JST");
}

[[noreturn]] void refuse_column(const Cell& cell) {
    const std::string_view name = cell.text.substr(0, cell.text.find('('));
    std::vector<std::string_view> names;
    for (const std::string_view known : column_names) {
        names.push_back(known);
        const auto other = std::ranges::find(other_names, known, &OtherName::name);
        if (other != std::end(other_names)) names.push_back(other->other);
    }
    cell.fail(fmt::format("the column \"{}\" is not known", escape_for_message(cell.text)),
              fmt::format("Did you mean {}? Export the solution with RTKLIB's own columns",
                          nearest(name, names)));
}

/// Nothing for a column that is not RTKLIB's.
std::optional<Column> find_column(const Cell& cell) {
    const std::size_t bracket = cell.text.find('(');
    std::string_view name = cell.text.substr(0, bracket);
    const auto other = std::ranges::find(other_names, name, &OtherName::other);
    if (other != std::end(other_names)) name = other->name;
    const auto found = std::ranges::find(column_names, name);
    if (found == column_names.end()) return std::nullopt;
    const auto column = static_cast<Column>(found - column_names.begin());
    const std::string_view known = unit_of(column);
    std::string_view unit;
    if (bracket != std::string_view::npos && cell.text.ends_with(')'))
        unit = cell.text.substr(bracket + 1, cell.text.size() - bracket - 2);
    const bool angle = known == "deg";
    if ((bracket == std::string_view::npos && !angle) || (!unit.empty() && unit == known) ||
        (angle && unit == dms_unit))
        return column;
    cell.fail(fmt::format("the column \"{}\" is not in {}", escape_for_message(cell.text), known),
              "Export the solution in degrees and metres");
}

bool is_dms(const Cell& cell) {
    return cell.text.find(dms_unit) != std::string_view::npos;
}

void require_complete_sets(const Layout& layout, const Cell& start) {
    for (const ColumnSet& set : column_sets) {
        std::size_t present = 0;
        const auto first = static_cast<std::size_t>(set.first);
        for (std::size_t i = first; i < first + set.columns; ++i)
            present += layout.place[i] ? 1 : 0;
        if (present != 0 && present != set.columns)
            start.fail(fmt::format("of the columns {} only {} are there", set.names, present),
                       as_written);
    }
    if (!layout[Column::quality])
        start.fail("the column Q, the kind of each solution, is missing", as_written);
}

Coordinates find_coordinates(const Layout& layout, bool dms, const Cell& start) {
    const int kinds = (layout[Column::latitude] ? 1 : 0) + (layout[Column::x] ? 1 : 0) +
                      (layout[Column::east] ? 1 : 0);
    if (kinds != 1)
        start.fail(fmt::format("the columns hold {} kinds of position", kinds),
                   "Export the solution as latitude/longitude/height, x/y/z or e/n/u");
    if (layout[Column::x]) return Coordinates::earth_centred;
    if (layout[Column::east]) return Coordinates::baseline;
    return dms ? Coordinates::degrees_minutes_seconds : Coordinates::degrees;
}

char find_separator(std::string_view line) {
    for (const char separator : {';', ',', '\t'})
        if (line.find(separator) != std::string_view::npos) return separator;
    return '\0';
}

constexpr std::string_view reference_key = "% ref pos";

/// Numbers above this are metres from the Earth's centre, not degrees.
constexpr double largest_degrees = 360.0;

Geodetic read_base(const std::vector<Cell>& cells) {
    if (cells.size() == 7) {
        const Geodetic base{.latitude = read_dms(cells[0], cells[1], cells[2], "base latitude"),
                            .longitude = read_dms(cells[3], cells[4], cells[5], "base longitude"),
                            .height_m = read_real(cells[6], "base height")};
        return checked_geodetic(base, cells[0], cells[3], cells[6]);
    }
    const Eigen::Vector3d values(read_real(cells[0], "base position"),
                                 read_real(cells[1], "base position"),
                                 read_real(cells[2], "base position"));
    if (values.head<2>().cwiseAbs().maxCoeff() > largest_degrees)
        return checked_ecef(values, cells[0]);
    const Geodetic base{.latitude = Angle::from_degrees(values(0)),
                        .longitude = Angle::from_degrees(values(1)),
                        .height_m = values(2)};
    return checked_geodetic(base, cells[0], cells[1], cells[2]);
}

}  // namespace

bool is_column_line(std::string_view line) {
    if (!line.starts_with('%')) return false;
    for (const std::string_view name : {"latitude(", "x-ecef(", "e-baseline("})
        if (line.find(name) != std::string_view::npos) return true;
    return false;
}

Layout read_column_line(const SourceLine& line, const RecordingBytes& recording) {
    Layout layout;
    layout.separator = find_separator(line.text);
    const std::vector<Cell> cells =
        split_words(line, line.text.substr(1), recording, layout.separator);
    layout.clock = read_time_system(cells.front());
    layout.fields = 2;
    std::size_t angles = 0;
    std::size_t dms_angles = 0;
    const Cell* first_other = nullptr;
    for (const Cell& cell : std::span(cells).subspan(1)) {
        const std::optional<Column> column = find_column(cell);
        // Behind another program's columns, a name that RTKLIB also uses is that program's.
        if (!column || (first_other && layout[*column])) {
            if (!first_other) first_other = &cell;
            layout.passed_over.push_back(escape_for_message(cell.text));
            layout.fields += 1;
            continue;
        }
        if (first_other) refuse_column(*first_other);
        auto& field = layout[*column];
        if (field) cell.fail(fmt::format("the column \"{}\" stands twice", cell.text), as_written);
        field = layout.fields;
        layout.fields += is_dms(cell) ? 3 : 1;
        angles += unit_of(*column) == "deg" ? 1 : 0;
        dms_angles += is_dms(cell) ? 1 : 0;
    }
    if (dms_angles != 0 && dms_angles != angles)
        cells.front().fail("latitude and longitude are not in one unit", as_written);
    require_complete_sets(layout, cells.front());
    layout.coordinates = find_coordinates(layout, dms_angles > 0, cells.front());
    return layout;
}

std::optional<Geodetic> read_reference_position(const SourceLine& line,
                                                const RecordingBytes& recording) {
    if (!line.text.starts_with(reference_key)) return std::nullopt;
    const std::size_t colon = line.text.find(':');
    const Cell start{line.text, &recording, line.number, 1};
    std::vector<Cell> cells;
    if (colon != std::string_view::npos) {
        const std::string_view values = line.text.substr(colon + 1);
        const std::size_t found = values.find_first_of(",;\t");
        cells = split_words(line, values, recording,
                            found == std::string_view::npos ? '\0' : values[found]);
    }
    if (cells.size() != 3 && cells.size() != 7)
        start.fail("the base position is not three numbers, nor seven in degrees-minutes-seconds",
                   as_written);
    return read_base(cells);
}

void read_processing(std::string_view line, std::optional<Processing>& processing) {
    constexpr std::size_t most = 40, longest = 120, widest_key = 16;
    const std::size_t colon = line.find(':');
    if (!line.starts_with('%') || colon == std::string_view::npos || colon > widest_key ||
        line.find('(') < colon)
        return;
    const std::string_view key = trim(line.substr(1, colon - 1));
    const std::string value = escape_for_message(trim(line.substr(colon + 1)), longest);
    if (key.empty() || value.empty()) return;
    if (!processing) processing.emplace();
    if (key == "program") {
        processing->program = value;
    } else if (key == "inp file") {
        if (processing->files.size() < most)
            processing->files.push_back(value.substr(value.find_last_of("/\\") + 1));
    } else if (key == "obs start") {
        processing->begin = value;
    } else if (key == "obs end") {
        processing->end = value;
    } else if (processing->options.size() < most) {
        processing->options.push_back(fmt::format("{}: {}", escape_for_message(key), value));
    }
}

Angle read_dms(const Cell& degrees, const Cell& minutes, const Cell& seconds,
               std::string_view meaning) {
    const double whole = read_real(degrees, meaning);
    const double minute = read_real(minutes, meaning);
    const double second = read_real(seconds, meaning);
    if (whole != std::floor(whole))
        degrees.fail(fmt::format("the {} has a fraction of degrees before its minutes", meaning),
                     as_written);
    if (minute != std::floor(minute) || minute < 0.0 || minute >= 60.0)
        minutes.fail(
            fmt::format("the minutes of the {} are not a whole number from 0 to 59", meaning),
            as_written);
    // RTKLIB rounds seconds for print, and may so write 60.
    if (second < 0.0 || second > 60.0)
        seconds.fail(fmt::format("the seconds of the {} are not from 0 to 60", meaning),
                     as_written);
    return Angle::from_dms(std::signbit(whole) ? -1 : 1, std::abs(whole), minute, second);
}

void require_datum(const SourceLine& line, const RecordingBytes& recording) {
    const Cell start{line.text, &recording, line.number, 1};
    if (line.text.find("=Tokyo") != std::string_view::npos)
        start.fail("the positions are in the Tokyo datum", "Export the solution again in WGS 84");
    if (line.text.find("height=WGS84/geodetic") != std::string_view::npos)
        start.fail("the heights are above a geoid (\"geodetic\"), not above the ellipsoid",
                   "Export the solution again with ellipsoidal heights");
}

}  // namespace runcert::rtklib_pos
