#pragma once

#include <vector>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"
#include "stages/import/resolution.h"

namespace runcert {

/// A row in the terms of an observation.
struct TimedRow {
    Observation observation;  ///< without time, number and source
    /// On a relative time scale, counted from the recording's time zero as if that were the GPS
    /// epoch.
    GpsTime instant;
    WrittenCells written;
};

/// Rows in the order of the recording, the instant of each, and how finely they are written.
struct TimedRows {
    std::vector<Observation> rows;
    std::vector<GpsTime> instants;
    WrittenResolution written;

    /// Takes in the row that a line holds.
    void add(const TimedRow& row, const SourceLine& line);
};

/// Numbers the rows, gives each its time since the first, and fills what follows from that:
/// first epoch (unless `time_scale` is "relative"), nominal interval, resolution. Failure where
/// there are no rows or one is more than 292 years from the first.
void set_rows(Observations& observations, TimedRows timed, const RecordingBytes& recording);

/// Says where the accuracy comes from, and where the recording states none, takes the attempt's.
void set_accuracy(Observations& observations, const Receiver& receiver);

/// Notes on a recording's text as such: byte order mark, last line without an end.
void note_text(Observations& observations, const RecordingBytes& recording);

}  // namespace runcert
