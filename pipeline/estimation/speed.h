#pragma once

#include <Eigen/Core>

#include "estimation/smoother.h"

namespace runcert {

/// A speed (m/s) and its standard uncertainty (m/s).
struct SpeedEstimate {
    double speed_mps = 0.0;
    double standard_uncertainty_mps = 0.0;
};

/// Horizontal speed of a velocity (east, north; m/s) with covariance, by [DHD22] (25). At rest,
/// where the direction is undefined, the uncertainty is that of the least certain direction.
SpeedEstimate horizontal_speed(const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance);

/// Horizontal displacement over time between epochs s and e of an arc, with the uncertainty
/// u' [P_s + P_e - C - C'] u / T^2 from the joint covariance of both positions; u is the direction
/// of the displacement, T (s) the time between.
template <int Axes>
SpeedEstimate displacement_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s);

}  // namespace runcert
