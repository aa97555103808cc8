#include "stages/import/rtklib_pos/header.h"

#include <fmt/format.h>

#include <span>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/earth.h"

namespace runcert::rtklib_pos {
namespace {

struct KnownColumn {
    std::string_view name;
    std::string_view unit;  ///< which the header may leave out
    Column column;
};

constexpr KnownColumn known_columns[] = {
    {"latitude", "deg", Column::latitude},
    {"longitude", "deg", Column::longitude},
    {"height", "m", Column::height},
    {"x-ecef", "m", Column::x},
    {"y-ecef", "m", Column::y},
    {"z-ecef", "m", Column::z},
    {"e-baseline", "m", Column::east},
    {"n-baseline", "m", Column::north},
    {"u-baseline", "m", Column::up},
    {"Q", "", Column::quality},
    {"ns", "", Column::satellites},
    {"age", "s", Column::age},
    {"ratio", "", Column::ratio},
    {"sde", "m", Column::sigma_east},
    {"sdn", "m", Column::sigma_north},
    {"sdu", "m", Column::sigma_up},
    {"sdne", "m", Column::root_east_north},
    {"sden", "m", Column::root_east_north},
    {"sdun", "m", Column::root_north_up},
    {"sdnu", "m", Column::root_north_up},
    {"sdeu", "m", Column::root_up_east},
    {"sdue", "m", Column::root_up_east},
    {"sdx", "m", Column::sigma_x},
    {"sdy", "m", Column::sigma_y},
    {"sdz", "m", Column::sigma_z},
    {"sdxy", "m", Column::root_xy},
    {"sdyz", "m", Column::root_yz},
    {"sdzx", "m", Column::root_zx},
    {"ve", "m/s", Column::velocity_east},
    {"vn", "m/s", Column::velocity_north},
    {"vu", "m/s", Column::velocity_up},
    {"vx", "m/s", Column::velocity_x},
    {"vy", "m/s", Column::velocity_y},
    {"vz", "m/s", Column::velocity_z},
    {"sdve", "m/s", Column::sigma_velocity_east},
    {"sdvn", "m/s", Column::sigma_velocity_north},
    {"sdvu", "m/s", Column::sigma_velocity_up},
    {"sdvne", "m/s", Column::root_velocity_east_north},
    {"sdven", "m/s", Column::root_velocity_east_north},
    {"sdvun", "m/s", Column::root_velocity_north_up},
    {"sdvnu", "m/s", Column::root_velocity_north_up},
    {"sdveu", "m/s", Column::root_velocity_up_east},
    {"sdvue", "m/s", Column::root_velocity_up_east},
    {"sdvx", "m/s", Column::sigma_velocity_x},
    {"sdvy", "m/s", Column::sigma_velocity_y},
    {"sdvz", "m/s", Column::sigma_velocity_z},
    {"sdvxy", "m/s", Column::root_velocity_xy},
    {"sdvyz", "m/s", Column::root_velocity_yz},
    {"sdvzx", "m/s", Column::root_velocity_zx},
};

constexpr std::string_view dms_unit = "d'\"";

/// Columns that are of use only together: from the first to the last.
struct ColumnSet {
    Column first, last;
    std::string_view names;
};

constexpr ColumnSet column_sets[] = {
    {Column::latitude, Column::height, "latitude, longitude, height"},
    {Column::x, Column::z, "x-ecef, y-ecef, z-ecef"},
    {Column::east, Column::up, "e-baseline, n-baseline, u-baseline"},
    {Column::sigma_east, Column::root_up_east, "sdn, sde, sdu, sdne, sdeu, sdun"},
    {Column::sigma_x, Column::root_zx, "sdx, sdy, sdz, sdxy, sdyz, sdzx"},
    {Column::velocity_east, Column::velocity_up, "vn, ve, vu"},
    {Column::velocity_x, Column::velocity_z, "vx, vy, vz"},
    {Column::sigma_velocity_east, Column::root_velocity_up_east,
     "sdvn, sdve, sdvu, sdvne, sdveu, sdvun"},
    {Column::sigma_velocity_x, Column::root_velocity_zx, "sdvx, sdvy, sdvz, sdvxy, sdvyz, sdvzx"},
};

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
    for (const KnownColumn& known : known_columns)
        names.push_back(known.name);
    cell.fail(fmt::format("the column \"{}\" is not known", escape_for_message(cell.text)),
              fmt::format("Did you mean {}? Export the solution with RTKLIB's own columns",
                          nearest(name, names)));
}

/// Null for a column that is not RTKLIB's.
const KnownColumn* find_column(const Cell& cell) {
    const std::size_t bracket = cell.text.find('(');
    const std::string_view name = cell.text.substr(0, bracket);
    std::string_view unit;
    if (bracket != std::string_view::npos && cell.text.ends_with(')'))
        unit = cell.text.substr(bracket + 1, cell.text.size() - bracket - 2);
    for (const KnownColumn& known : known_columns) {
        if (known.name != name) continue;
        const bool angle = known.unit == "deg";
        if ((bracket == std::string_view::npos && !angle) ||
            (!unit.empty() && unit == known.unit) || (angle && unit == dms_unit))
            return &known;
        cell.fail(fmt::format("the column \"{}\" is not in {}", escape_for_message(cell.text),
                              known.unit),
                  "Export the solution in degrees and metres");
    }
    return nullptr;
}

bool is_dms(const Cell& cell) {
    return cell.text.find(dms_unit) != std::string_view::npos;
}

void require_complete_sets(const Layout& layout, const Cell& start) {
    for (const ColumnSet& set : column_sets) {
        std::size_t present = 0;
        const auto first = static_cast<std::size_t>(set.first);
        const auto last = static_cast<std::size_t>(set.last);
        for (std::size_t i = first; i <= last; ++i)
            present += layout.place[i] ? 1 : 0;
        if (present != 0 && present != last - first + 1)
            start.fail(fmt::format("of the columns {} only {} are there", set.names, present),
                       "Take the solution as RTKLIB wrote it");
    }
    if (!layout[Column::quality])
        start.fail("the column Q, the kind of each solution, is missing",
                   "Take the solution as RTKLIB wrote it");
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
        const KnownColumn* known = find_column(cell);
        // Behind another program's columns a name that RTKLIB uses, too, is that program's.
        if (!known || (first_other && layout[known->column])) {
            if (!first_other) first_other = &cell;
            layout.passed_over.push_back(escape_for_message(cell.text));
            layout.fields += 1;
            continue;
        }
        if (first_other) refuse_column(*first_other);
        auto& field = layout[known->column];
        if (field)
            cell.fail(fmt::format("the column \"{}\" stands twice", cell.text),
                      "Take the solution as RTKLIB wrote it");
        field = layout.fields;
        layout.fields += is_dms(cell) ? 3 : 1;
        angles += known->unit == "deg" ? 1 : 0;
        dms_angles += is_dms(cell) ? 1 : 0;
    }
    if (dms_angles != 0 && dms_angles != angles)
        cells.front().fail("latitude and longitude are not in one unit",
                           "Take the solution as RTKLIB wrote it");
    require_complete_sets(layout, cells.front());
    layout.coordinates = find_coordinates(layout, dms_angles > 0, cells.front());
    return layout;
}

}  // namespace runcert::rtklib_pos
