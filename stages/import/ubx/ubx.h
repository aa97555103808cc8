#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// u-blox UBX logs: NAV-PVT, NAV-HPPOSLLH, NAV-COV and NAV-DOP frames, or those of older receivers,
/// between which other bytes may stand.
namespace runcert::ubx {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Records that cannot be
/// read are counted and listed. Failure where it holds no epoch, or most of it cannot be read.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::ubx
