#pragma once

#include <vector>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// Rows in the order of the recording, and the instant of each: on a relative time scale, counted
/// from the recording's time zero as if that were the GPS epoch.
struct TimedRows {
    std::vector<Observation> rows;
    std::vector<GpsTime> instants;
};

/// Numbers the rows, gives each its time since the first, and fills what follows from that:
/// first epoch (unless `time_scale` is "relative"), nominal interval. Failure where there are no
/// rows or one is more than 292 years from the first.
void set_times(Observations& observations, TimedRows timed, const RecordingBytes& recording);

/// Says where the accuracy comes from, and where the recording states none, takes the attempt's.
void set_accuracy(Observations& observations, const Receiver& receiver);

/// Notes on a recording's text as such: byte order mark, last line without an end.
void note_text(Observations& observations, const RecordingBytes& recording);

}  // namespace runcert
