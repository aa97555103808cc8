#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "stages/import/csv/csv.h"
#include "stages/import/csv/layout.h"
#include "stages/import/import.h"
#include "stages/import/inspect.h"
#include "stages/import/recording.h"

namespace runcert::csv {
namespace {

/// What an attempt could say of a table that no format recognises.
struct Proposal {
    Receiver receiver;                 ///< reads the table, as far as `missing` is empty
    std::string columns;               ///< "time: t, latitude: lat", as YAML has them
    std::string first_row;             ///< "lat 52.1, lon 5.1"
    std::vector<std::string> missing;  ///< keys of columns that no name shows
    std::vector<std::string> unsure;   ///< sentences
    bool speed_unit_unknown = false;

    /// What to write into the attempt's receiver.
    std::string yaml() const {
        std::string text =
            fmt::format("format: csv\ncolumns: {{{}}}\nframe: geodetic\ntime_format: {}\n", columns,
                        receiver.time_format);
        if (!receiver.time_scale.empty()) text += "time_scale: " + receiver.time_scale + "\n";
        if (!receiver.speed_unit.empty()) text += "speed_unit: " + receiver.speed_unit + "\n";
        if (receiver.height_m) text += "height_m: 0\n";
        return text;
    }
};

constexpr std::size_t lines_proposed_from = 100;
constexpr std::size_t lines_between = 4;  ///< of units, between header and first row
constexpr std::size_t cells_shown = 40;

struct Table {
    Head head;
    std::vector<Cell> row;
    bool has_names = true;
};

std::size_t numbers_in(std::span<const Cell> cells) {
    return static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), [](const Cell& cell) {
        return parse_double(cell.text).has_value();
    }));
}

/// Whether the cells could be a row under a header of so many.
bool is_row_of(std::span<const Cell> cells, std::size_t names) {
    return cells.size() >= names && cells.size() <= names + 1 && numbers_in(cells) >= 2;
}

/// The header line and the first row; the row alone where the table begins with one.
std::optional<Table> find_table(const RecordingBytes& recording) {
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
        for (std::size_t j = names ? i + 1 : i; j < std::min(lines.size(), i + 2 + lines_between);
             ++j)
            if (is_row_of(lines[j].names, lines[i].names.size()))
                return Table{lines[i], lines[j].names, names};
    }
    return std::nullopt;
}

/// Letters and digits of a name without its unit, in lower case.
std::string letters(std::string_view name) {
    std::string text = lower_case(without_unit(name));
    std::erase_if(text, [](char c) { return !((c >= 'a' && c <= 'z') || is_digit(c)); });
    return text;
}

/// As programs call their columns; of several for one meaning the first that is there.
struct KnownNames {
    Column column;
    std::vector<std::string_view> names;
};
const std::array known_names{
    KnownNames{Column::time,
               {"utctime", "gpstime", "timestamp", "datetime", "timeutc", "time", "utc", "unixtime",
                "tow", "epoch"}},
    KnownNames{Column::week, {"gpsweek", "week"}},
    KnownNames{Column::date, {"utcdate", "gpsdate", "date"}},
    KnownNames{Column::latitude, {"latitude", "gpslatitude", "gpslat", "lat"}},
    KnownNames{Column::longitude,
               {"longitude", "gpslongitude", "gpslong", "gpslon", "gpslng", "long", "lon", "lng"}},
    KnownNames{Column::height,
               {"height", "altitude", "gpsaltitude", "gpsalt", "elevation", "alt", "ele", "hmsl"}},
    KnownNames{
        Column::speed,
        {"gpsspeed", "groundspeed", "gspd", "sog", "speed", "velocity", "kph", "kmh", "mph"}},
    KnownNames{Column::course, {"course", "cog", "heading", "bearing", "hdg"}},
    KnownNames{Column::satellites, {"satellites", "sats", "numsv"}}};

/// Columns of both coordinates.
constexpr std::array<std::string_view, 6> both_names{"gps",    "latlon",      "latlong",
                                                     "latlng", "coordinates", "position"};

/// Of names that are known ("lat"), or begin so ("lat_wgs84"): those come second.
std::optional<std::size_t> find_name(const Head& head, std::string_view known, bool whole) {
    for (std::size_t i = 0; i < head.names.size(); ++i) {
        const std::string name = letters(head.names[i].text);
        if (whole ? name == known : known.size() >= 3 && name.starts_with(known)) return i;
    }
    return std::nullopt;
}

