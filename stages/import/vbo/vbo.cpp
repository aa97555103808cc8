#include "stages/import/vbo/vbo.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"

namespace runcert::vbo {
namespace {

constexpr int rows_counted = 100;
/// Of the ways of speeds and positions, logarithm of their ratio: a tenth.
constexpr double most_misfit_unnamed = 0.1;

// What Racelogic adds to the number of satellites.
constexpr std::int64_t satellites_mask = 63;  // 64: the brake trigger is on
constexpr std::int64_t differential_mark = 128;
constexpr std::int64_t largest_mark = 255;

void read_quality(const Row& fields, EpochQuality& quality) {
    using enum FixType;
    const bool has_solution = fields.has(Column::solution_type);
    if (has_solution) {
        // From -1 on, VBOX manuals; 2 has corrections of a base station or satellite.
        constexpr FixType types[] = {none,  none,    single,        dgps, float_ambiguities,
                                     fixed, unknown, dead_reckoning};
        const auto type = static_cast<std::size_t>(
            read_whole(fields.cell(Column::solution_type), "solution type", -1, largest_mark) + 1);
        quality.fix = type < std::size(types) ? types[type] : unknown;
    }
    if (!fields.has(Column::satellites)) return;
    const std::int64_t marked =
        read_whole(fields.cell(Column::satellites), "count of satellites", 0, largest_mark);
    quality.satellites = static_cast<std::int16_t>(marked & satellites_mask);
    if (*quality.satellites == 0 && quality.fix != dead_reckoning)
        quality.fix = none;
    else if (!has_solution && (marked & differential_mark) != 0)
        quality.fix = dgps;
}

/// From 0 to 360 degrees; loggers write some from -180 on.
std::optional<Angle> read_heading(const Row& fields) {
    if (!fields.has(Column::heading)) return std::nullopt;
    const double degrees = fields.real(Column::heading, "heading");
    if (!(std::abs(degrees) <= 360.0))
        fields.cell(Column::heading)
            .fail(fmt::format("a heading of {} degrees is impossible", degrees), as_written);
    return Angle::from_degrees(degrees < 0.0 ? degrees + 360.0 : degrees);
}

void read_velocity(const Row& fields, const Layout& layout, RecordedVelocity& velocity) {
    if (layout.vertical_velocity_m_s)
        velocity.recorded_velocity_up_m_s =
            fields.real(Column::vertical_velocity, "vertical velocity") *
            *layout.vertical_velocity_m_s;
    if (!layout.velocity_m_s) return;
    const double speed = fields.real(Column::velocity, "velocity");
    if (speed < 0.0)
        fields.cell(Column::velocity)
            .fail(fmt::format("a velocity of {} is impossible", speed), as_written);
    set_speed(velocity, speed * *layout.velocity_m_s, read_heading(fields));
}

double coordinate(const Row& fields, const Layout& layout, Column column,
                  std::string_view meaning) {
    const auto degrees = degrees_of(fields.real(column, meaning), layout.coordinates);
    if (!degrees)
        fields.cell(column).fail(fmt::format("the {} \"{}\" has 60 minutes or more", meaning,
                                             escape_for_message(fields.text(column))),
                                 as_written);
    return *degrees;
}

/// Reads everything of a row but its time. `east_positive`: which way longitudes count. Failure at
/// the field that cannot be read.
TimedRow read_row(const Row& fields, const Layout& layout, bool east_positive) {
    TimedRow row;
    row.written.time = fields.text(Column::time);
    read_quality(fields, row.observation);
    if (row.observation.fix == FixType::none) return row;
    const double latitude_deg = coordinate(fields, layout, Column::latitude, "latitude");
    const double longitude_deg =
        (east_positive ? 1.0 : -1.0) * coordinate(fields, layout, Column::longitude, "longitude");
    if (latitude_deg == 0.0 && longitude_deg == 0.0) {
        row.observation.fix = FixType::none;
        return row;
    }
    const bool has_height = fields.has(Column::height);
    const Geodetic position =
        checked_geodetic({.latitude = Angle::from_degrees(latitude_deg),
                          .longitude = Angle::from_degrees(longitude_deg),
                          .height_m = has_height ? fields.real(Column::height, "height") : 0.0},
                         fields.cell(Column::latitude), fields.cell(Column::longitude),
                         fields.cell(has_height ? Column::height : Column::latitude));
    set_position(row.observation, position);
    if (!has_height) row.observation.height_m.reset();
    row.written.unit = layout.coordinates == Coordinates::degrees ? CoordinateUnit::degree
                                                                  : CoordinateUnit::arc_minute;
    row.written.coordinates = {fields.text(Column::latitude), fields.text(Column::longitude)};
    read_velocity(fields, layout, row.observation);
    return row;
}

/// The first row that has as many fields as most of the first whole rows from here on; empty where
/// there is none.
std::vector<Cell> first_row(LineReader lines, const RecordingBytes& recording) {
    std::map<std::size_t, std::vector<std::vector<Cell>>> by_fields;
    int rows = 0;
    for (auto line = lines.next(); line && rows < rows_counted; line = lines.next())
        if (const std::vector<Cell> cells = split(*line, recording);
            !cells.empty() && line->ended) {
            by_fields[cells.size()].push_back(cells);
            ++rows;
        }
    const auto most = std::ranges::max_element(by_fields, {},
                                               [](const auto& each) { return each.second.size(); });
    return most == by_fields.end() ? std::vector<Cell>() : most->second.front();
}

/// Of rows with more fields than names, the layout by which the recorded speeds are best those of
/// the positions, the fields without a name as far to the right as that holds. Failure where there
/// is none; without speeds, those fields stand last.
Layout place_unnamed(const Layout& from_left, std::span<const Cell> first, const LineReader& lines,
                     const Header& header, const RecordingBytes& recording) {
    if (from_left.named >= from_left.fields) return from_left;
    std::optional<Layout> best;
    double least = most_misfit_unnamed;
    for (std::size_t at = from_left.named + 1; at-- > 0;) {
        Layout shifted = from_left;
        shifted.unnamed_at = at;
        for (auto& place : shifted.place)
            if (place && *place >= at) *place += from_left.fields - from_left.named;
        try {
            (void)read_row(Row(first, shifted), shifted, true);
        } catch (const Failure&) {
            continue;
        }
        if (!time_of_day_ns(first[*shifted[Column::time]].text)) continue;
        const Survey surveyed = survey(lines, recording, shifted);
        if (at == from_left.named && !surveyed.speeds_fit) best = shifted;  // for want of speeds
        if (!surveyed.speeds_fit.value_or(false) || surveyed.misfit >= least) continue;
        least = surveyed.misfit;
        best = shifted;
    }
    if (best) return *best;
    throw Failure(
        header.names_place(recording),
        fmt::format("rows have {} fields, the header names {}, and in no order of them the speeds "
                    "are those of the positions",
                    from_left.fields, from_left.named),
        "Export the recording again, or as CSV with columns: in the receiver");
}

/// Reads the rows, of which the clock gives the instants.
RowCollector read_rows(LineReader lines, const RecordingBytes& recording, const Layout& layout,
                       bool east_positive, DayClock clock) {
    RowCollector timed(recording);
    while (const auto line = lines.next()) {
        if (trim(line->text).empty()) continue;
        timed.add_record(*line, [&] {
            const std::vector<Cell> cells = split(*line, recording);
            require_count(cells.size(), layout.fields, *line, recording, lines.at_end(),
                          "most rows have", as_written);
            const Row fields(cells, layout);
            const Cell& time = fields.cell(Column::time);
            TimedRow row = read_row(fields, layout, east_positive);
            const auto time_ns = time_of_day_ns(time.text);
            if (!time_ns)
                time.fail(fmt::format("the time \"{}\" is not a time of day",
                                      escape_for_message(time.text)),
                          "Times are written as 062345.04: hours, minutes and seconds of UTC");
            try {
                row.instant = clock.next(*time_ns);
            } catch (const Failure& failure) {
                time.fail(failure.problem(), failure.remedy());
            }
            return row;
        });
    }
    return timed;
}

/// Says what coordinates are written in, where that is not as the header says, and how it is known.
void note_coordinates(Observations& observations, const Survey& surveyed, Coordinates stated) {
    constexpr std::array<std::string_view, 3> words{"minutes of arc", "decimal degrees",
                                                    "degrees and minutes (DDMM.MMMM)"};
    if (surveyed.coordinates == stated) return;
    observations.notes.push_back(
        fmt::format("Coordinates were taken as {}, not as {}: {}.",
                    words[static_cast<std::size_t>(surveyed.coordinates)],
                    words[static_cast<std::size_t>(stated)],
                    surveyed.speeds_fit.value_or(false)
                        ? "the recorded speeds fit the positions so"
                        : "the positions lie so on the Earth, and no speeds confirm it"));
}

/// Says how the longitudes were taken, with the first position for a person to check.
void note_longitudes(Observations& observations, const std::optional<bool>& east_positive) {
    const auto first = std::ranges::find_if(
        observations.rows, [](const Observation& row) { return row.latitude_deg.has_value(); });
    if (first == observations.rows.end()) return;
    const double latitude_deg = *first->latitude_deg, longitude_deg = *first->longitude_deg;
    const std::string place = fmt::format(
        "{} {}, {} {}", format_fixed(std::abs(latitude_deg), 5), latitude_deg < 0.0 ? "S" : "N",
        format_fixed(std::abs(longitude_deg), 5), longitude_deg < 0.0 ? "W" : "E");
    if (!east_positive)
        observations.notes.push_back(fmt::format(
            "Longitudes were taken as positive to the west, the rule of the format, which nothing "
            "in the recording confirms: look whether the first position, {}, is on the right side "
            "of the world.",
            place));
    else
        observations.notes.push_back(fmt::format(
            "Longitudes are recorded positive to the {}; the first position is {}.",
            *east_positive
                ? "east, as the headings show, though the format has them positive to the west"
                : "west, as the headings confirm",
            place));
}

void note_columns(Observations& observations, const Layout& layout) {
    if (layout.named != layout.fields)
        observations.notes.push_back(
            fmt::format("Rows have {} fields, and the header names {} columns: these were counted "
                        "from the left{}.",
                        layout.fields, layout.named,
                        layout.unnamed_at < layout.named
                            ? fmt::format(", fields without a name standing before column {}, "
                                          "where speeds and positions agree",
                                          layout.unnamed_at + 1)
                            : ""));
    if (layout[Column::height]) observations.notes.emplace_back(note_heights_above_sea_level);
    if (layout[Column::vertical_velocity] && !layout.vertical_velocity_m_s)
        observations.notes.push_back(
            "The vertical velocity is recorded in a unit that the header does not name, and is not "
            "used.");
}

bool recognises(std::string_view bytes) {
    LineReader lines(bytes);
    bool named = false, header = false;
    while (const auto line = lines.next()) {
        const std::string text = lower_case(trim(line->text).substr(0, 40));
        if (line->number == 1 && text.starts_with("file created on")) return true;
        named = named || text == "[column names]";
        header = header || text == "[header]";
        if (text == "[data]") return named || header;
    }
    return named;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_text(recording);
    LineReader lines(recording);
    const Header header = read_header(lines, recording);
    const std::vector<Cell> first = first_row(lines, recording);
    Layout layout = find_layout(header, first.size(), recording);
    layout = place_unnamed(layout, first, lines, header, recording);
    const Survey surveyed = survey(lines, recording, layout);
    const Coordinates stated = std::exchange(layout.coordinates, surveyed.coordinates);
    const FirstDay first_day = find_first_day(receiver, header, surveyed);
    Observations observations =
        empty_observations("vbo", "geodetic", first_day.utc ? "utc" : "relative");
    set_device(observations, header);
    set_rows(observations,
             read_rows(lines, recording, layout, surveyed.east_positive.value_or(false),
                       DayClock(first_day.utc)));
    observations.notes.push_back(first_day.note);
    note_coordinates(observations, surveyed, stated);
    note_longitudes(observations, surveyed.east_positive);
    note_columns(observations, layout);
    apply_attempt(observations, receiver, first_day.by_start_gps);
    note_text(observations, recording);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "vbo",
    .what = "Racelogic VBO",
    .place = 60,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver, the file's time channel",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::vbo
