#include "stages/import/csv/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/text.h"

namespace runcert::csv {
namespace {

constexpr std::size_t lines_proposed_from = 100;
constexpr std::size_t lines_between = 4;  ///< of units, between header and first row
constexpr std::size_t rows_seen = 50;

std::size_t numbers_in(std::span<const Cell> cells) {
    return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [](const Cell& cell) {
        return parse_double(cell.text).has_value() || with_decimal_point(cell.text);
    }));
}

/// Numbers, and what begins as one: times, angles, numbers with their unit, "S31.6".
std::size_t values_in(std::span<const Cell> cells) {
    return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [](const Cell& cell) {
        std::string_view text = cell.text;
        constexpr std::string_view before_numbers = "+-NSEWnsew ";
        while (!text.empty() && before_numbers.find(text.front()) != std::string_view::npos)
            text.remove_prefix(1);
        return !text.empty() && is_digit(text.front());
    }));
}

/// Whether the cells could be a row under that header.
bool is_row_of(std::span<const Cell> cells, const Head& head) {
    const std::size_t names = head.names.size();
    const std::size_t more = 2 * head.in_three.size();
    return cells.size() >= names && (cells.size() <= names + 1 || cells.size() == names + more) &&
           values_in(cells) >= 2;
}

/// How a column's name is that of a meaning.
enum class Match { whole, begins, within };

/// Names that begin so, or hold it, are of something else: "lateral_g", "speed_accuracy".
bool is_of_another(const std::string& name, Column column) {
    constexpr std::array<std::string_view, 13> others{
        "acc",    "error",  "sigma",        "std",     "dop", "offset", "delta",
        "latera", "latenc", "longitudinal", "elapsed", "age", "rate"};
    for (const std::string_view other : others)
        if (name.find(other) != std::string::npos) return true;
    const bool of_speed =
        name.find("vel") != std::string::npos || name.find("speed") != std::string::npos;
    return of_speed && column != Column::speed && column != Column::velocity_east &&
           column != Column::velocity_north && column != Column::velocity_up;
}

bool matches(const std::string& name, std::string_view known, Match match, Column column) {
    if (match == Match::whole) return name == known;
    if (known.size() < 3 || is_of_another(name, column)) return false;
    if (match == Match::begins) return name.starts_with(known);
    const bool needed =
        column == Column::time || column == Column::latitude || column == Column::longitude;
    return needed && known.size() >= 4 && name.find(known) != std::string::npos;
}

/// What a column's cells are in the rows that were seen.
struct Cells {
    std::size_t filled = 0, numbers = 0, decimals = 0;
    double least = std::numeric_limits<double>::infinity();
    double most = -std::numeric_limits<double>::infinity();
    bool whole = true, rising = true;
};

Cells cells_in(const SeenTable& table, std::size_t column) {
    Cells cells;
    std::optional<double> before;
    for (const std::vector<Cell>& row : table.rows) {
        if (column >= row.size() || is_missing(row[column].text)) continue;
        ++cells.filled;
        const std::string_view text = row[column].text;
        const auto number = number_in(text);
        if (!number) continue;
        ++cells.numbers;
        const std::size_t point = text.find('.');
        if (point != std::string_view::npos)
            cells.decimals = std::max(cells.decimals, text.size() - point - 1);
        cells.least = std::min(cells.least, *number);
        cells.most = std::max(cells.most, *number);
        cells.whole = cells.whole && *number == std::floor(*number);
        cells.rising = cells.rising && (!before || *number >= *before);
        before = number;
    }
    return cells;
}

