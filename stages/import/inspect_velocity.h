#pragma once

#include <optional>

#include "schemas/observations/observations.h"

namespace runcert {

/// The delay of the recorded velocity behind the positions (s), by `velocities::estimate_delay`
/// against the motion that a parabola through the positions within 0.4 s of each epoch shows (two
/// epochs on either side at least). Nothing where the recording does not tell it.
std::optional<double> raw_velocity_delay_s(const Observations& observations);

}  // namespace runcert
