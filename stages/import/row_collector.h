#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"
#include "stages/import/resolution.h"

namespace runcert {

/// How often each positive step of time (ns) between rows that follow each other occurs: there are
/// few different ones, and a copy of all would cost much memory.
class StepCount {
  public:
    void add(std::int64_t step_ns);
    /// Their median (s); 0 where there is none.
    double median_s() const;

  private:
    std::map<std::int64_t, std::size_t> count_;
    std::size_t steps_ = 0;
};

/// What the rows of a recording show as a whole, gathered one by one without
/// holding them.
class RowSummary {
  public:
    /// Takes in a row, whose time still counts from the GPS epoch.
    void add(const Observation& row);

    std::int64_t rows = 0;
    GpsTime first;  ///< instant of the first row
    GpsTime last;   ///< the latest instant
    StepCount steps;
    /// The first row more than 292 years from the first or from the one before it, whose difference
    /// does not fit into the nanoseconds of 64 bits: its line, 1 where it has none.
    std::optional<std::int64_t> line_of_another_age;
    std::optional<double> first_latitude_deg;
    bool any_height = false;
    bool any_horizontal = false;          ///< accuracy
    bool any_vertical = false;            ///< accuracy
    std::int64_t without_horizontal = 0;  ///< rows that have a position, and no accuracy of it
    std::int64_t with_velocity = 0;       ///< rows with a recorded velocity or speed
    std::int64_t speeds_alone = 0;        ///< those of them that have no course
    std::int64_t standing = 0;            ///< those of them that are velocities of zero
    std::int64_t velocity_unstated = 0;   ///< those of them that state no accuracy of it

  private:
    void add_time(const Observation& row);

    GpsTime before_;
};

bool has_position(const Observation& row);

/// Whether the horizontal components of the recorded velocity are there.
bool has_velocity(const RecordedVelocity& row);

/// The length of the horizontal recorded velocity, or the recorded speed (m/s).
std::optional<double> horizontal_speed(const RecordedVelocity& row);

/// Whether the accuracy of the recorded velocity, or speed, is stated.
bool has_velocity_accuracy(const RecordedVelocity& row);

/// Counts the records of a recording, and lists those that cannot be read.
class RecordLog {
  public:
    void count_good() { ++records_.total; }

    /// Counts a record that could not be read, of the epoch of that number, and lists it among the
    /// first. Failure, the first one's, where by far most of very many could not be read.
    void count_bad(const RecordPlace& place, const Failure& why, std::int64_t epoch);

    const RecordCount& records() const { return records_; }
    std::vector<BadRecord>& bad_records() { return records_.bad_records; }

    /// Failure where more than half of the records could not be read: the first one's, with their
    /// number.
    void require_mostly_good() const;

    /// The records, at the end; with a note where some could not be read. Failure as of
    /// `require_mostly_good`.
    RecordCount finish(std::vector<std::string>& notes) &&;

  private:
    RecordCount records_;
    std::optional<Failure> first_bad_;
};

/// A row in the terms of an observation.
struct TimedRow {
    Observation observation;  ///< without time, number and source
    /// On a relative time scale, counted from the recording's time zero as if that were the GPS
    /// epoch.
    GpsTime instant;
    WrittenCells written;
};

/// What a recording says of a part of its instrument, as it may be shown: without blanks around it,
/// at most 80 characters.
std::string instrument_part(std::string_view text);

/// Says what recorded, where anything is known of it.
void set_instrument(Observations& observations, const Instrument& instrument);

/// Observations of a format without anything read yet.
Observations empty_observations(std::string_view format, std::string_view frame,
                                std::string_view time_scale);

/// Takes rows one by one.
using TakeRow = std::function<void(Observation& row)>;

/// A recording whose rows are given one by one.
struct StreamedRecording {
    Observations head;  ///< without the rows
    std::int64_t rows = 0;
    /// Gives them in order, as often as it is called. What was given to the reader must still live.
    std::function<void(const TakeRow& take)> give;
};

/// Rows in the order of the recording, how finely they are written, and the records that could not
/// be read.
class RowCollector {
  public:
    /// The recording must outlive this.
    explicit RowCollector(const RecordingBytes& recording) : recording_(recording) {}
    /// Gives each row to `take`, its time counted from the GPS epoch, and holds none.
    RowCollector(const RecordingBytes& recording, TakeRow take)
        : recording_(recording), take_(std::move(take)) {}
    /// Of a binary format, whose resolution is known.
    RowCollector(const RecordingBytes& recording, const WrittenResolution& written)
        : recording_(recording), written_(written) {}

