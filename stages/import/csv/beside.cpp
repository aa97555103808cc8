#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "stages/import/csv/layout.h"

// What stands beside the columns that somebody names, and is needed to read them.

namespace runcert::csv {
namespace {

constexpr std::size_t rows_looked_at = 200;

std::string_view text_at(const std::vector<Cell>& row, const std::optional<std::size_t>& column) {
    return column && *column < row.size() ? row[*column].text : std::string_view();
}

/// Whether all cells of a column that are not empty are such, and one is there.
template <class IsSuch>
bool all_are(const Rows& rows, std::size_t column, IsSuch is_such) {
    bool any = false;
    for (const std::vector<Cell>& row : rows) {
        const std::string_view text = text_at(row, column);
        if (text.empty()) continue;
        if (!is_such(text)) return false;
        any = true;
    }
    return any;
}

bool is_taken(const Layout& layout, std::size_t column) {
    return std::ranges::find(layout.place, std::optional(column)) != layout.place.end();
}

/// The columns of letters of coordinates that are written without: those that are named so; or
/// both behind, or both before their coordinates. One letter alone may be of anything.
void find_hemispheres(Layout& layout, const Rows& rows) {
    const auto is_free = [&](std::size_t i, bool latitude) {
        return i < layout.fields && !is_taken(layout, i) &&
               all_are(rows, i,
                       [&](std::string_view text) { return hemisphere_in(text, latitude) != 0; });
    };
    if (!layout[Column::latitude] || !layout[Column::longitude]) return;
    for (const Column column : {Column::north_south, Column::east_west})
        for (std::size_t i = 0; i < layout.fields && !layout[column]; ++i)
            if (is_named(layout.head.names[i].text, column) &&
                is_free(i, column == Column::north_south))
                layout[column] = i;
    if (layout[Column::north_south] || layout[Column::east_west]) return;
    for (const std::size_t offset : {std::size_t{1}, static_cast<std::size_t>(-1)}) {
        const std::size_t of_latitude = *layout[Column::latitude] + offset;
        const std::size_t of_longitude = *layout[Column::longitude] + offset;
        if (!is_free(of_latitude, true) || !is_free(of_longitude, false)) continue;
        layout[Column::north_south] = of_latitude;
        layout[Column::east_west] = of_longitude;
        return;
    }
}

/// Whether rows of one time of day stand together, in the order of this column: what else it may
/// hold does not part them so.
bool parts_seconds(const Rows& rows, std::size_t time, std::size_t column) {
    std::size_t rising = 0, falling = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        if (text_at(rows[i], time) != text_at(rows[i - 1], time)) continue;
        const auto before = parse_integer(text_at(rows[i - 1], column));
        const auto here = parse_integer(text_at(rows[i], column));
        if (!before || !here || *here == *before) return false;
        ++(*here > *before ? rising : falling);
    }
    return std::min(rising, falling) == 0 && 3 * std::max(rising, falling) >= rows.size();
}

/// Milliseconds in a column of their own, where times of day are whole seconds.
void find_milliseconds(Layout& layout, const Description& description, const Rows& rows) {
    if (description.time_format != TimeFormat::iso &&
        description.time_format != TimeFormat::time_of_day)
        return;
    if (!layout[Column::time] || !all_are(rows, *layout[Column::time], [](std::string_view text) {
            return seconds_text(text).find('.') == std::string_view::npos;
        }))
        return;
    for (std::size_t i = 0; i < layout.fields && !layout[Column::milliseconds]; ++i)
        if (!is_taken(layout, i) && is_named(layout.head.names[i].text, Column::milliseconds) &&
            all_are(rows, i,
                    [](std::string_view text) {
                        const auto value = parse_integer(text);
                        return value && *value >= 0 && *value <= 999;
                    }) &&
            parts_seconds(rows, *layout[Column::time], i))
            layout[Column::milliseconds] = i;
}

/// Whether every number of a column, zeros apart, is too large for degrees and can be degrees and
/// minutes, dddmm.mmmm.
bool shows_minutes(const Rows& rows, const std::optional<std::size_t>& column, double most_deg) {
    bool any = false;
    for (const std::vector<Cell>& row : rows) {
        std::string_view text = text_at(row, column);
        while (!text.empty() &&
               std::string_view("NSEWnsew ").find(text.back()) != std::string_view::npos)
            text.remove_suffix(1);
        const auto value = parse_double(text);
        if (!value || *value == 0.0) continue;
        const double size = std::abs(*value);
        if (size <= most_deg || size > 100.0 * most_deg || std::fmod(size, 100.0) >= 60.0)
            return false;
        any = true;
    }
    return any;
}

/// Both coordinates must show it, at all rows: one that would do as degrees, too, says nothing.
void find_angle_form(Layout& layout, const Rows& rows) {
    if (layout.both_in_one || !layout[Column::latitude] || !layout[Column::longitude]) return;
    if (shows_minutes(rows, layout[Column::latitude], 90.0) &&
        shows_minutes(rows, layout[Column::longitude], 180.0))
        layout.angles = AngleForm::degrees_and_minutes;
}

/// Whether most rows have no position, and something else.
bool are_between_sensors(const Layout& layout, const Rows& rows) {
    std::size_t without = 0;
    for (const std::vector<Cell>& row : rows) {
        const bool placed = !is_missing(text_at(row, layout[Column::latitude])) &&
                            !is_missing(text_at(row, layout[Column::longitude]));
        for (std::size_t i = 0; i < row.size() && !placed; ++i)
            if (!row[i].text.empty() && !is_taken(layout, i)) {
                ++without;
                break;
            }
    }
    return layout[Column::latitude] && layout[Column::longitude] && 2 * without > rows.size();
}

}  // namespace

