#include "stages/import/row_collector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/angle.h"
#include "core/satellite.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/earth.h"

namespace runcert {
namespace {

/// Each time there are so many more bad records, reading may stop.
constexpr std::int64_t bad_to_give_up = 50'000;

/// The column that a Failure at "file:line:column" names.
OptionalInteger column_of(const Failure& why, const RecordPlace& place) {
    const std::size_t colon = why.where().rfind(':');
    if (!place.line || colon == std::string::npos) return std::nullopt;
    if (!why.where().substr(0, colon).ends_with(fmt::format(":{}", *place.line)))
        return std::nullopt;
    return parse_integer(std::string_view(why.where()).substr(colon + 1));
}

/// After so many rows the room for all of them is estimated, so that growing never copies them.
constexpr std::size_t rows_to_estimate = 1024;

void note_leap_seconds(Observations& observations, GpsTime last) {
    if (observations.time_scale == "utc" && !utc_from_gps(last).leap_seconds_known)
        observations.notes.push_back(
            "The recording is in UTC, and for its date the leap seconds are not known to this "
            "program: its GPS time may be off by a whole second or more.");
}

/// The recorded speed that no craft has, upwards or over ground; empty if there is none.
std::optional<double> impossible_speed(const RecordedVelocity& row) {
    for (const double speed_m_s : {horizontal_speed(row).value_or(0.0),
                                   std::abs(row.recorded_velocity_up_m_s.value_or(0.0))})
        if (!(speed_m_s >= 0.0 && speed_m_s < speed_of_light_m_s)) return speed_m_s;
    return std::nullopt;
}

/// A grid that positions went through counts as the step that they are written in.
void set_single_precision(Observations& observations, const std::vector<Observation>& rows) {
    auto& written_m = observations.facts.position_resolution_m;
    if (!written_m) return;
    const auto [latitude_deg, longitude_deg] = single_precision_steps_deg(rows, *written_m);
    if (latitude_deg == 0.0 && longitude_deg == 0.0) return;
    constexpr double metres_per_degree = 6'371e3 * radians_per_degree;
    const double north_m = latitude_deg * metres_per_degree;
    const double east_m = longitude_deg * metres_per_degree *
                          std::cos(rows.front().latitude_deg.value_or(0.0) * radians_per_degree);
    written_m = std::max({*written_m, north_m, east_m});
    observations.notes.push_back(
        fmt::format("Positions went through single precision: they lie on a grid of {} m towards "
                    "north and {} m "
                    "towards east, which counts as the step that they are written in.",
                    format_fixed(north_m, 2), format_fixed(east_m, 2)));
}

bool has_horizontal_accuracy(const Observation& row) {
    return row.sigma_east_m && row.sigma_north_m;
}

}  // namespace

bool has_position(const Observation& row) {
    return row.latitude_deg || row.plane_east_m;
}

bool has_velocity(const RecordedVelocity& row) {
    return row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s;
}

std::optional<double> horizontal_speed(const RecordedVelocity& row) {
    if (!has_velocity(row)) return row.recorded_speed_m_s;
    return std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s);
}

bool has_velocity_accuracy(const RecordedVelocity& row) {
    if (!has_velocity(row)) return row.recorded_speed_m_s && row.sigma_recorded_speed_m_s;
    return row.sigma_recorded_velocity_east_m_s && row.sigma_recorded_velocity_north_m_s;
}

void StepCount::add(std::int64_t step_ns) {
    ++count_[step_ns];
    ++steps_;
}

double StepCount::median_s() const {
    const auto step_s = [&](std::size_t rank) {
        auto entry = count_.begin();
        for (; rank >= entry->second; ++entry)
            rank -= entry->second;
        return static_cast<double>(entry->first) / GpsTime::nanoseconds_per_second;
    };
    return steps_ == 0 ? 0.0 : 0.5 * step_s((steps_ - 1) / 2) + 0.5 * step_s(steps_ / 2);
}

void RowSummary::add_time(const Observation& row) {
    const GpsTime instant = GpsTime::from_nanoseconds(row.time.nanoseconds);
    if (rows == 0) first = last = before_ = instant;
    std::int64_t since_first = 0, step = 0;
    const bool another_age =
        __builtin_sub_overflow(instant.nanoseconds(), first.nanoseconds(), &since_first) ||
        __builtin_sub_overflow(instant.nanoseconds(), before_.nanoseconds(), &step);
    if (another_age && !line_of_another_age) line_of_another_age = row.source_line.value_or(1);
    if (!another_age && step > 0) steps.add(step);
    last = std::max(last, instant);
    before_ = instant;
}

void RowSummary::add(const Observation& row) {
    add_time(row);
    ++rows;
    if (!first_latitude_deg && row.latitude_deg) first_latitude_deg = *row.latitude_deg;
    any_height = any_height || row.height_m;
    const bool horizontal = has_horizontal_accuracy(row);
    any_horizontal = any_horizontal || horizontal;
    any_vertical = any_vertical || row.sigma_up_m;
    without_horizontal += has_position(row) && !horizontal ? 1 : 0;
    if (!has_velocity(row) && !row.recorded_speed_m_s) return;
    ++with_velocity;
    speeds_alone += has_velocity(row) ? 0 : 1;
    standing += has_velocity(row) && *horizontal_speed(row) == 0.0 ? 1 : 0;
    velocity_unstated += has_velocity_accuracy(row) ? 0 : 1;
}

void RecordLog::require_mostly_good() const {
    if (2 * records_.bad <= records_.total) return;
    if (records_.total == 1) throw Failure(*first_bad_);
    throw Failure(first_bad_->where(),
                  fmt::format("{} ({} of {} records cannot be read; this is the first)",
                              first_bad_->problem(), records_.bad, records_.total),
                  first_bad_->remedy());
}

