#include "stages/import/vbo/vbo.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/format.h"

namespace runcert::vbo {
namespace {

constexpr int rows_counted = 100;
/// Of the ways of speeds and positions, logarithm of their ratio: a tenth.
constexpr double most_misfit_unnamed = 0.1;

/// Fields that most of the first whole rows of data from here on have; 0 where there is none.
std::size_t fields_of_rows(LineReader lines, const RecordingBytes& recording) {
    std::map<std::size_t, int> count;
    int rows = 0;
    for (auto line = lines.next(); line && rows < rows_counted; line = lines.next())
        if (const std::size_t fields = split(*line, recording).size(); fields > 0 && line->ended) {
            ++count[fields];
            ++rows;
        }
    const auto most =
        std::max_element(count.begin(), count.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    return most == count.end() ? 0 : most->first;
}

/// The layout with its columns from `at` on moved behind the fields that have no name.
Layout with_unnamed_at(Layout layout, std::size_t at) {
    for (auto& place : layout.place)
        if (place && *place >= at) *place += layout.fields - layout.named;
    layout.unnamed_at = at;
    return layout;
}

bool reads_first_row(LineReader lines, const RecordingBytes& recording, const Layout& layout) {
    for (auto line = lines.next(); line; line = lines.next()) {
        const std::vector<Cell> cells = split(*line, recording);
        if (cells.size() != layout.fields) continue;
        try {
            const Row fields(cells, layout);
            (void)read_row(fields, layout, true);
            return time_of_day_ns(fields.text(Column::time)).has_value();
        } catch (const Failure&) {
            return false;
        }
    }
    return true;
}

/// Of rows with more fields than names, the layout by which the recorded speeds are best those of
/// the positions, the fields without a name as far to the right as that holds. Failure where there
/// is none; without speeds, those fields stand last.
Layout place_unnamed(const Layout& from_left, const LineReader& lines, const Header& header,
                     const RecordingBytes& recording) {
    if (from_left.named >= from_left.fields) return from_left;
    std::optional<Layout> best;
    double least = most_misfit_unnamed;
    for (std::size_t at = from_left.named + 1; at-- > 0;) {
        const Layout moved = at == from_left.named ? from_left : with_unnamed_at(from_left, at);
        if (!reads_first_row(lines, recording, moved)) continue;
        const Survey surveyed = survey(lines, recording, moved);
        if (at == from_left.named && !surveyed.speeds_fit) best = moved;  // for want of speeds
        if (!surveyed.speeds_fit.value_or(false) || surveyed.misfit >= least) continue;
        least = surveyed.misfit;
        best = moved;
    }
    if (best) return *best;
    throw Failure(
        place_in(recording, header.names_line, 1),
        fmt::format("rows have {} fields, the header names {}, and in no order of them the speeds "
                    "are those of the positions",
                    from_left.fields, from_left.named),
        "Export the recording again, or as CSV with columns: in the receiver");
}

[[noreturn]] void refuse_time(const Cell& cell) {
    cell.fail(fmt::format("the time \"{}\" is not a time of day", escape_for_message(cell.text)),
              "Times are written as 062345.04: hours, minutes and seconds of UTC");
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
                          "most rows have", "Take the recording as the logger wrote it");
            const Row fields(cells, layout);
            TimedRow row = read_row(fields, layout, east_positive);
            const auto time_ns = time_of_day_ns(fields.text(Column::time));
            if (!time_ns) refuse_time(fields.cell(Column::time));
            try {
                row.instant = clock.next(*time_ns);
            } catch (const Failure& failure) {
                fields.cell(Column::time).fail(failure.problem(), failure.remedy());
            }
            return row;
        });
    }
    return timed;
}

void note_columns(Observations& observations, const Layout& layout) {
    if (layout.named != layout.fields)
        observations.notes.push_back(fmt::format(
            "Rows have {} fields, and the header names {} columns: these were counted "
            "from the left{}.",
            layout.fields, layout.named,
            layout.unnamed_at ? fmt::format(", fields without a name standing before column {}, "
                                            "where speeds and positions agree",
                                            *layout.unnamed_at + 1)
                              : ""));
    if (layout[Column::height]) observations.notes.emplace_back(note_heights_above_sea_level);
    if (layout[Column::vertical_velocity] && !layout.vertical_velocity_m_s)
        observations.notes.push_back(
            "The vertical velocity is recorded in a unit that the header does not name, and is not "
            "used.");
}

void note_longitudes(Observations& observations, LongitudeSense sense) {
    const auto first =
        std::find_if(observations.rows.begin(), observations.rows.end(),
                     [](const Observation& row) { return row.latitude_deg.has_value(); });
    if (first != observations.rows.end())
        observations.notes.push_back(
            longitude_note(sense, *first->latitude_deg, *first->longitude_deg));
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
    Layout layout = find_layout(header, fields_of_rows(lines, recording), recording);
    layout = place_unnamed(layout, lines, header, recording);
    const Survey surveyed = survey(lines, recording, layout);
    const std::string coordinates = coordinates_note(surveyed, layout);
    layout.coordinates = surveyed.coordinates;
    const FirstDay first_day = find_first_day(
        receiver, header.created, surveyed.first_time_ns.value_or(0), surveyed.first_longitude_deg);
    Observations observations =
        empty_observations("vbo", "geodetic", first_day.utc ? "utc" : "relative");
    observations.device = device_of(header);
    set_instrument(observations, instrument_of(header));
    set_rows(observations, read_rows(lines, recording, layout,
                                     surveyed.longitudes == LongitudeSense::east_positive,
                                     DayClock(first_day.utc)));
    observations.notes.push_back(first_day.note);
    if (!coordinates.empty()) observations.notes.push_back(coordinates);
    note_longitudes(observations, surveyed.longitudes);
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
    .of_satellites = true,
    .time_origin = "UTC of the receiver, the file's time channel",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::vbo
