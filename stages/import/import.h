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

}  // namespace runcert
