#pragma once

#include "stages/import/imu/imu.h"
#include "stages/import/imu/raw.h"

namespace runcert::imu {

/// Puts the times of samples, settled before, on the recording's scale: nanoseconds since its first
/// epoch. Says in the notes what they were taken for, and what of the recording they do not cover.
///
/// Failure where they cannot be put there, or share no time with the recording.
void tie_to_recording(const Receiver& receiver, const RecordingSpan& recording, RawFile& raw);

}  // namespace runcert::imu
