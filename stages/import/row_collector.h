#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/record_log.h"
#include "stages/import/recording.h"
#include "stages/import/resolution.h"
#include "stages/import/row_summary.h"

namespace runcert {

/// A row in the terms of an observation.
struct TimedRow {
    Observation observation;  ///< without time, number and source
    /// On a relative time scale, counted from the recording's time zero as if that were the GPS
    /// epoch.
    GpsTime instant;
    WrittenCells written;
};

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
};

/// Gives each row its time since the first, and fills what follows from that: first epoch (unless
/// `time_scale` is "relative"), nominal interval, resolution, and the records.
///
/// Failure where more than half of the records could not be read (the first one's, with their
/// number), where there are no rows, and where one is more than 292 years from the first.
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
/// device did not fill in are taken out (`drop_unfilled_velocities`). Notes say what was
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
