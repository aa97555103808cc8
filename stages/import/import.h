#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert {

/// Reads a recording in any supported format into WGS 84 positions (or engineering coordinates),
/// with the accuracy they state, in GPS time; every row keeps the line and byte it comes from, and
/// the rows keep the recording's order. `header` is left for the caller.
///
/// `receiver.format` "auto" recognises the format by content, or takes CSV where the receiver
/// names columns. Failure with "file:line:column" where anything is not understood.
Observations import_recording(const Receiver& receiver, const RecordingBytes& recording);

/// Whether `import_recording` reads it without help: the attempt says what it is, or it is
/// recognised as a format of this program's own. If not, gpsbabel may know it.
bool is_read_by_itself(const Receiver& receiver, const RecordingBytes& recording);

/// The same, row by row where that saves memory: for formats that a recording of very many epochs
/// comes in. Nothing where it is held whole all the same.
std::optional<StreamedRecording> import_streamed(const Receiver& receiver,
                                                 const RecordingBytes& recording);

using ReadRecording = Observations(const Receiver&, const RecordingBytes&);

/// The same for a recording in several files that follow one another: their rows one after the
/// other, numbered through, each read by `read_one`. Notes say how they overlap and what is missing
/// between them. Failure where they are of different formats or coordinates, or have no times of
/// their own.
Observations import_recordings(const Receiver& receiver,
                               const std::vector<RecordingBytes>& recordings,
                               const std::function<ReadRecording>& read_one = import_recording);

/// Says where times and fix types come from: by the format, and where that leaves it open,
/// by what the attempt states (`receivers[].time_source`, `receivers[].solution`), which is a claim
/// that somebody must answer for. Rows whose fix type the recording does not say get the
/// stated one.
void note_origins(const Receiver& receiver, Observations& observations);

/// The same of a table whose rows say their fix type themselves.
void note_origins_of_head(const Receiver& receiver, Observations& head);

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
