#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// NMEA 0183 logs: GGA, RMC, VTG, GST, GSA and ZDA sentences of any talker, several of which make
/// an epoch.
namespace runcert::nmea {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Records that cannot be
/// read are counted and listed. Failure where it holds no epoch, or most of it cannot be read.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::nmea
