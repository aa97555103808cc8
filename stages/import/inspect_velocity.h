#pragma once

#include <optional>

#include "estimation/velocity_origin.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// The delay of the recorded velocity behind the positions (s), by `velocities::estimate_delay`
/// against the motion that a parabola through the positions within 0.4 s of each epoch shows (two
/// epochs on either side at least). Nothing where the recording does not tell it.
std::optional<double> raw_velocity_delay_s(const Observations& observations);

/// Whether the recorded velocities and speeds were computed from the positions, by
/// `velocities::origin_of_speeds`.
velocities::Origin raw_velocity_origin(const Observations& observations);

/// The length of the horizontal recorded velocity, or the recorded speed (m/s).
std::optional<double> horizontal_speed(const RecordedVelocity& row);

}  // namespace runcert
