#include "stages/import/row_collector.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/earth.h"
#include "stages/import/unfilled.h"

namespace runcert {
namespace {

/// After so many rows the room for all of them is estimated, so that growing never copies them.
constexpr std::size_t rows_to_estimate = 1024;

void note_leap_seconds(Observations& observations, GpsTime last) {
    if (observations.time_scale == "utc" && !utc_from_gps(last).leap_seconds_known)
        observations.notes.push_back(
            "The recording is in UTC, and for its date the leap seconds are not known to this "
            "program: its GPS time may be off by a whole second or more.");
}

/// The height at which to put the positions of a recording that has none.
std::optional<double> set_heights(Observations& observations, const RowSummary& rows,
                                  const Receiver& receiver) {
    if (!rows.first_latitude_deg || rows.any_height) return std::nullopt;
    observations.facts.vertical_measured = false;
    if (!receiver.height_m)
        observations.notes.push_back(
            "Heights are not recorded: write height_m in the receiver, the course's height above "
            "the ellipsoid in metres; without it no position can be used.");
    else
        observations.notes.push_back(
            fmt::format("Heights are not recorded; every position is put at the attempt's {} m.",
                        *receiver.height_m));
    return receiver.height_m;
}

/// Says where the accuracy comes from, and where the recording states none, takes the attempt's.
void set_accuracy(Observations& observations, const RowSummary& rows, const Receiver& receiver,
                  RowChanges& changes) {
    observations.accuracy_source = rows.any_horizontal ? "recording" : "none";
    const auto& stated = receiver.accuracy;
    if (!rows.any_horizontal && stated && stated->horizontal_m) {
        observations.accuracy_source = "attempt";
        observations.notes.push_back(fmt::format(
            "The recording states no accuracy; the attempt's is used: {} m for each horizontal "
            "coordinate.",
            *stated->horizontal_m));
        changes.sigma_horizontal_m = stated->horizontal_m;
    }
    if (!rows.any_vertical && observations.facts.vertical_measured && stated &&
        stated->vertical_m) {
        observations.notes.push_back(
            fmt::format("The recording states no accuracy of height; the attempt's is used: {} m.",
                        *stated->vertical_m));
        changes.sigma_up_m = stated->vertical_m;
    }
    if (rows.any_horizontal && rows.without_horizontal > 0)
        observations.notes.push_back(
            fmt::format("{} of {} epochs state no usable horizontal accuracy.",
                        rows.without_horizontal, rows.rows));
    if (rows.any_horizontal && stated && stated->horizontal_m)
        observations.notes.push_back(
            "The recording states its own accuracy, which is used; the attempt's is not, where the "
            "recording has one.");
}

void note_speeds_alone(Observations& observations, const RowSummary& rows) {
    if (rows.speeds_alone > 0)
        observations.notes.push_back(
            fmt::format("{} of {} recorded velocities come without a course, and are used as "
                        "speeds.",
                        rows.speeds_alone, rows.with_velocity));
}

/// Says how accurate the recorded velocities are by the attempt's word.
void set_velocity_accuracy(Observations& observations, const RowSummary& rows,
                           const Receiver& receiver, RowChanges& changes) {
    if (!receiver.accuracy || !receiver.accuracy->velocity_m_s) return;
    if (rows.with_velocity == 0)
        observations.notes.push_back(
            "The attempt's accuracy of velocities is not used: no velocities are recorded.");
    else if (rows.velocity_unstated == 0)
        observations.notes.push_back(
            "The recording states how accurate its velocities are, which is used; the attempt's "
            "accuracy of velocities is not.");
    else
        observations.notes.push_back(fmt::format(
            "{} of {} recorded velocities state no accuracy; the attempt's is used: {} m/s.",
            rows.velocity_unstated, rows.with_velocity, *receiver.accuracy->velocity_m_s));
    changes.sigma_velocity_m_s = receiver.accuracy->velocity_m_s;
}

}  // namespace

void RowChanges::apply(Observation& row) const {
    if (height_m && row.latitude_deg) row.height_m = *height_m;
    if (sigma_velocity_m_s) set_component_accuracy(row, *sigma_velocity_m_s);
    if (!has_position(row)) return;
    if (sigma_horizontal_m) {
        row.sigma_east_m = row.sigma_north_m = *sigma_horizontal_m;
        // Of which no correlation is known.
        row.correlation_east_north.reset();
        row.correlation_east_up.reset();
        row.correlation_north_up.reset();
    }
    if (sigma_up_m) row.sigma_up_m = *sigma_up_m;
}

void RowCollector::add(const TimedRow& row, const RecordPlace& place) {
    if (place.line && *place.line > std::numeric_limits<std::int32_t>::max())
        throw Failure(place_in(recording_, place), "the recording has too many lines to count",
                      "Hand it in as several files, as the logger can split it, and list them in "
                      "the attempt");
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
    const RowSummary& rows = timed.summary_;
    if (rows.rows == 0)
        throw Failure(place_in(recording, 1, 1), "the recording has no epochs",
                      "It holds a header at most; hand in the whole recording");
    if (rows.line_of_another_age)
        throw Failure(
            place_in(recording, *rows.line_of_another_age, 1),
            "the time is more than 292 years from another in the recording",
            "Hand in the recording as the logger wrote it, or each session in a file of its own");
    observations.facts.nominal_interval_s = rows.steps.median_s();
    for (Observation& row : timed.rows_)
        row.time.nanoseconds -= rows.first.nanoseconds();
    if (observations.time_scale != "relative") observations.facts.first_epoch = rows.first;
    note_leap_seconds(observations, rows.last);
    observations.facts.time_resolution_s = timed.written_.time_s();
    observations.facts.position_resolution_m = timed.written_.position_m(
        Angle::from_degrees(rows.first_latitude_deg.value_or(0.0)));  // the equator's without any
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

RowChanges apply_attempt(Observations& head, const RowSummary& rows, const Receiver& receiver,
                         bool start_is_used) {
    head.facts.receiver = receiver.id;
    RowChanges changes;
    changes.height_m = set_heights(head, rows, receiver);
    if (receiver.start_gps && !start_is_used)
        head.notes.push_back(
            "The attempt's start_gps is not used: the recording has times of its own.");
    set_accuracy(head, rows, receiver, changes);
    note_speeds_alone(head, rows);
    set_velocity_accuracy(head, rows, receiver, changes);
    return changes;
}

void apply_attempt(Observations& observations, const Receiver& receiver, bool start_is_used) {
    drop_unfilled_velocities(observations);
    RowSummary summary;
    for (const Observation& row : observations.rows)
        summary.add(row);
    const RowChanges changes = apply_attempt(observations, summary, receiver, start_is_used);
    for (Observation& row : observations.rows)
        changes.apply(row);
}

void note_text(Observations& observations, const RecordingBytes& recording) {
    if (LineReader(recording.bytes).has_byte_order_mark())
        observations.notes.push_back("The file begins with a byte order mark, which was skipped.");
    if (!recording.bytes.ends_with('\n'))
        observations.notes.push_back(
            "The last line has no line end: the file may have been cut off within it.");
}

}  // namespace runcert
