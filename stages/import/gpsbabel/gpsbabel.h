#pragma once

#include <string>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// Recordings that gpsbabel reads and this program does not, through it, as the GPX 1.0 it makes of
/// them. They carry no accuracy.
namespace runcert::gpsbabel {

/// What gpsbabel made of a recording.
struct Converted {
    std::string gpx;
    CalledProgram program;  ///< gpsbabel, version "1.8.0"
};

/// Whether the beginning of a recording is one of a well-known format that goes through gpsbabel:
/// Garmin FIT, Garmin Training Center (TCX), KML.
bool recognises(std::string_view bytes);

/// gpsbabel's name of a recording's format ("garmin_fit"): the receiver's gpsbabel_type, or what is
/// recognised. Failure where there is neither, and where the name is none of the formats, files
/// with tracks, that gpsbabel 1.8.0 reads: names of devices and options after a comma are refused.
std::string type_of(const Receiver& receiver, const RecordingBytes& recording);

/// Has gpsbabel read a recording as its format `type` (checked by type_of) and write GPX 1.0, which
/// keeps speeds, courses and decimals of seconds. gpsbabel runs for at most two minutes, with 2 GiB
/// of memory and of output. Failure where it is not installed, and with its own words where it
/// cannot read the recording. Defined where other programs may be run: link
/// runcert_import_programs.
Converted convert(const std::string& type, const RecordingBytes& recording);

/// The recording as observations, out of what gpsbabel made of it; of the header it has the
/// program. Rows say no line or byte, because those are not of the recording. Failure as of GPX.
Observations read_converted(const Receiver& receiver, const RecordingBytes& recording,
                            const std::string& type, const Converted& converted);

}  // namespace runcert::gpsbabel
