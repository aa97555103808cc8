#pragma once

#include <optional>
#include <vector>

#include "schemas/observations/observations.h"
#include "witness/velocity_origin.h"

namespace runcert {

/// The delay of the recorded velocity behind the positions (s), by `velocities::estimate_delay`
/// against the motion that a parabola through the positions within 0.4 s of each epoch shows (two
/// epochs on either side at least). Nothing where the recording does not tell it.
std::optional<double> raw_velocity_delay_s(const Observations& observations);

/// What screening takes off of a delay where the attempt says nothing else (s).
inline constexpr double longest_velocity_delay_s = 1.0;

/// A delay of the recorded speeds behind the positions over a part of a recording; times from its
/// first epoch (s).
struct RawDelay {
    double from_s = 0.0, to_s = 0.0;
    double delay_s = 0.0, sigma_s = 0.0;
    bool beyond = false;  ///< more than `longest_velocity_delay_s`
};

/// Delays along the recording by the lengths of the speeds, with a course or without, by
/// `velocities::delays_along` against the same motion.
std::vector<RawDelay> raw_velocity_delays(const Observations& observations);

/// Whether the recorded velocities and speeds were computed from the positions, by
/// `velocities::origin_of_speeds`.
velocities::Origin raw_velocity_origin(const Observations& observations);

/// The length of the horizontal recorded velocity, or the recorded speed (m/s).
std::optional<double> horizontal_speed(const RecordedVelocity& row);

}  // namespace runcert