void RecordLog::count_bad(const RecordPlace& place, const Failure& why, std::int64_t epoch) {
    ++records_.total;
    ++records_.bad;
    if (!first_bad_) first_bad_ = why;
    // What is nothing but bad records is not read to its end.
    if (records_.bad % bad_to_give_up == 0 && 10 * records_.bad > 9 * records_.total)
        require_mostly_good();
    if (records_.bad_records.size() >= bad_records_listed_at_most) return;
    records_.bad_records.push_back({.line = place.line,
                                    .column = column_of(why, place),
                                    .byte = place.byte,
                                    .epoch = epoch,
                                    .what = why.problem() + ". " + why.remedy()});
}

RecordCount RecordLog::finish(std::vector<std::string>& notes) && {
    require_mostly_good();
    if (records_.bad > 0) {
        const BadRecord& first = records_.bad_records.front();
        notes.push_back(fmt::format(
            "{} of {} records cannot be read; the first, {}{}: {}.", records_.bad, records_.total,
            first.line ? fmt::format("line {}", *first.line) : fmt::format("byte {}", first.byte),
            first.column ? fmt::format(", column {}", *first.column) : "", first.what));
    }
    return std::move(records_);
}

std::string instrument_part(std::string_view text) {
    constexpr std::size_t longest = 80;
    return escape_for_message(trim(text), longest);
}

void set_instrument(Observations& observations, const Instrument& instrument) {
    if (!instrument.empty()) observations.instrument = instrument;
}

Observations empty_observations(std::string_view format, std::string_view frame,
                                std::string_view time_scale) {
    Observations observations;
    observations.format = format;
    observations.frame = frame;
    observations.time_scale = time_scale;
    return observations;
}

void RowCollector::add(const TimedRow& row, const RecordPlace& place) {
    if (place.line && *place.line > std::numeric_limits<std::int32_t>::max())
        throw Failure(place_in(recording_, place), "the recording has too many lines to count",
                      "Hand it in as several files, as the logger can split it, and list them in "
                      "the attempt");
    if (const auto speed = impossible_speed(row.observation); speed && !impossible_)
        impossible_.emplace(
            place_in(recording_, place),
            fmt::format("the recorded speed is {:.9g} m/s, which no craft has", *speed),
            "Hand in the recording as the device wrote it, and look at the unit of "
            "its speeds; where the device measured none, leave the speed empty");
    if (rows_.size() == rows_to_estimate && place.byte > 0) {
        const double bytes_each = static_cast<double>(place.byte) / rows_to_estimate;
        rows_.reserve(static_cast<std::size_t>(1.02 * static_cast<double>(recording_.bytes.size()) /
                                               bytes_each));
    }
    Observation added = row.observation;
    added.epoch = summary_.rows + 1;
    added.time.nanoseconds = row.instant.nanoseconds();
    if (place.line) added.source_line = static_cast<std::int32_t>(*place.line);
    added.source_byte = place.byte;
    summary_.add(added);
    written_.see(row.written);
    if (take_)
        take_(added);
    else
        rows_.push_back(added);
}

void RowCollector::count_bad(const RecordPlace& place, const Failure& why, bool in_next_epoch) {
    log_.count_bad(place, why, summary_.rows + (in_next_epoch ? 1 : 0));
}

void set_rows(Observations& observations, RowCollector timed) {
    const RecordingBytes& recording = timed.recording_;
    timed.log_.require_mostly_good();
    if (timed.impossible_) throw Failure(*timed.impossible_);
    const RowSummary& rows = timed.summary_;
    if (rows.rows == 0)
        throw Failure(place_in(recording, 1, 1), "the recording has no epochs",
                      "It holds a header at most; hand in the whole recording");
    if (rows.line_of_another_age)
        throw Failure(
            place_in(recording, *rows.line_of_another_age, 1),
            "the time is more than 292 years from another in the recording",
            "Hand in the recording as the logger wrote it, or each session in a file of its own");
    const bool reversed = put_in_order(timed.rows_, timed.log_.bad_records());
    const GpsTime first =
        reversed ? GpsTime::from_nanoseconds(timed.rows_.front().time.nanoseconds) : rows.first;
    observations.facts.nominal_interval_s =
        reversed ? median_step_s(timed.rows_) : rows.steps.median_s();
    for (Observation& row : timed.rows_)
        row.time.nanoseconds -= first.nanoseconds();
    if (observations.time_scale != "relative") observations.facts.first_epoch = first;
    if (reversed)
        observations.notes.emplace_back(
            "The recording stands newest first, and was put in the order of time.");
    note_leap_seconds(observations, rows.last);
    observations.facts.time_resolution_s = timed.written_.time_s();
    observations.facts.position_resolution_m = timed.written_.position_m(
        Angle::from_degrees(rows.first_latitude_deg.value_or(0.0)));  // the equator's without any
    set_single_precision(observations, timed.rows_);
    observations.records = std::move(timed.log_).finish(observations.notes);
    observations.rows = std::move(timed.rows_);
}

double median_step_s(const std::vector<Observation>& rows) {
    StepCount steps;
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (rows[i].time > rows[i - 1].time)
            steps.add(
                GpsTime::from_nanoseconds(rows[i].time.nanoseconds)
                    .nanoseconds_since(GpsTime::from_nanoseconds(rows[i - 1].time.nanoseconds)));
    return steps.median_s();
}

void note_text(Observations& observations, const RecordingBytes& recording) {
    if (LineReader(recording.bytes).has_byte_order_mark())
        observations.notes.push_back("The file begins with a byte order mark, which was skipped.");
    if (!recording.bytes.ends_with('\n'))
        observations.notes.push_back(
            "The last line has no line end: the file may have been cut off within it.");
}

}  // namespace runcert
