#include "stages/import/csv/preset.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/text.h"
#include "stages/import/csv/csv.h"
#include "stages/import/inspect.h"
#include "stages/import/row_collector.h"

namespace runcert::csv {
namespace {

/// Counts of seconds from here on are those since 1970, not since the recording's beginning.
constexpr double least_unix_s = 1e8;
constexpr std::int64_t preset_lines_looked_at = 300;

bool has_name(const Cell& cell, std::string_view name) {
    return lower_case(without_unit(cell.text)) == name;
}

bool is_of_receiver(const Head& head, std::size_t column) {
    return std::any_of(head.under.begin(), head.under.end(), [&](const auto& line) {
        return column < line.size() && line[column].text.find("gps") != std::string_view::npos;
    });
}

/// The column of that name, counted from 0.
std::optional<std::size_t> find_column(const Head& head, std::string_view name) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < head.names.size(); ++i) {
        if (!has_name(head.names[i], name)) continue;
        if (is_of_receiver(head, i)) return i;
        if (!found) found = i;
    }
    return found;
}

/// The first of the preset's columns of a meaning that the header has.
std::optional<std::size_t> find_meaning(const Preset& preset, const Head& head, Column meaning) {
    for (const PresetColumn& column : preset.columns)
        if (column.meaning == meaning)
            if (const auto found = find_column(head, column.name)) return found;
    return std::nullopt;
}

constexpr std::array needed{Column::time, Column::latitude, Column::longitude};

Head find_preset_head(const Preset& preset, const RecordingBytes& recording) {
    const auto is_header = [&](std::span<const Cell> cells, bool) {
        return std::all_of(needed.begin(), needed.end(), [&](Column meaning) {
            return std::any_of(
                preset.columns.begin(), preset.columns.end(), [&](const PresetColumn& column) {
                    return column.meaning == meaning &&
                           std::any_of(cells.begin(), cells.end(), [&](const Cell& cell) {
                               return has_name(cell, column.name);
                           });
                });
        });
    };
    auto head = find_head(recording, std::nullopt, is_header);
    if (!head)
        throw Failure(place_in(recording, 1, 1),
                      fmt::format("the table of {} has no header line with time, latitude and "
                                  "longitude",
                                  preset.program),
                      "Export it again with these, or write columns: in the receiver");
    std::vector<std::size_t> columns;
    for (const Column meaning : needed)
        columns.push_back(*find_meaning(preset, *head, meaning));
    take_lines_under(*head, recording, columns);
    return *head;
}

/// The receiver as an attempt would describe the table.
Receiver described(const Preset& preset, const Receiver& given, const Layout& layout,
                   const RecordingBytes& recording) {
    Receiver receiver = given;
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.columns.clear();
    for (std::size_t i = 0; i < layout.place.size(); ++i)
        if (layout.place[i])
            receiver.columns[std::string(name_of(static_cast<Column>(i)))] =
                fmt::format("{}", *layout.place[i] + 1);
    const std::string_view time = in_first_row(layout.head, *layout[Column::time], recording);
    if (preset.time_format == TimeFormat::time_of_day) {
        receiver.time_format = "time_of_day";
        if (given.time_scale.empty()) receiver.time_scale = "utc";
        return receiver;
    }
    if (preset.time_format == TimeFormat::iso) {
        receiver.time_format = "iso";
        if (time.ends_with('Z'))
            receiver.time_scale = "utc";
        else if (given.time_scale.empty() || given.time_scale == "gps")
            throw Failure(
                place_in(recording, layout.head.first_row, 1),
                fmt::format("the time \"{}\" does not say whether it is local",
                            escape_for_message(time)),
                "Write time_scale: local and utc_offset_h in the receiver, or time_scale: utc");
        return receiver;
    }
    const bool is_unix = parse_double(time).value_or(0.0) >= least_unix_s;
    receiver.time_format = is_unix ? "unix" : "seconds";
    receiver.time_scale = is_unix ? "utc" : "gps";
    return receiver;
}

/// Recorded speeds over those of the positions, both summed; nothing where there are none.
std::optional<double> speed_ratio(const std::vector<PlacedRow>& rows) {
    double recorded = 0.0, derived = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const Observation &a = rows[i - 1].row.observation, &b = rows[i].row.observation;
        const double step_s = static_cast<double>(rows[i].row.instant.nanoseconds() -
                                                  rows[i - 1].row.instant.nanoseconds()) *
                              1e-9;
        const auto speed = horizontal_speed(b);
        if (!speed || step_s <= 0.0 || step_s > 1.5) continue;
        const auto point = [](const Observation& row) {
            return ecef_from_geodetic({.latitude = Angle::from_degrees(*row.latitude_deg),
                                       .longitude = Angle::from_degrees(*row.longitude_deg),
                                       .height_m = 0.0})
                .m;
        };
        recorded += *speed * step_s;
        derived += (point(b) - point(a)).norm();
    }
    if (derived <= 0.0 || recorded <= 0.0) return std::nullopt;
    return recorded / derived;
}

