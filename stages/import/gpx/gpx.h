#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// GPX 1.0 and 1.1 tracks (Topografix, "GPX 1.1 Schema Documentation"), with any namespace prefix.
namespace runcert::gpx {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Each track point is an
/// epoch. Records that cannot be read are counted and listed. Failure where it holds no track
/// point, none with a time, or most of them cannot be read.
///
/// Speed (m/s) and course are those of GPX 1.0, or any extension's elements of these names. A GPX
/// states no accuracy: hdop is a geometry, not one.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::gpx
