#include "stages/import/csv/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/gps_time.h"
#include "core/text.h"
#include "stages/import/csv/head.h"
#include "stages/import/format.h"

namespace runcert::csv {
namespace {

std::string time_scale_word(const Receiver& receiver, const Description& description) {
    if (description.time_format == TimeFormat::seconds)
        return receiver.start_gps ? "gps" : "relative";
    return !description.clock.is_gps || description.time_format == TimeFormat::unix ? "utc" : "gps";
}

void note_description(Observations& observations, const Receiver& receiver,
                      const Description& description) {
    if (description.constant_height_m)
        observations.notes.push_back(
            fmt::format("Heights are not recorded; every position is put at the attempt's {} m.",
                        *description.constant_height_m));
    if (receiver.columns.contains("quality_2d"))
        observations.notes.push_back(
            "The recorded horizontal accuracy is a two-dimensional coordinate quality; each "
            "coordinate is given 1/sqrt(2) of it.");
    if (receiver.time_scale == "local")
        observations.notes.push_back(fmt::format(
            "Times are recorded in local time; the attempt's {} h were taken off for UTC.",
            *receiver.utc_offset_h));
    if (description.frame == CoordinateFrame::utm && receiver.columns.contains("sigma_east"))
        observations.notes.push_back(
            "The recorded accuracies are along the UTM grid, and were turned to true east and "
            "north.");
    if (!description.start_date.empty())
        observations.notes.push_back(fmt::format(
            "The table has times of day and no date; the attempt's start_date is used: {}.",
            description.start_date));
    if (receiver.height_m && !description.constant_height_m)
        observations.notes.push_back("The attempt's height_m is not used.");
}

/// Names the columns that hold speeds by their names, where the attempt uses none.
void note_unused_speeds(Observations& observations, const Layout& layout) {
    if (layout[Column::speed] || layout[Column::velocity_east]) return;
    std::string names;
    for (const Cell& name : layout.head.names)
        if (is_named(name.text, Column::speed))
            names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ",
                                 escape_for_message(name.text, 60));
    if (!names.empty())
        observations.notes.push_back(
            fmt::format("By their names these columns hold speeds, and the attempt names none "
                        "(columns: {{speed: "
                        "...}}): {}.",
                        names));
}

/// Whether two lines that follow one another have as many fields, three at least, and the second
/// one two numbers.
bool begin_table(std::span<const Cell> first, std::span<const Cell> second) {
    return first.size() > 2 && second.size() == first.size() &&
           std::count_if(second.begin(), second.end(),
                         [](const Cell& cell) { return parse_double(cell.text).has_value(); }) >= 2;
}

/// Gives times of day that no column has a date for their days: the first row is on the attempt's
/// UTC date, and a row half a day or more before the one above it is on the next day, as one half a
/// day behind it is on the day before.
class RunningDate {
  public:
    explicit RunningDate(std::string start_date) : start_date_(std::move(start_date)) {}

    void set(GpsTime& instant) {
        if (start_date_.empty()) return;
        if (!before_) {
            // A local clock may show another date than UTC.
            const std::string utc = to_utc_iso(instant, 0).substr(0, start_date_.size());
            days_ = utc < start_date_ ? 1 : utc > start_date_ ? -1 : 0;
        }
        GpsTime dated = on_day(instant);
        if (before_) {
            const double step_s = dated.seconds_since(*before_);
            days_ += step_s < -half_day_s ? 1 : step_s > half_day_s ? -1 : 0;
            dated = on_day(instant);
        }
        before_ = instant = dated;
    }

  private:
    static constexpr double half_day_s = 43'200.0;
    GpsTime on_day(GpsTime instant) const {
        return instant.plus_nanoseconds(days_ * GpsTime::nanoseconds_per_day);
    }

    std::string start_date_;
    std::optional<GpsTime> before_;
    std::int64_t days_ = 0;
};

}  // namespace

bool recognises(std::string_view bytes) {
    const RecordingBytes nameless{.name = {}, .bytes = bytes};
    std::vector<Cell> before;
    return find_head(nameless, std::nullopt,
                     [&](std::span<const Cell> cells, bool comment) {
                         if (comment) return false;
                         if (begin_table(before, cells)) return true;
                         before.assign(cells.begin(), cells.end());
                         return false;
                     })
        .has_value();
}

