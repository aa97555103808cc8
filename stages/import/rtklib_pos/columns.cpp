#include "stages/import/rtklib_pos/columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

#include "core/text.h"

// The header line that names the columns (RTKLIB 2.4.3, outsolheads() of solution.c).
namespace runcert::rtklib_pos {
namespace {

/// How RTKLIB calls its columns, in the order of Column. The header may leave units out, but for
/// degrees.
constexpr std::array<std::string_view, static_cast<std::size_t>(Column::count)> column_names{
    "latitude(deg)", "longitude(deg)", "height(m)",     "x-ecef(m)", "y-ecef(m)",  "z-ecef(m)",
    "e-baseline(m)", "n-baseline(m)",  "u-baseline(m)", "Q",         "ns",         "age(s)",
    "ratio",         "sde(m)",         "sdn(m)",        "sdu(m)",    "sdne(m)",    "sdun(m)",
    "sdeu(m)",       "sdx(m)",         "sdy(m)",        "sdz(m)",    "sdxy(m)",    "sdyz(m)",
    "sdzx(m)",       "ve(m/s)",        "vn(m/s)",       "vu(m/s)",   "vx(m/s)",    "vy(m/s)",
    "vz(m/s)",       "sdve(m/s)",      "sdvn(m/s)",     "sdvu(m/s)", "sdvne(m/s)", "sdvun(m/s)",
    "sdveu(m/s)",    "sdvx(m/s)",      "sdvy(m/s)",     "sdvz(m/s)", "sdvxy(m/s)", "sdvyz(m/s)",
    "sdvzx(m/s)"};

/// Columns that are of use only together.
struct ColumnSet {
    Column first;
    std::ptrdiff_t size;
};
constexpr ColumnSet column_sets[] = {{Column::latitude, 3},
                                     {Column::x, 3},
                                     {Column::east, 3},
                                     {Column::covariance_enu, 6},
                                     {Column::covariance_xyz, 6},
                                     {Column::velocity_enu, 3},
                                     {Column::velocity_xyz, 3},
                                     {Column::velocity_covariance_enu, 6},
                                     {Column::velocity_covariance_xyz, 6}};

constexpr std::string_view dms_unit = "(d'\")";

std::string_view without_unit(std::string_view name) {
    return name.substr(0, name.find('('));
}

Clock read_time_system(const Cell& cell) {
    if (cell.text == "GPST") return Clock::gps;
    if (cell.text == "UTC") return Clock::utc;
    if (cell.text == "JST") return Clock::jst;
    cell.fail(
        fmt::format("\"{}\" is not a time system that is read", escape_for_message(cell.text)),
        "Export the solution again in GPST, UTC or JST, which the column header line begins with");
}

[[noreturn]] void refuse_column(const Cell& cell) {
    cell.fail(fmt::format("the column \"{}\" is not known", escape_for_message(cell.text)),
              fmt::format("Did you mean {}? Export the solution with RTKLIB's own columns",
                          nearest(cell.text, column_names)));
}

/// Nothing for a column that is not RTKLIB's.
std::optional<Column> find_column(const Cell& cell) {
    std::string name(without_unit(cell.text));
    const std::string_view unit = cell.text.substr(name.size());
    auto found = std::ranges::find(column_names, name, without_unit);
    if (found == column_names.end() && name.starts_with("sd") && name.size() > 3) {
        std::swap(name.back(), name[name.size() - 2]);  // a covariance is that of both its axes
        found = std::ranges::find(column_names, name, without_unit);
    }
    if (found == column_names.end()) return std::nullopt;
    const std::string_view known = found->substr(name.size());
    if (unit != known && unit != (known == "(deg)" ? dms_unit : ""))
        cell.fail(fmt::format("the column \"{}\" is not in the unit of {}",
                              escape_for_message(cell.text), *found),
                  "Export the solution in degrees and metres");
    return static_cast<Column>(found - column_names.begin());
}

void require_complete_sets(const Layout& layout, const Cell& start) {
    for (const ColumnSet& set : column_sets) {
        const auto first = static_cast<std::ptrdiff_t>(set.first);
        const auto places = layout.place.begin() + first;
        const auto name = column_names.begin() + first;
        const auto missing = std::count(places, places + set.size, std::nullopt);
        if (missing != 0 && missing != set.size)
            start.fail(fmt::format("of the columns {} only {} are there",
                                   fmt::join(name, name + set.size, ", "), set.size - missing),
                       as_written);
    }
    if (!layout[Column::quality])
        start.fail("the column Q, the kind of each solution, is missing", as_written);
}

}  // namespace

char find_separator(std::string_view text) {
    for (const char separator : {';', ',', '\t'})
        if (text.find(separator) != std::string_view::npos) return separator;
    return '\0';
}

Layout read_column_line(const SourceLine& line, const RecordingBytes& recording) {
    Layout layout;
    layout.separator = find_separator(line.text);
    layout.fields = 2;
    const std::vector<Cell> cells =
        split_words(line, line.text.substr(1), recording, layout.separator);
    const Cell& start = cells.front();
    layout.clock = read_time_system(start);
    std::size_t in_three = 0;
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
        if (layout[*column])
            cell.fail(fmt::format("the column \"{}\" stands twice", cell.text), as_written);
        layout[*column] = layout.fields;
        const bool dms = cell.text.ends_with(dms_unit);
        layout.fields += dms ? 3 : 1;
        in_three += dms ? 1 : 0;
    }
    require_complete_sets(layout, start);
    if (in_three == 1) start.fail("latitude and longitude are not in one unit", as_written);
    layout.dms = in_three == 2;
    constexpr std::array firsts{Column::latitude, Column::x, Column::east};
    const auto is_there = [&](Column first) { return layout[first].has_value(); };
    if (std::ranges::count_if(firsts, is_there) != 1)
        start.fail("the columns hold no position, or several kinds of it",
                   "Export the solution as latitude/longitude/height, x/y/z or e/n/u");
    layout.coordinates = *std::ranges::find_if(firsts, is_there);
    return layout;
}

}  // namespace runcert::rtklib_pos