Layout find_columns(const Table& table) {
    Layout layout;
    layout.head = table.head;
    layout.fields = table.head.names.size();
    for (const bool whole : {true, false})
        for (const KnownNames& known : known_names)
            for (const std::string_view name : known.names) {
                const auto found = find_name(table.head, name, whole);
                const bool taken = std::find(layout.place.begin(), layout.place.end(), found) !=
                                   layout.place.end();
                if (found && !taken && !layout[known.column]) layout[known.column] = found;
            }
    for (const std::string_view both : both_names)
        if (const auto found = find_name(table.head, both, true);
            found && !layout[Column::latitude] && !layout[Column::longitude])
            layout[Column::latitude] = layout[Column::longitude] = found;
    if (!layout[Column::speed]) layout[Column::course].reset();
    return layout;
}

std::string_view cell_of(const Table& table, const Layout& layout, Column column) {
    const auto& place = layout[column];
    return place && *place < table.row.size() ? table.row[*place].text : std::string_view();
}

void set_time(const Table& table, Layout& layout, Proposal& proposal) {
    Receiver& receiver = proposal.receiver;
    const std::string_view time = cell_of(table, layout, Column::time);
    const std::string_view date = cell_of(table, layout, Column::date);
    // A column "date" may hold both.
    if (!layout[Column::time] && layout[Column::date]) {
        layout[Column::time] = std::exchange(layout[Column::date], std::nullopt);
        return set_time(table, layout, proposal);
    }
    const auto number = parse_double(time);
    receiver.time_format = "seconds";
    if (!is_date(time) && is_date(date) && !time.empty()) {
        receiver.time_format = "time_of_day";
    } else if (number) {
        receiver.time_format = layout[Column::week] ? "seconds_of_week"
                               : unix_shift(time)   ? "unix"
                                                    : "seconds";
    } else if (time.find(':') != std::string_view::npos || is_date(time)) {
        receiver.time_format = "iso";
    }
    if (receiver.time_format != "time_of_day") layout[Column::date].reset();
    if (receiver.time_format != "seconds_of_week") layout[Column::week].reset();
    if (receiver.time_format == "seconds")
        proposal.unsure.emplace_back(
            "Times are counts of seconds: start_gps says at which GPS time they begin.");
    if ((receiver.time_format == "iso" && !time.ends_with('Z')) ||
        receiver.time_format == "time_of_day") {
        receiver.time_scale = "utc";
        proposal.unsure.emplace_back(
            "Nothing says whether times are UTC: else write time_scale: local and utc_offset_h, or "
            "gps.");
    }
}

void set_speed_unit(const Layout& layout, Proposal& proposal) {
    const auto& place = layout[Column::speed];
    if (!place || unit_of_column(layout.head, *place)) return;
    const std::string name = letters(layout.head.names[*place].text);
    for (const auto& [ending, unit] : {std::pair<std::string_view, std::string_view>{"kmh", "km/h"},
                                       {"kph", "km/h"},
                                       {"mph", "mph"},
                                       {"knots", "kn"},
                                       {"kn", "kn"},
                                       {"mps", "m/s"},
                                       {"ms", "m/s"}})
        if (name.ends_with(ending)) {
            proposal.receiver.speed_unit = unit;
            return;
        }
    proposal.speed_unit_unknown = true;
}

/// A column's name, or its number where its name is there twice or empty.
std::string source_of(const Layout& layout, std::size_t place) {
    const std::string_view name = layout.head.names[place].text;
    const auto same = std::count_if(layout.head.names.begin(), layout.head.names.end(),
                                    [&](const Cell& cell) { return cell.text == name; });
    if (name.empty() || same > 1 || !is_printable_ascii(name)) return fmt::format("{}", place + 1);
    return std::string(name);
}

/// A name as YAML has it.
std::string yaml_of(const std::string& name) {
    if (parse_integer(name)) return name;
    const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_';
    });
    const bool word = plain && !is_digit(name.front()) && name.size() > 1;
    if (word) return name;
    std::string quoted = "'";
    for (const char c : name)
        quoted += c == '\'' ? std::string("''") : std::string(1, c);
    return quoted + "'";
}

