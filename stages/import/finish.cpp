#include "stages/import/finish.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/statistics.h"
#include "stages/import/cell.h"

namespace runcert {
namespace {

/// Median of the positive steps (s); 0 where there is none.
double median_step_s(const std::vector<GpsTime>& instants) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < instants.size(); ++i)
        if (instants[i] > instants[i - 1])
            steps.push_back(instants[i].seconds_since(instants[i - 1]));
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// Latitude of the first position on the Earth; the equator's where there is none.
Angle first_latitude(const std::vector<Observation>& rows) {
    const auto first = std::find_if(rows.begin(), rows.end(), [](const Observation& row) {
        return row.latitude_deg.has_value();
    });
    return Angle::from_degrees(first == rows.end() ? 0.0 : *first->latitude_deg);
}

bool has_horizontal(const Observation& row) {
    return row.sigma_east_m && row.sigma_north_m;
}
bool has_vertical(const Observation& row) {
    return row.sigma_up_m.has_value();
}
bool has_position(const Observation& row) {
    return row.latitude_deg || row.plane_east_m;
}

/// Gives a row with a position the attempt's horizontal accuracy, of which no correlation is known.
void use_horizontal(Observation& row, double sigma_m) {
    if (!has_position(row)) return;
    row.sigma_east_m = row.sigma_north_m = sigma_m;
    row.correlation_east_north.reset();
    row.correlation_east_up.reset();
    row.correlation_north_up.reset();
}

void note_leap_seconds(Observations& observations, GpsTime last) {
    if (observations.time_scale == "utc" && !utc_from_gps(last).leap_seconds_known)
        observations.notes.push_back(
            "The recording is in UTC, and for its date the leap seconds are not known to this "
            "program: its GPS time may be off by a whole second or more.");
}

void note_missing_accuracy(Observations& observations) {
    const auto missing = std::count_if(
        observations.rows.begin(), observations.rows.end(),
        [](const Observation& row) { return has_position(row) && !has_horizontal(row); });
    if (missing > 0)
        observations.notes.push_back(
            fmt::format("{} of {} epochs state no usable horizontal accuracy.", missing,
                        observations.rows.size()));
}

}  // namespace

void TimedRows::add(const TimedRow& row, const SourceLine& line) {
    rows.push_back(row.observation);
    rows.back().source_line = line.number;
    rows.back().source_byte = line.byte;
    instants.push_back(row.instant);
    written.see(row.written);
}

void set_rows(Observations& observations, TimedRows timed, const RecordingBytes& recording) {
    if (timed.rows.empty())
        throw Failure(place_in(recording, 1, 1), "the recording has no epochs",
                      "It holds a header at most; take the whole recording");
    const GpsTime first = timed.instants.front();
    for (std::size_t i = 0; i < timed.rows.size(); ++i) {
        Observation& row = timed.rows[i];
        row.epoch = static_cast<std::int64_t>(i) + 1;
        try {
            row.time.nanoseconds = timed.instants[i].nanoseconds_since(first);
            // The step from the row before must be a number too.
            if (i > 0) (void)timed.instants[i].nanoseconds_since(timed.instants[i - 1]);
        } catch (const Failure&) {
            throw Failure(place_in(recording, row.source_line.value_or(1), 1),
                          "the time is more than 292 years from another in the recording",
                          "Correct or take out the line");
        }
    }
    if (observations.time_scale != "relative") observations.facts.first_epoch = first;
    observations.facts.nominal_interval_s = median_step_s(timed.instants);
    note_leap_seconds(observations,
                      *std::max_element(timed.instants.begin(), timed.instants.end()));
    observations.facts.time_resolution_s = timed.written.time_s();
    observations.facts.position_resolution_m = timed.written.position_m(first_latitude(timed.rows));
    observations.rows = std::move(timed.rows);
}

void set_accuracy(Observations& observations, const Receiver& receiver) {
    std::vector<Observation>& rows = observations.rows;
    const bool horizontal = std::any_of(rows.begin(), rows.end(), has_horizontal);
    const bool vertical = std::any_of(rows.begin(), rows.end(), has_vertical);
    observations.accuracy_source = horizontal ? "recording" : "none";
    if (!horizontal && receiver.accuracy) {
        observations.accuracy_source = "attempt";
        observations.notes.push_back(fmt::format(
            "The recording states no accuracy; the attempt's is used: {} m for each horizontal "
            "coordinate.",
            receiver.accuracy->horizontal_m));
        for (Observation& row : rows)
            use_horizontal(row, receiver.accuracy->horizontal_m);
    }
    if (!vertical && observations.facts.vertical_measured && receiver.accuracy &&
        receiver.accuracy->vertical_m) {
        observations.notes.push_back(
            fmt::format("The recording states no accuracy of height; the attempt's is used: {} m.",
                        *receiver.accuracy->vertical_m));
        for (Observation& row : rows)
            if (has_position(row)) row.sigma_up_m = receiver.accuracy->vertical_m;
    }
    if (horizontal) note_missing_accuracy(observations);
    if (horizontal && receiver.accuracy)
        observations.notes.push_back(
            "The recording states its own accuracy, which is used; the attempt's is not, where the "
            "recording has one.");
}

void note_text(Observations& observations, const RecordingBytes& recording) {
    if (LineReader(recording.bytes).has_byte_order_mark())
        observations.notes.push_back("The file begins with a byte order mark, which was skipped.");
    if (!recording.bytes.ends_with('\n'))
        observations.notes.push_back(
            "The last line has no line end: the file may have been cut off within it.");
}

}  // namespace runcert
