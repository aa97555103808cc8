#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "schemas/recognition/declared.h"
#include "stages/import/recording.h"

namespace runcert {

/// Whether the beginning of a file is that of a RINEX navigation file.
bool is_navigation(std::string_view bytes);

/// The keys of an attempt that this file can be the series of (wheel, gates, wind, ...), by its
/// columns; none for any other file.
std::vector<std::string> series_in(const RecordingBytes& file);

/// A key of a receiver that a recording does not answer, with the reason and the values that the
/// attempt's table of fields has for it.
NeededKey needed_key(const std::string& key, bool required);

/// What a recording is that was read as `receiver` says, and what the receiver leaves out that an
/// attempt needs. `now`: later dates cannot be; empty where that is not asked.
Recognition recognition_of(const Observations& observations, const Receiver& receiver,
                           const std::optional<GpsTime>& now = std::nullopt);

/// The same of a table that no format recognises: how it may be read, and what is needed for that.
/// `given`: columns that somebody names. Failure for a text that is no table.
Recognition recognition_of_table(const RecordingBytes& recording, const CsvColumns& given = {},
                                 const std::optional<GpsTime>& now = std::nullopt);

}  // namespace runcert