void set_columns(const Layout& layout, Proposal& proposal) {
    std::string columns;
    const auto add = [&](Column column, const std::string& source) {
        columns += fmt::format("{}{}: {}", columns.empty() ? "" : ", ", name_of(column), source);
    };
    for (const Column column :
         {Column::date, Column::time, Column::week, Column::latitude, Column::longitude,
          Column::height, Column::speed, Column::course, Column::satellites}) {
        const auto& place = layout[column];
        const bool required =
            column == Column::time || column == Column::latitude || column == Column::longitude;
        if (!place && required) proposal.missing.emplace_back(name_of(column));
        if (!place && required) add(column, "...");
        if (!place) continue;
        const std::string source = source_of(layout, *place);
        add(column, yaml_of(source));
        proposal.receiver.columns[std::string(name_of(column))] = source;
    }
    proposal.columns = columns;
    if (layout[Column::height]) return;
    proposal.receiver.height_m = 0.0;
    proposal.unsure.emplace_back(
        "No column holds heights: write the course's height above the ellipsoid in place of 0.");
}

std::string first_row_of(const Table& table) {
    std::string text;
    for (std::size_t i = 0; i < std::min(table.row.size(), cells_shown); ++i) {
        const std::string_view name = table.has_names && i < table.head.names.size()
                                          ? table.head.names[i].text
                                          : std::string_view();
        text += fmt::format("{}{} {}", i == 0 ? "" : ", ",
                            name.empty() ? fmt::format("{}:", i + 1) : escape_for_message(name, 40),
                            escape_for_message(table.row[i].text, 40));
    }
    return text;
}

/// By the names of the header line and the first row. Nothing for a text that is no table.
std::optional<Proposal> propose(const RecordingBytes& recording) {
    const auto table = find_table(recording);
    if (!table) return std::nullopt;
    Proposal proposal;
    proposal.first_row = first_row_of(*table);
    Layout layout = find_columns(*table);
    proposal.receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    proposal.receiver.format = "csv";
    set_time(*table, layout, proposal);
    set_speed_unit(layout, proposal);
    if (layout[Column::latitude] && layout[Column::latitude] == layout[Column::longitude])
        proposal.unsure.emplace_back(
            "One column holds both coordinates: it is read as latitude, then longitude.");
    if (!table->has_names)
        proposal.unsure.emplace_back("There is no header line: give columns by number, from 1.");
    set_columns(layout, proposal);
    return proposal;
}

/// Reads the recording as it is proposed. A speed unit that nobody names is the one by which the
/// fastest speed recorded is that of the positions.
Inspection read_as(Proposal& proposal, const RecordingBytes& recording) {
    const auto read = [&] {
        Observations observations = import_recording(proposal.receiver, recording);
        note_written_by(recording, false, observations);
        return inspect(observations);
    };
    const Inspection first = read();
    if (!proposal.speed_unit_unknown || !first.best_by_position || !first.best_by_velocity)
        return first;
    const auto unit =
        speed_unit_of_ratio(first.best_by_velocity->speed_m_s / first.best_by_position->speed_m_s);
    if (!unit) {
        proposal.unsure.emplace_back(
            "The unit of speeds is not named, and none fits the positions: write speed_unit.");
        return first;
    }
    proposal.receiver.speed_unit = unit->name;
    proposal.unsure.push_back(
        fmt::format("The unit of speeds is not named: {} fits the positions.", unit->name));
    return read();
}

/// What the recording is, read as it is proposed, where it can be.
std::optional<Section> section_as(Proposal& proposal, const RecordingBytes& recording) {
    for (const std::string& key : proposal.missing)
        proposal.unsure.push_back(
            fmt::format("No column's name says which holds the {}: write it in place of ...", key));
    if (!proposal.missing.empty()) return std::nullopt;
    try {
        Section section = positions_section(read_as(proposal, recording));
        section.title = "Positions, so described";
        return section;
    } catch (const Failure& failure) {
        proposal.unsure.push_back(fmt::format("So described, it cannot be read. {}: {} {}",
                                              failure.where(), sentence(failure.problem()),
                                              sentence(failure.remedy())));
        return std::nullopt;
    }
}

}  // namespace
}  // namespace runcert::csv

namespace runcert {

std::vector<Section> table_sections(const RecordingBytes& recording) {
    auto proposal = csv::propose(recording);
    if (!proposal) return {};
    proposal->receiver.id = "inspected";
    proposal->receiver.place = recording.name;
    const std::optional<Section> read = csv::section_as(*proposal, recording);
    Section section{.anchor = "description", .title = "Description"};
    add(section,
        {paragraph("A table that no format recognises. An attempt's receiver may say:"),
         code(proposal->yaml()), facts({{.name = "First row", .value = proposal->first_row}})});
    if (!proposal->unsure.empty()) add(section, list_of(std::move(proposal->unsure)));
    std::vector<Section> sections{std::move(section)};
    if (read) sections.push_back(*read);
    return sections;
}

}  // namespace runcert