void find_beside(Layout& layout, const Description& description, const Rows& rows) {
    const auto find = [&](Column column) {
        for (std::size_t i = 0; i < layout.fields && !layout[column]; ++i)
            if (!is_taken(layout, i) && is_named(layout.head.names[i].text, column))
                layout[column] = i;
    };
    find(Column::provider);
    find(Column::mock);
    find_milliseconds(layout, description, rows);
    if (description.frame != CoordinateFrame::geodetic) return;
    if (!layout.both_in_one && layout[Column::latitude] != layout[Column::longitude])
        find_hemispheres(layout, rows);
    find_angle_form(layout, rows);
    layout.between_sensors = are_between_sensors(layout, rows);
}

void find_beside(Layout& layout, const Description& description, const RecordingBytes& recording) {
    const auto name_of_place = [&](Column column) {
        return escape_for_message(layout.head.names[*layout[column]].text);
    };
    for (const auto& [column, other] :
         {std::pair{Column::latitude, Column::longitude}, {Column::longitude, Column::latitude}})
        if (layout[column] && !layout.both_in_one &&
            is_named(layout.head.names[*layout[column]].text, other))
            layout.head.names[*layout[column]].fail(
                fmt::format("the column \"{}\" is named for {}, and its own name says {}",
                            name_of_place(column), name_of(column), name_of(other)),
                "Exchange the two in columns, or give them by number if the header is wrong");
    Rows rows;
    visit_rows(layout.head, recording, [&](std::span<const Cell> cells) {
        rows.emplace_back(cells.begin(), cells.end());
        return rows.size() >= rows_looked_at;
    });
    find_beside(layout, description, rows);
    if (layout[Column::north_south] || layout[Column::east_west]) {
        std::string names;
        for (const Column column : {Column::north_south, Column::east_west})
            if (layout[column])
                names +=
                    fmt::format("{}\"{}\"", names.empty() ? "" : " and ", name_of_place(column));
        layout.notes.push_back(fmt::format("Hemispheres are those of {}.", names));
    }
    if (layout[Column::milliseconds])
        layout.notes.push_back(fmt::format("The milliseconds of times are those of \"{}\".",
                                           name_of_place(Column::milliseconds)));
    if (layout.angles == AngleForm::degrees_and_minutes)
        layout.notes.emplace_back(
            "Coordinates are degrees and minutes, dddmm.mmmm, as their size shows.");
    if (!layout.head.in_three.empty())
        layout.notes.emplace_back("Coordinates stand in three fields: degrees, minutes, seconds.");
}

}  // namespace runcert::csv
