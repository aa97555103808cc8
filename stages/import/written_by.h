#pragma once

#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

namespace runcert {

/// Adds to `written_by` what a file says of the programs that made, converted, edited or simulated
/// it, and sets `simulated` where it says that. Looked for are, in text of any format and in what a
/// binary one holds of it, names of such programs and words as "created by" or "simulated", in any
/// case and several languages; in NMEA also the quality and mode of simulators. The lines around
/// them are taken, shortened, eight of a file at most, after `observations.device`, which the
/// format itself knows. `named`: behind the file's name.
///
/// A file that says nothing of the kind, or of which it was taken out, shows nothing.
void note_written_by(const RecordingBytes& file, bool named, Observations& observations);

}  // namespace runcert
