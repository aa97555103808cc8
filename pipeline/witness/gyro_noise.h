#pragma once

#include <optional>
#include <string>

#include "schemas/attempt/attempt.h"
#include "schemas/imu/declared.h"

namespace runcert {

/// White noise of a gyro's sample (rad/s), from the differences of successive ones: of the axis
/// that has most in the second, without a gap, in which that is least, and no less than the step of
/// the readings makes. Motion of the craft does not lower it. Nothing where there is no such
/// second, or fewer than ten samples in it.
std::optional<double> least_gyro_noise(const ImuTable& imu);

/// A sentence on gyros whose noise is less than a tenth of what their grade makes, with what to do
/// about it. Empty if they have more.
///
/// Recorded ones of the MEMS class had 0.4 of its noise held still, and 7 to 12 times that on a
/// car. Degrees taken for radians make gyros 57 times louder, as vibration does nearly. Radians
/// taken for degrees make them as much quieter, as nothing else does.
std::string quiet_gyros_text(const ImuTable& imu, const Imu& stated);

}  // namespace runcert