void drop_speeds(std::vector<PlacedRow>& rows, Layout& layout) {
    const auto ratio = speed_ratio(rows);
    const auto unit = ratio ? speed_unit_of_ratio(*ratio) : std::nullopt;
    for (PlacedRow& row : rows)
        static_cast<RecordedVelocity&>(row.row.observation) = RecordedVelocity{};
    layout.notes.push_back(
        unit ? fmt::format("The unit of the recorded speeds is not stated, and they are not used: "
                           "write speed_unit: {} in the receiver, which fits the positions.",
                           unit->name)
             : "The unit of the recorded speeds is not stated, and they are not used: write "
               "speed_unit in the receiver.");
}

/// What was left out of the rows.
struct LeftOut {
    std::size_t twice = 0, repeated = 0, elsewhere = 0, interpolated = 0;
};

void note_left_out(Layout& layout, const LeftOut& left_out, std::size_t rows) {
    const std::size_t all =
        rows + left_out.twice + left_out.repeated + left_out.elsewhere + left_out.interpolated;
    const std::pair<std::size_t, std::string_view> kinds[] = {
        {left_out.twice, "stand there twice, word for word: the second is not used."},
        {left_out.elsewhere,
         "have no position, but other sensors' values: they are no epochs, and are not used."},
        {left_out.repeated,
         "repeat the last position, by the table's own column: they were not measured, and are not "
         "used."},
        {left_out.interpolated,
         "are interpolated between fixes: they were not measured, and are not used."}};
    for (const auto& [count, what] : kinds)
        if (count > 0) layout.notes.push_back(fmt::format("{} of {} rows {}", count, all, what));
}

using TakeFix = std::function<void(const TimedRow& row, const RecordPlace& place)>;

/// Gives the rows that hold a fix; those that cannot be read are counted in `timed`.
void read_fixes(const Layout& layout, const Description& description, const Receiver& receiver,
                const RecordingBytes& recording, RowCollector& timed, LeftOut& left_out,
                const TakeFix& take) {
    std::string_view before;
    for_each_row(layout, recording, timed,
                 [&](const SourceLine& line, std::span<const Cell> cells) {
                     if (line.text == std::exchange(before, line.text)) {
                         ++left_out.twice;
                         return timed.count_good();
                     }
                     if (!is_new_fix(cells, layout)) {
                         ++left_out.repeated;
                         return timed.count_good();
                     }
                     const TimedRow row = read_row(cells, layout, description, receiver);
                     timed.count_good();
                     if (row.observation.latitude_deg)
                         take(row, RecordPlace(line));
                     else
                         ++left_out.elsewhere;
                 });
}

std::size_t count_lines(const RecordingBytes& recording) {
    return 1 + static_cast<std::size_t>(
                   std::count(recording.bytes.begin(), recording.bytes.end(), '\n'));
}

Layout preset_layout(const Preset& preset, const RecordingBytes& recording) {
    Layout layout;
    layout.head = find_preset_head(preset, recording);
    layout.fields = layout.head.names.size();
    for (std::size_t i = 0; i < layout.place.size(); ++i)
        layout.place[i] = find_meaning(preset, layout.head, static_cast<Column>(i));
    if (!layout[Column::speed]) layout[Column::course].reset();
    return layout;
}

}  // namespace

bool recognises(const Preset& preset, std::string_view bytes) {
    LineReader lines(bytes);
    for (auto line = lines.next(); line && line->number <= preset_lines_looked_at;
         line = lines.next())
        for (const std::string_view beginning : preset.beginnings)
            if (line->text.starts_with(beginning)) return true;
    return false;
}

Observations read(const Preset& preset, const Receiver& given, const RecordingBytes& as_written) {
    std::string text;
    if (preset.filled_with_nul) {
        text = as_written.bytes;
        std::ranges::replace(text, '\0', ' ');
    }
    const RecordingBytes recording = preset.filled_with_nul
                                         ? RecordingBytes{.name = as_written.name, .bytes = text}
                                         : as_written;
    require_text(recording);
    Layout layout = preset_layout(preset, recording);
    const Receiver receiver = described(preset, given, layout, recording);
    Description description = describe(receiver);
    description.between_fixes = preset.interpolates;
    description.date_order = preset.date_order;
    if (!description.speed_unit) description.speed_unit = find_unit(preset.speed_unit);
    set_units(layout, description, receiver);
    settle_times(layout, description, receiver, recording);
    note_head(layout);
    find_beside(layout, description, recording);
    const bool unit_is_unknown =
        layout[Column::speed] && !description.speed_unit &&
        !unit_of_column(layout.head, *layout[Column::speed], Quantity::speed);
    RowCollector timed(recording);
    LeftOut left_out;
    if (preset.interpolates || unit_is_unknown) {
        std::vector<PlacedRow> rows;
        rows.reserve(count_lines(recording));
        read_fixes(layout, description, receiver, recording, timed, left_out,
                   [&](const TimedRow& row, const RecordPlace& place) {
                       rows.push_back({row, place});
                   });
        if (preset.interpolates) left_out.interpolated = remove_interpolated(rows);
        if (unit_is_unknown) drop_speeds(rows, layout);
        for (const PlacedRow& row : rows)
            timed.add(row.row, row.place);
    } else {
        read_fixes(layout, description, receiver, recording, timed, left_out,
                   [&](const TimedRow& row, const RecordPlace& place) { timed.add(row, place); });
    }
    note_left_out(layout, left_out, timed.size());
    if (!preset.note.empty()) layout.notes.emplace_back(preset.note);
    return observations_of_table(receiver, description, layout, std::move(timed), recording,
                                 preset.format.name);
}

}  // namespace runcert::csv
