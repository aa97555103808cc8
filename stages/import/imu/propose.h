#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schemas/recognition/declared.h"
#include "stages/import/imu/quality.h"
#include "stages/import/imu/raw.h"
#include "stages/import/imu/sampling.h"
#include "stages/import/recording.h"

namespace runcert::imu {

/// What an attempt could say of a file that may be an IMU's.
struct Proposal {
    Receiver receiver;  ///< whose imu reads the file, as far as its problem is empty
    Recognition is;     ///< the keys of imu: that names and readings suggest, and what is unsure
    std::optional<RawFile> raw = std::nullopt;  ///< as read, its times put in order
    std::optional<Sampling> sampling = std::nullopt;
    std::optional<Stretch> quiet = std::nullopt;
};

/// By the format, or the names of the columns, or what numbers without names hold: three readings
/// whose length is that of gravity are accelerometers, the three beside them gyros, and what only
/// grows is the time. Units are those of the names; else the accelerometers' by the size of
/// gravity, the gyros' by that of their readings, the time's by its steps. Nothing for a file that
/// is no IMU's.
std::optional<Proposal> propose(const RecordingBytes& file);

/// What the file is: rate, gravity at rest, which axis is down, gaps, ranges, and what an attempt
/// must say of it.
Recognition recognition_of(const Proposal& proposal);

}  // namespace runcert::imu
