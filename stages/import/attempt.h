#pragma once

#include "run/attempt_files.h"
#include "run/stage_run.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert {

/// Brings everything that an attempt names from outside into the run folder: after this stage
/// nothing else is read. Writes 1-observations, and phases, surface and IMU samples where there are
/// any, of each receiver. Failure with file and place where anything cannot be read.
void import_attempt(StageRun& run, const AttemptSource& source);

/// Reads one recording, through gpsbabel where it is of a format that only gpsbabel knows.
Observations read_recording(const Receiver& receiver, const RecordingBytes& recording);

/// What files say of who wrote them, behind what the recording's format knows of it.
void note_writers(const std::vector<RecordingBytes>& files, Observations& head);

}  // namespace runcert
