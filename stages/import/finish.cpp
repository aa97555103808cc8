#include "stages/import/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"

namespace runcert {
namespace {

/// Each time there are so many more bad records, reading may stop.
constexpr std::int64_t bad_to_give_up = 50'000;
/// After so many rows the room for all of them is estimated, so that growing never copies them.
constexpr std::size_t rows_to_estimate = 1024;

/// Failure where most of a recording could not be read: it is then something else.
void require_mostly_good(const RecordCount& records, const std::optional<Failure>& first_bad) {
    if (2 * records.bad <= records.total) return;
    if (records.total == 1) throw Failure(*first_bad);
    throw Failure(first_bad->where(),
                  fmt::format("{} ({} of {} records cannot be read; this is the first)",
                              first_bad->problem(), records.bad, records.total),
                  first_bad->remedy());
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

/// The column that a Failure at "file:line:column" names.
OptionalInteger column_of(const Failure& why, const RecordPlace& place) {
    const std::size_t colon = why.where().rfind(':');
    if (!place.line || colon == std::string::npos) return std::nullopt;
    if (!why.where().substr(0, colon).ends_with(fmt::format(":{}", *place.line)))
        return std::nullopt;
    return parse_integer(std::string_view(why.where()).substr(colon + 1));
}

void note_bad_records(Observations& observations, const RecordCount& records) {
    if (records.bad == 0) return;
    const BadRecord& first = records.bad_records.front();
    observations.notes.push_back(fmt::format(
        "{} of {} records cannot be read; the first, {}{}: {}.", records.bad, records.total,
        first.line ? fmt::format("line {}", *first.line) : fmt::format("byte {}", first.byte),
        first.column ? fmt::format(", column {}", *first.column) : "", first.what));
}

/// Failure where the differences of the rows' times, still counted from the GPS epoch, do not fit
/// into the nanoseconds of 64 bits.
void require_one_age(const std::vector<Observation>& rows, const RecordingBytes& recording) {
    const auto instant = [](const Observation& row) {
        return GpsTime::from_nanoseconds(row.time.nanoseconds);
    };
    for (std::size_t i = 1; i < rows.size(); ++i) {
        try {
            (void)instant(rows[i]).nanoseconds_since(instant(rows[0]));
            (void)instant(rows[i]).nanoseconds_since(instant(rows[i - 1]));
        } catch (const Failure&) {
            throw Failure(place_in(recording, rows[i].source_line.value_or(1), 1),
                          "the time is more than 292 years from another in the recording",
                          "Correct or take out the line");
        }
    }
}

/// Puts the positions of a recording that has no heights at the attempt's.
void set_heights(Observations& observations, const Receiver& receiver) {
    std::vector<Observation>& rows = observations.rows;
    const auto has = [&](auto what) { return std::any_of(rows.begin(), rows.end(), what); };
    if (!has([](const Observation& row) { return row.latitude_deg.has_value(); }) ||
        has([](const Observation& row) { return row.height_m.has_value(); }))
        return;
    observations.facts.vertical_measured = false;
    if (!receiver.height_m) {
        observations.notes.push_back(
            "Heights are not recorded: write height_m in the receiver, the course's height above "
            "the ellipsoid in metres; without it no position can be used.");
        return;
    }
    observations.notes.push_back(
        fmt::format("Heights are not recorded; every position is put at the attempt's {} m.",
                    *receiver.height_m));
    for (Observation& row : rows)
        if (row.latitude_deg) row.height_m = *receiver.height_m;
}

/// Says where the accuracy comes from, and where the recording states none, takes the attempt's.
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

}  // namespace

void TimedRows::add(const TimedRow& row, const RecordPlace& place) {
    if (place.line && *place.line > std::numeric_limits<std::int32_t>::max())
        throw Failure(place_in(recording_, place), "the recording has too many lines to count",
                      "Cut it into several files, and list them in the attempt");
    if (rows_.size() == rows_to_estimate && place.byte > 0) {
        const double bytes_each = static_cast<double>(place.byte) / rows_to_estimate;
        rows_.reserve(static_cast<std::size_t>(1.02 * static_cast<double>(recording_.bytes.size()) /
                                               bytes_each));
    }
    rows_.push_back(row.observation);
    Observation& added = rows_.back();
    added.epoch = std::ssize(rows_);
    added.time.nanoseconds = row.instant.nanoseconds();
    if (place.line) added.source_line = static_cast<std::int32_t>(*place.line);
    added.source_byte = place.byte;
    written_.see(row.written);
}

void TimedRows::count_bad(const RecordPlace& place, const Failure& why, bool in_next_epoch) {
    ++records_.total;
    ++records_.bad;
    if (!first_bad_) first_bad_ = why;
    // What is nothing but bad records is not read to its end.
    if (records_.bad % bad_to_give_up == 0 && 10 * records_.bad > 9 * records_.total)
        require_mostly_good(records_, first_bad_);
    if (records_.bad_records.size() >= RecordCount::listed_at_most) return;
    records_.bad_records.push_back({.line = place.line,
                                    .column = column_of(why, place),
                                    .byte = place.byte,
                                    .epoch = std::ssize(rows_) + (in_next_epoch ? 1 : 0),
                                    .what = why.problem() + ". " + why.remedy()});
}

void set_rows(Observations& observations, TimedRows timed) {
    const RecordingBytes& recording = timed.recording_;
    require_mostly_good(timed.records_, timed.first_bad_);
    std::vector<Observation>& rows = timed.rows_;
    if (rows.empty())
        throw Failure(place_in(recording, 1, 1), "the recording has no epochs",
                      "It holds a header at most; take the whole recording");
    const GpsTime first = GpsTime::from_nanoseconds(rows.front().time.nanoseconds);
    require_one_age(rows, recording);
    observations.facts.nominal_interval_s = median_step_s(rows);
    GpsTime last = first;
    for (Observation& row : rows) {
        const GpsTime instant = GpsTime::from_nanoseconds(row.time.nanoseconds);
        last = std::max(last, instant);
        row.time.nanoseconds = instant.nanoseconds_since(first);
    }
    if (observations.time_scale != "relative") observations.facts.first_epoch = first;
    note_leap_seconds(observations, last);
    observations.facts.time_resolution_s = timed.written_.time_s();
    observations.facts.position_resolution_m = timed.written_.position_m(first_latitude(rows));
    note_bad_records(observations, timed.records_);
    observations.records = std::move(timed.records_);
    observations.rows = std::move(rows);
}

double median_step_s(const std::vector<Observation>& rows) {
    // By how often each step occurs: there are few, and a copy of all would cost much memory.
    std::map<std::int64_t, std::size_t> count;
    std::size_t steps = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        if (rows[i].time <= rows[i - 1].time) continue;
        ++count[GpsTime::from_nanoseconds(rows[i].time.nanoseconds)
                    .nanoseconds_since(GpsTime::from_nanoseconds(rows[i - 1].time.nanoseconds))];
        ++steps;
    }
    const auto step_s = [&](std::size_t rank) {
        auto entry = count.begin();
        for (; rank >= entry->second; ++entry)
            rank -= entry->second;
        return static_cast<double>(entry->first) / GpsTime::nanoseconds_per_second;
    };
    return steps == 0 ? 0.0 : 0.5 * step_s((steps - 1) / 2) + 0.5 * step_s(steps / 2);
}

void apply_attempt(Observations& observations, const Receiver& receiver, bool start_is_used) {
    observations.facts.receiver = receiver.id;
    set_heights(observations, receiver);
    if (receiver.start_gps && !start_is_used)
        observations.notes.push_back(
            "The attempt's start_gps is not used: the recording has times of its own.");
    set_accuracy(observations, receiver);
}

void note_text(Observations& observations, const RecordingBytes& recording) {
    if (LineReader(recording.bytes).has_byte_order_mark())
        observations.notes.push_back("The file begins with a byte order mark, which was skipped.");
    if (!recording.bytes.ends_with('\n'))
        observations.notes.push_back(
            "The last line has no line end: the file may have been cut off within it.");
}

}  // namespace runcert