/// Whether what a column holds can be of that meaning. Numbers for a fix type are every program's
/// own, and are not taken.
bool can_hold(const SeenTable& table, std::size_t column, Column meaning) {
    const Cells cells = cells_in(table, column);
    if (cells.filled == 0) return false;
    const auto between = [&](double least, double most) {
        return cells.numbers > 0 && cells.least >= least && cells.most <= most;
    };
    switch (meaning) {
        case Column::latitude:
            return cells.numbers == 0 || between(-90.0, 90.0);
        case Column::longitude:
            return cells.numbers == 0 || between(-180.0, 360.0);
        case Column::time:
            return cells.numbers == 0 || (cells.rising && cells.most > cells.least) ||
                   table.rows.size() == 1;
        case Column::date:
            return is_date(table.first(column)) ||
                   is_date(table.first(column).substr(0, table.first(column).find_first_of("T ")));
        case Column::week:
            return cells.whole && between(0.0, 9999.0);
        case Column::height:
            return between(-2000.0, 100'000.0);
        case Column::speed:
            return between(0.0, 5000.0);
        case Column::course:
            return between(-180.0, 360.0) && cells.numbers > 0;
        case Column::satellites:
            return cells.whole && between(0.0, 1000.0);
        case Column::quality_2d:
        case Column::quality_height:
        case Column::sigma_speed:
        case Column::sigma_east:
        case Column::sigma_north:
        case Column::sigma_up:
            return between(0.0, 1e6);
        case Column::fix:
            return cells.numbers == 0 && fix_by_word(table.first(column));
        case Column::north_south:
        case Column::east_west:
        case Column::milliseconds:
        case Column::provider:
        case Column::mock:
            return false;  // find_beside finds these
        default:
            return cells.numbers > 0;
    }
}

/// Finds the columns of these names that are not taken, and can hold what they are called.
void take_names(const SeenTable& table, std::span<const KnownNames> names, bool must_fit,
                Layout& layout) {
    const auto is_taken = [&](std::size_t column) {
        return std::ranges::find(layout.place, std::optional(column)) != layout.place.end();
    };
    for (const Match match : {Match::whole, Match::begins, Match::within})
        for (const KnownNames& known : names)
            for (const std::string_view name : words_of(known.names))
                for (std::size_t i = 0; i < table.head.names.size(); ++i)
                    if (!layout[known.column] && !is_taken(i) &&
                        matches(letters_of(table.head.names[i].text), name, match, known.column) &&
                        (!must_fit || can_hold(table, i, known.column)))
                        layout[known.column] = i;
}

/// The columns that somebody names, by name or number.
void take_given(const SeenTable& table, const CsvColumns& given, Layout& layout) {
    const std::vector<Cell>& names = table.head.names;
    for (const auto& column : given) {
        const std::string& meaning = column.first;
        const std::string& source = column.second;
        const auto kind = std::ranges::find(column_kinds, meaning, &ColumnKind::name);
        if (kind == column_kinds.end()) continue;  // who reads the columns says it
        const auto name = std::ranges::find_if(
            names, [&](const Cell& cell) { return table.has_names && cell.text == trim(source); });
        const auto number = parse_integer(source);
        const bool in_table =
            number && *number >= 1 && static_cast<std::uint64_t>(*number) <= names.size();
        if (name == names.end() && !in_table)
            names.front().fail(
                fmt::format("the table has no column \"{}\" (for {})", escape_for_message(source),
                            meaning),
                fmt::format("Give its name, or a number from 1 to {}", names.size()));
        layout.place[static_cast<std::size_t>(kind - column_kinds.begin())] =
            name != names.end() ? static_cast<std::size_t>(name - names.begin())
                                : static_cast<std::size_t>(*number - 1);
    }
}

void drop(Layout& layout, std::initializer_list<Column> columns) {
    for (const Column column : columns)
        layout[column].reset();
}

/// Whether three coordinates are as far from the Earth's centre as its surface is.
bool are_earth_centred(const SeenTable& table, const Layout& layout) {
    double sum = 0.0;
    for (const Column column : {Column::x, Column::y, Column::z}) {
        const auto value =
            layout[column] ? parse_double(table.first(*layout[column])) : std::nullopt;
        if (!value) return false;
        sum += *value * *value;
    }
    return sum > 6.2e6 * 6.2e6 && sum < 6.6e6 * 6.6e6;
}

/// Of the kinds of coordinates the first that is there.
void take_coordinates(const SeenTable& table, Layout& layout) {
    take_names(table, geodetic_names(), true, layout);
    for (const std::string_view both : names_of_both())
        for (std::size_t i = 0; i < table.head.names.size(); ++i)
            if (!layout[Column::latitude] && !layout[Column::longitude] &&
                letters_of(table.head.names[i].text) == both)
                layout[Column::latitude] = layout[Column::longitude] = i;
    if (layout[Column::latitude] && layout[Column::longitude]) return;
    Layout other = layout;
    drop(other, {Column::latitude, Column::longitude, Column::height});
    Layout ecef = other;
    take_names(table, ecef_names(), true, ecef);
    if (are_earth_centred(table, ecef)) {
        layout = ecef;
        return;
    }
    take_names(table, plane_names(), true, other);
    if (other[Column::east] && other[Column::north]) {
        layout = other;
        return;
    }
    // Named so, whatever they hold: reading says what is wrong with it.
    take_names(table, geodetic_names(), false, layout);
}

/// Two columns beside each other that change little, with the decimals of degrees; and before them
/// a time that rises.
void take_values(const SeenTable& table, Layout& layout) {
    constexpr std::size_t decimals_of_degrees = 5;
    constexpr double far_deg = 2.0;
    const auto is_degrees = [&](std::size_t column, double most) {
        const Cells cells = cells_in(table, column);
        return cells.numbers == table.rows.size() && cells.decimals >= decimals_of_degrees &&
               cells.least >= -most && cells.most <= most && cells.most - cells.least < far_deg &&
               std::abs(cells.most) > 0.5;
    };
    const std::size_t columns = table.head.names.size();
    for (std::size_t i = 0; i + 1 < columns; ++i) {
        if (!is_degrees(i, 90.0) || !is_degrees(i + 1, 180.0)) continue;
        for (std::size_t time = 0; time < i && !layout[Column::time]; ++time) {
            const Cells cells = cells_in(table, time);
            const bool dated =
                cells.numbers == 0 && table.first(time).find(':') != std::string_view::npos;
            if (dated ||
                (cells.numbers == table.rows.size() && cells.rising && cells.most > cells.least))
                layout[Column::time] = time;
        }
        layout[Column::latitude] = i;
        layout[Column::longitude] = i + 1;
        const Cells height = i + 2 < columns ? cells_in(table, i + 2) : Cells{};
        if (height.numbers == table.rows.size() && height.decimals > 0 && height.least > -500.0 &&
            height.most < 9000.0)
            layout[Column::height] = i + 2;
        return;
    }
}

/// The line that a cell stands on.
std::string_view line_of(const RecordingBytes& recording, const Cell& cell) {
    const auto at = static_cast<std::size_t>(cell.text.data() - recording.bytes.data());
    const std::size_t begin = at == 0 ? 0 : recording.bytes.find_last_of('\n', at - 1) + 1;
    std::string_view line = recording.bytes.substr(begin, recording.bytes.find('\n', at) - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

}  // namespace

std::string_view SeenTable::first(std::size_t column) const {
    for (const std::vector<Cell>& row : rows)
        if (column < row.size() && !row[column].text.empty()) return row[column].text;
    return {};
}

std::optional<SeenTable> find_table(const RecordingBytes& recording) {
    std::vector<Head> lines;
    (void)find_head(recording, std::nullopt, [&](std::span<const Cell> cells, bool comment) {
        if (!comment && cells.size() > 2) {
            lines.emplace_back();
            lines.back().names.assign(cells.begin(), cells.end());
        }
        return lines.size() >= lines_proposed_from;
    });
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const bool names = numbers_in(lines[i].names) < 2;
        lines[i].delimiter = find_delimiter(line_of(recording, lines[i].names.front()));
        for (std::size_t j = names ? i + 1 : i; j < std::min(lines.size(), i + 2 + lines_between);
             ++j) {
            if (names && numbers_in(lines[j].names) >= 2) find_in_three(lines[i], lines[j].names);
            if (!is_row_of(lines[j].names, lines[i])) continue;
            SeenTable table{.head = lines[i], .rows = {}, .has_names = names};
            table.head.line = lines[i].names.front().line;
            table.head.first_row = lines[j].names.front().line;
            const auto row_of = [&](const Head& line) {
                const Cell& first = line.names.front();
                return table.head.in_three.empty()
                           ? line.names
                           : table.head.row(
                                 {.text = line_of(recording, first), .number = first.line},
                                 recording);
            };
            for (std::size_t k = i + 1; k < j; ++k)
                table.head.under.push_back(row_of(lines[k]));
            for (std::size_t k = j; k < lines.size() && table.rows.size() < rows_seen; ++k)
                if (is_row_of(lines[k].names, lines[i])) table.rows.push_back(row_of(lines[k]));
            return table;
        }
    }
    return std::nullopt;
}

Layout find_columns(const SeenTable& table, const CsvColumns& given) {
    Layout layout;
    layout.head = table.head;
    layout.fields = table.head.names.size();
    take_given(table, given, layout);
    if (!table.has_names) {
        if (given.empty()) take_values(table, layout);
        return layout;
    }
    take_names(table, other_names(), true, layout);
    take_coordinates(table, layout);
    if (!layout[Column::time] && !layout[Column::date]) {
        take_names(table, other_names().first(1), false, layout);
    }
    if (layout[Column::velocity_east].has_value() != layout[Column::velocity_north].has_value())
        drop(layout, {Column::velocity_east, Column::velocity_north});
    if (layout[Column::velocity_east])
        drop(layout, {Column::speed, Column::course});
    else
        drop(layout, {Column::velocity_up});
    if (!layout[Column::speed]) drop(layout, {Column::course});
    if (layout[Column::sigma_east].has_value() != layout[Column::sigma_north].has_value())
        drop(layout, {Column::sigma_east, Column::sigma_north});
    if (layout[Column::sigma_east]) drop(layout, {Column::quality_2d});
    if (layout[Column::sigma_up]) drop(layout, {Column::quality_height});
    if (!layout[Column::speed] && !layout[Column::velocity_east])
        drop(layout, {Column::sigma_speed});
    return layout;
}

CoordinateFrame frame_of(const SeenTable& table, const Layout& layout) {
    if (layout[Column::x]) return CoordinateFrame::ecef;
    if (!layout[Column::east]) return CoordinateFrame::geodetic;
    const Cells east = cells_in(table, *layout[Column::east]);
    const Cells north = cells_in(table, *layout[Column::north]);
    const bool utm = east.least >= 1e5 && east.most < 1e6 && north.least >= 0.0 &&
                     north.most <= 1e7 && north.most > 1e5;
    return utm ? CoordinateFrame::utm : CoordinateFrame::local_plane;
}

bool has_decimal_commas(const SeenTable& table, std::size_t column) {
    return std::ranges::any_of(table.rows, [&](const std::vector<Cell>& row) {
        return column < row.size() && with_decimal_point(row[column].text).has_value();
    });
}

}  // namespace runcert::csv
