#pragma once

#include <Eigen/Core>

namespace runcert {

/// Positions, velocities and accelerations of `Axes` axes (2: east, north; 3: and up), in this
/// order: all positions (m), then all velocities (m/s), then all accelerations (m/s^2).
template <int Axes>
inline constexpr int state_size = 3 * Axes;
template <int Axes>
using StateVector = Eigen::Matrix<double, state_size<Axes>, 1>;
template <int Axes>
using StateMatrix = Eigen::Matrix<double, state_size<Axes>, state_size<Axes>>;
template <int Axes>
using PositionVector = Eigen::Matrix<double, Axes, 1>;
template <int Axes>
using PositionMatrix = Eigen::Matrix<double, Axes, Axes>;

/// Constant acceleration driven by white-noise jerk, each axis for itself: model (32) of [DHD22]
/// in continuous time.
struct MotionModel {
    double jerk_density = 1.0;  ///< root spectral density of the jerk, m s^-2.5
};

/// Transition over `dt` seconds of one axis' position, velocity, acceleration:
/// [1 dt dt^2/2; 0 1 dt; 0 0 1].
Eigen::Matrix3d axis_transition(double dt_s);

/// Exact covariance of the process noise over `dt` seconds, one axis:
/// q [dt^5/20 dt^4/8 dt^3/6; dt^4/8 dt^3/3 dt^2/2; dt^3/6 dt^2/2 dt], q the squared density.
Eigen::Matrix3d axis_process_noise(const MotionModel& model, double dt_s);

/// The upper-triangular W with W' W = inverse of axis_process_noise: it turns process noise into
/// three independent unit variances. Computed from the constant matrix of dt = 1, so that short
/// steps lose no digits.
Eigen::Matrix3d axis_process_whitener(const MotionModel& model, double dt_s);

/// The same for all axes together.
template <int Axes>
StateMatrix<Axes> transition(double dt_s);
template <int Axes>
StateMatrix<Axes> process_noise(const MotionModel& model, double dt_s);

}  // namespace runcert
