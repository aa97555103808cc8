#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// Locosys SBP logs (NaviGPS, GT-31, GW-52, GW-60, and loggers that write the same): a header of 64
/// bytes, then records of 32, least significant byte first, without checksums. Layout: gpsbabel's
/// navilink.h and sbp.cc; Logiqx, "SBP - SiRF Binary (Packed)", for the last two bytes.
namespace runcert::sbp {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Records that cannot be
/// read are counted and listed. Failure where it holds no epoch, or most of it cannot be read.
///
/// No accuracy of positions is stated. SDOP, the error estimate of the speed over ground, is of
/// one number and not of a vector: each horizontal axis is given all of it, which is what an
/// error without a preferred direction has along any course.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::sbp
