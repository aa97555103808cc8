#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

/// RTKLIB solution files (.pos), RTKLIB 2.4.3 manual, appendix B.1, and what programs near it
/// write: all coordinates, time and separator variants, read by the names in the header line.
namespace runcert::rtklib_pos {

/// Whether the bytes hold an RTKLIB column header line, or rows that look as if one were missing.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Failure with line and
/// column on everything that is not understood.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

/// The same without holding its rows: the recording is read once for what they show as a whole, and
/// again when they are asked for.
StreamedRecording read_streamed(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::rtklib_pos