void for_each_row(const Layout& layout, const RecordingBytes& recording, RowCollector& timed,
                  const TakeCells& take) {
    LineReader lines(recording);
    for (auto line = lines.next(); line; line = lines.next()) {
        if (line->number < layout.head.first_row || is_skipped(*line)) continue;
        try {
            std::vector<Cell> cells = layout.head.row(*line, recording);
            // "," between two rows: a program's empty line.
            if (line->text.size() < cells.size() + 2 &&
                std::ranges::all_of(cells, [](const Cell& cell) { return cell.text.empty(); }))
                continue;
            // Some writers end each row, but not the header, with a delimiter.
            if (cells.size() == layout.fields + 1 && cells.back().text.empty()) cells.pop_back();
            require_count(cells.size(), layout.fields, *line, recording,
                          lines.at_end() && !line->ended, "the first line of the table has",
                          cells.size() > layout.fields && layout.head.delimiter == ','
                              ? "If numbers have a decimal comma (\"1,5\"), export them with points"
                              : "Hand in the table as the logger wrote it, or another export");
            take(*line, cells);
        } catch (const Failure& failure) {
            timed.count_bad(*line, failure);
        }
    }
}

Observations observations_of_table(const Receiver& receiver, const Description& description,
                                   const Layout& layout, RowCollector timed,
                                   const RecordingBytes& recording, std::string_view format) {
    Observations observations;
    observations.facts.georeferenced = description.frame != CoordinateFrame::local_plane;
    observations.facts.vertical_measured =
        description.has_up || description.frame == CoordinateFrame::ecef;
    observations.format = format;
    observations.frame = to_text(description.frame);
    observations.time_scale = time_scale_word(receiver, description);
    set_rows(observations, std::move(timed));
    observations.notes.insert(observations.notes.end(), layout.notes.begin(), layout.notes.end());
    note_description(observations, receiver, description);
    note_unused_speeds(observations, layout);
    fill_heights(observations);
    apply_attempt(observations, receiver, description.time_format == TimeFormat::seconds);
    note_text(observations, recording);
    return observations;
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Description description = describe(receiver);
    require_text(recording);
    Layout layout = read_layout(receiver, description, recording);
    // What ends in Z, or in an offset, says itself that it is UTC.
    if (receiver.time_scale.empty() && layout[Column::time] &&
        (description.time_format == TimeFormat::iso ||
         description.time_format == TimeFormat::time_of_day)) {
        Cell time;
        time.text = in_first_row(layout.head, *layout[Column::time], recording);
        const std::string_view time_of_day = split_date_time(time)[1].text;
        if (zone_of(time_of_day.empty() ? time.text : time_of_day)) description.clock = Clock::utc;
    }
    settle_times(layout, description, receiver, recording);
    RowCollector timed(recording);
    std::size_t repeated = 0, elsewhere = 0;
    bool mock = false;
    RunningDate date(description.start_date);
    for_each_row(layout, recording, timed,
                 [&](const SourceLine& line, std::span<const Cell> cells) {
                     mock = mock || is_mock(cells, layout);
                     if (is_other_sensors(cells, layout)) {
                         ++elsewhere;
                     } else if (is_new_fix(cells, layout)) {
                         TimedRow row = read_row(cells, layout, description, receiver);
                         date.set(row.instant);
                         timed.add(std::move(row), line);
                     } else {
                         ++repeated;
                     }
                     timed.count_good();
                 });
    Observations observations =
        observations_of_table(receiver, description, layout, std::move(timed), recording, "csv");
    if (elsewhere > 0)
        observations.notes.push_back(
            fmt::format("{} of {} rows have no position, but other sensors' values: they are no "
                        "epochs, and are "
                        "not used.",
                        elsewhere, elsewhere + observations.rows.size()));
    if (mock) {
        observations.simulated = true;
        observations.written_by.push_back(
            fmt::format("rows whose \"{}\" is true",
                        escape_for_message(layout.head.names[*layout[Column::mock]].text)));
    }
    if (repeated > 0)
        observations.notes.push_back(fmt::format(
            "Rows that repeat the last position, by the column new_fix: {}. They were not "
            "measured, and are not used.",
            repeated));
    return observations;
}

extern const Format format{
    .name = "csv",
    .what = "tables whose columns the attempt names",
    .place = 120,
    .time_origin = "the table's time column, whose clock the table does not say",
    .read = read,
};

}  // namespace runcert::csv
