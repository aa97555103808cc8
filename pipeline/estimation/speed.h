#pragma once

#include <Eigen/Core>

#include "estimation/smoother.h"

namespace runcert {

/// A speed (m/s) and its standard uncertainty (m/s).
struct SpeedEstimate {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
};

/// Horizontal speed of a velocity (east, north; m/s) with covariance, by [DHD22] (25). At rest,
/// where the direction is undefined, the uncertainty is that of the least certain direction.
SpeedEstimate horizontal_speed(const Eigen::Vector2d& velocity, const Eigen::Matrix2d& covariance);

// Speeds are horizontal; of heights alone (Axes 1) they are vertical, without sign.

/// The vertical counterpart: speed of a vertical velocity (m/s) of this variance.
SpeedEstimate vertical_speed(double velocity_m_s, double variance);

/// Horizontal displacement (m) of the craft between epochs s and e (s < e) of an arc: the
/// difference of the smoothed positions; across a bridged step, over whose ends alone that would
/// hold the unknown offset, what velocity and acceleration at both ends say of the motion
/// (`BridgedStep`).
template <int Axes>
SpeedVector<Axes> displacement(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e);

/// Covariance (m^2) of this displacement: P_s + P_e - C - C', from the joint covariance of both
/// positions; across bridged steps, from that of all states between.
template <int Axes>
SpeedMatrix<Axes> displacement_covariance(const SmoothedArc<Axes>& arc, std::size_t s,
                                          std::size_t e);

/// Horizontal displacement over time between epochs s and e of an arc, with the uncertainty
/// u' [P_s + P_e - C - C'] u / T^2, or as above across bridged steps; u is the direction of the
/// displacement, T (s) the time between.
template <int Axes>
SpeedEstimate displacement_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                                 double duration_s);

/// Length of the horizontal path through the smoothed positions from epoch s to e, over time, with
/// its uncertainty from the joint covariance of all these positions. Over a bridged step the path
/// is the displacement.
template <int Axes>
SpeedEstimate path_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                         double duration_s);

/// Mean of the smoothed horizontal speeds of epochs s to e, both included, with its uncertainty
/// from the joint covariance of all these velocities.
template <int Axes>
SpeedEstimate mean_speed(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e);

/// Gradients of these three speeds by the smoothed states s to e: what `SmoothedArc::variance` and
/// `sensitivities` take. Zero where the displacement, or a velocity, has no direction.
template <int Axes>
Gradients<Axes> displacement_speed_gradients(const SmoothedArc<Axes>& arc, std::size_t s,
                                             std::size_t e, double duration_s);
template <int Axes>
Gradients<Axes> path_speed_gradients(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e,
                                     double duration_s);
template <int Axes>
Gradients<Axes> mean_speed_gradients(const SmoothedArc<Axes>& arc, std::size_t s, std::size_t e);

}  // namespace runcert
