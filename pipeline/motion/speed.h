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

// Speeds are horizontal. With heights alone (Axes 1) they are vertical, without sign.

/// Vertical speed from a vertical velocity (m/s) and its variance (m^2/s^2), without sign.
SpeedEstimate vertical_speed(double velocity_m_s, double variance);

/// Horizontal displacement (m) of the craft between epochs s and e (s < e) of an arc: the
/// difference of the smoothed positions.
template <int Axes>
SpeedVector<Axes> displacement(const Chain<Axes>& arc, std::size_t s, std::size_t e);

/// Covariance (m^2) of `displacement`: P_s + P_e - C - C', from the joint covariance of both
/// positions.
template <int Axes>
SpeedMatrix<Axes> displacement_covariance(const Chain<Axes>& arc, std::size_t s, std::size_t e);

/// Horizontal displacement divided by time between epochs s and e of an arc. Its variance is u'
/// [P_s + P_e - C - C'] u / T^2. u is the direction of the displacement, and T (s) the time between
/// the epochs.
template <int Axes>
SpeedEstimate displacement_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s);

/// Length of the horizontal path through the smoothed positions from epoch s to e, divided by time,
/// with its uncertainty from the joint covariance of all these positions.
template <int Axes>
SpeedEstimate path_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e, double duration_s);

/// Mean of the smoothed horizontal speeds of epochs s to e, both included, with its uncertainty
/// from the joint covariance of all these velocities.
template <int Axes>
SpeedEstimate mean_speed(const Chain<Axes>& arc, std::size_t s, std::size_t e);

/// Gradients of these three speeds with respect to the smoothed states s to e, as
/// `Chain::variance` and `Chain::weights` take them. Zero if the displacement, or a
/// velocity, has no direction.
template <int Axes>
Gradients<Axes> displacement_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                             double duration_s);
template <int Axes>
Gradients<Axes> path_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e,
                                     double duration_s);
template <int Axes>
Gradients<Axes> mean_speed_gradients(const Chain<Axes>& arc, std::size_t s, std::size_t e);

}  // namespace runcert
