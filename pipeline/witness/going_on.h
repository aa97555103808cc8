#pragma once

#include <Eigen/Core>
#include <optional>

#include "schemas/enu/enu.h"

// Whether positions go on where the time stamps do not.

namespace runcert {

/// Two epochs next to one another in a recording, and the velocities (m/s) on both sides of the
/// step between them, as far as they are known.
struct RecordedStep {
    const EnuEpoch* from = nullptr;
    const EnuEpoch* to = nullptr;
    std::optional<Eigen::Vector3d> before, after;
};

/// No craft changes its speed faster.
inline constexpr double craft_acceleration_m_s2 = 10.0;

/// The least displacement (m) in `time_s`, of either sign, of a craft that has `speed_m_s` at both
/// ends and does not turn round: it brakes to a stand if it can, and takes up its speed again.
double least_displacement_m(double speed_m_s, double time_s);

/// A later less an earlier time (s), whatever they are.
double seconds_between(const EnuEpoch& earlier, const EnuEpoch& later);

/// The velocity that two positions give, east, north and up, the last 0 without heights. Nothing
/// where one of them is missing, or the time between them is not above 0 and at most `longest_s`.
std::optional<Eigen::Vector3d> velocity_between(const EnuEpoch& from, const EnuEpoch& to,
                                                double longest_s);

/// Whether a craft of these velocities can have made the step in `step_s`: from where they lead it
/// is no further than 5 standard uncertainties by what the positions state, what 10 m/s^2 do in
/// that time, and a quarter of the way. False without positions, or without a velocity.
bool goes_on(const RecordedStep& step, double step_s);

/// Whether the craft certainly did not take the time of the stamps for the step, but one interval:
/// it goes on so, and is so fast that it would have come further (`least_displacement_m`).
/// `stamped_s` may be of either sign.
bool clock_jumped(const RecordedStep& step, double stamped_s, double interval_s);

}  // namespace runcert
