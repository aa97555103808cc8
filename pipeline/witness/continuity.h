#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "schemas/enu/declared.h"

// Whether positions continue steadily where the time stamps do not.

namespace runcert {

/// Two neighbouring epochs of a recording, and the velocities (m/s) before and after the step
/// between them, as far as known.
struct RecordedStep {
    const EnuEpoch* from = nullptr;
    const EnuEpoch* to = nullptr;
    std::optional<Eigen::Vector3d> before, after;
};

/// No craft is assumed to change its velocity faster.
inline constexpr double craft_acceleration_m_s2 = 10.0;

/// The least displacement (m) in `time_s`, of either sign, of a craft that has `speed_m_s` at both
/// ends and does not reverse. It brakes to a halt if it can, and then regains its speed.
double least_displacement_m(double speed_m_s, double time_s);

/// Time (s) from an earlier epoch to a later one, for any time stamps.
double seconds_between(const EnuEpoch& earlier, const EnuEpoch& later);

/// By how much the steps of these rows lead away, in sum, from whole intervals (s).
template <class Rows>
double beyond_whole_intervals_s(const Rows& rows, double interval_s) {
    double sum_s = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const double step_s = rows[i].time.seconds() - rows[i - 1].time.seconds();
        sum_s += step_s - interval_s * std::max(1.0, std::round(step_s / interval_s));
    }
    return std::abs(sum_s);
}

/// The velocity (m/s) between two positions: east, north and up, where up is 0 without heights.
/// Empty if a position is missing, or the time between them is not above 0 and at most
/// `longest_s`.
std::optional<Eigen::Vector3d> velocity_between(const EnuEpoch& from, const EnuEpoch& to,
                                                double longest_s);

/// Whether a craft with these velocities can have made the step in `step_s`. The step may miss the
/// position that the velocities predict by three terms together: 5 standard uncertainties as the
/// positions state them, the effect of 10 m/s^2 over that time, and a quarter of the distance.
/// False without positions, or without a velocity.
bool continues(const RecordedStep& step, double step_s);

/// Whether the step certainly took one interval rather than the time of its stamps. The craft
/// continues steadily over one interval, and at its speed it would have gone further in the stamped
/// time (`least_displacement_m`). `stamped_s` may be of either sign.
bool clock_jumped(const RecordedStep& step, double stamped_s, double interval_s);

}  // namespace runcert