    /// Takes in the row that a record holds, or that begins with it, and numbers it. Does not
    /// count the record.
    void add(const TimedRow& row, const RecordPlace& place);

    /// Counts a record that could be read; most formats have one to a row, some several.
    void count_good() { log_.count_good(); }

    /// Counts a record that could not be read, and lists it. `in_next_epoch`: it is part of the
    /// epoch that will be added next. Failure, the first one's, where by far most of very many
    /// could not be read.
    void count_bad(const RecordPlace& place, const Failure& why, bool in_next_epoch = false);

    /// Runs `read()`, which gives the TimedRow of the record at `place`, adds it and counts the
    /// record; its Failure makes it a bad one.
    template <class Read>
    void add_record(const RecordPlace& place, Read read) {
        try {
            add(read(), place);
        } catch (const Failure& failure) {
            return count_bad(place, failure);
        }
        count_good();
    }

    std::size_t size() const { return static_cast<std::size_t>(summary_.rows); }
    bool empty() const { return summary_.rows == 0; }
    const RecordCount& records() const { return log_.records(); }
    const RowSummary& summary() const { return summary_; }

  private:
    friend void set_rows(Observations& observations, RowCollector timed);

    const RecordingBytes& recording_;
    TakeRow take_;  ///< empty where the rows are held
    /// `time` counts from the GPS epoch until set_rows.
    std::vector<Observation> rows_;
    RowSummary summary_;
    WrittenResolution written_;
    RecordLog log_;
    std::optional<Failure> impossible_;  ///< of the first recorded speed that no craft has
};

/// Puts rows that stand newest first in the order of time. Returns whether they were.
bool put_in_order(std::vector<Observation>& rows, std::vector<BadRecord>& bad);

/// Gives positions without a height, between some that have one, the height between those: where
/// they are at most 2.5 s apart and of nearly one height; with a note.
void fill_heights(Observations& observations);

/// The step (degrees) of latitude and of longitude where all positions went through single
/// precision, which is coarser than they are written; zero of one that did not.
std::array<double, 2> single_precision_steps_deg(const std::vector<Observation>& rows,
                                                 double written_step_m);

/// How time stamps come in bursts, as a computer makes them that reads a buffer: "3 within 0.002 s,
/// then 0.298 s"; empty where they do not.
std::string bursts_in(const std::vector<Observation>& rows);

/// Gives each row its time since the first, and fills what follows from that: first epoch (unless
/// `time_scale` is "relative"), nominal interval, resolution, and the records.
///
/// Failure where more than half of the records could not be read (the first one's, with their
/// number), where there are no rows, where one is more than 292 years from the first, and where a
/// recorded speed is below zero, not finite, or that of light or more.
void set_rows(Observations& observations, RowCollector timed);

/// What the attempt puts into the rows of a recording.
struct RowChanges {
    std::optional<double> height_m;  ///< of every position
    std::optional<double> sigma_horizontal_m, sigma_up_m;
    std::optional<double> sigma_velocity_m_s;  ///< of what is recorded and states none

    void apply(Observation& row) const;
};

/// Median of the positive steps between rows (s); 0 where there is none.
double median_step_s(const std::vector<Observation>& rows);

/// What the attempt says of a recording that has been read: the receiver's id; heights, where the
/// recording has none at all (without height_m they stay empty, and its positions cannot be used
/// until the attempt states it); accuracy, where the recording states none. Velocities that the
/// device did not fill in are taken out. Notes say what was
/// used, and that start_gps was not, unless `start_is_used`.
void apply_attempt(Observations& observations, const Receiver& receiver,
                   bool start_is_used = false);

/// The same for a recording whose rows are not held: what it does to each of them is returned.
RowChanges apply_attempt(Observations& head, const RowSummary& rows, const Receiver& receiver,
                         bool start_is_used = false);

inline constexpr const char* note_heights_above_sea_level =
    "Heights are recorded above mean sea level; they are not ellipsoidal heights.";

/// Notes on a recording's text as such: byte order mark, last line without an end.
void note_text(Observations& observations, const RecordingBytes& recording);

}  // namespace runcert
