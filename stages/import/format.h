#pragma once

#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"
#include "stages/import/row_collector.h"

namespace runcert {

/// All there is to say of a format. Each folder of stages/import defines one in its own namespace,
/// `extern const Format format`; the build lists the folders.
struct Format {
    std::string_view name;  ///< as the attempt's `format` has it
    std::string_view what;  ///< in words
    /// Its place among the formats, ascending, as they are listed and tried: those that no other
    /// could be taken for come first.
    int place = 0;
    bool stamps_satellite_time = false;  ///< whether its time stamps are the satellites' time
    std::string_view time_origin;        ///< what its time stamps are, in words
    /// Whether the beginning of a recording (`recognised_by` bytes at most) is of it. Null where
    /// its content does not say how it is to be read.
    bool (*recognises)(std::string_view bytes) = nullptr;
    /// Null where other programs make observations of it.
    Observations (*read)(const Receiver&, const RecordingBytes&) = nullptr;
    /// For formats that a recording of very many epochs comes in.
    StreamedRecording (*read_streamed)(const Receiver&, const RecordingBytes&) = nullptr;
};

/// By their places.
const std::vector<const Format*>& formats();

/// Null for an unknown name.
const Format* find_format(std::string_view name);

}  // namespace runcert
