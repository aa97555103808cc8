#pragma once

#include <Eigen/Core>

#include "motion/chain.h"

namespace runcert {

/// A speed (m/s) and its standard uncertainty (m/s).
struct SpeedEstimate {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
};

/// Horizontal speed of a velocity (east, north; m/s) with covariance, by [DHD22] (25). At rest,
/// where the direction is undefined, the uncertainty is that of the least certain direction.
SpeedEstimate horizontal_speed(const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance);

/// Horizontal displacement (m) of the craft between epochs s and e (s < e) of an arc: the
/// difference of the smoothed positions. With heights alone (Axes 1) it is vertical.
template <int Axes>
SpeedVector<Axes> displacement(const Chain<Axes>& arc, std::size_t s, std::size_t e);

/// Covariance (m^2) of `displacement`: P_s + P_e - C - C', from the joint covariance of both
/// positions.
template <int Axes>
SpeedMatrix<Axes> displacement_covariance(const Chain<Axes>& arc, std::size_t s, std::size_t e);

}  // namespace runcert
