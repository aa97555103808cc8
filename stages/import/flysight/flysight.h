#pragma once

#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// FlySight 1 and 2 track files (CSV). Layouts: "File format" of the FlySight wiki for the first,
/// the files' own $COL and $UNIT lines for the second.
namespace runcert::flysight {

/// Whether the beginning of a recording (its first 64 KiB at most) is one: also one with a damaged
/// header line, and those files of a FlySight 2 that hold no positions, to say so.
bool recognises(std::string_view bytes);

/// The whole recording as observations; the header is left for the caller. Records that cannot be
/// read are counted and listed. Failure where it holds no epoch, most of it cannot be read, or
/// the header does not name the columns.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::flysight
