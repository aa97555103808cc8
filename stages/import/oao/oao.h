#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// Motion OAO logs: frames of u-blox solutions, one to an epoch, little-endian, each with a
/// checksum. Layout: "OAO file format" of Motion GPS, as the loggers' public writers have it and
/// the files in hand confirm.
namespace runcert::oao {

/// Whether the beginning of a recording (its first 64 KiB at most) is one.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Frames that cannot be
/// read are counted and listed. Failure where it holds no epoch, or most of it cannot be read.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::oao
