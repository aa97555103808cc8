#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <limits>

namespace runcert {

/// Size of a state with `Axes` axes (1: a single one; 2: east, north; 3: east, north, up). The
/// state holds all positions (m), then all velocities (m/s), all accelerations (m/s^2) and all
/// Gauss-Markov position errors (m).
template <int Axes>
inline constexpr int state_size = 4 * Axes;
template <int Axes>
using StateVector = Eigen::Matrix<double, state_size<Axes>, 1>;
template <int Axes>
using StateMatrix = Eigen::Matrix<double, state_size<Axes>, state_size<Axes>>;
template <int Axes>
using PositionVector = Eigen::Matrix<double, Axes, 1>;
template <int Axes>
using PositionMatrix = Eigen::Matrix<double, Axes, Axes>;

/// How the craft moves, independently on each axis. White-noise jerk drives an acceleration that
/// either persists (model (32) of [DHD22] in continuous time) or decays with a correlation time
/// [Singer70].
struct MotionModel {
    double jerk_density = 1.0;  ///< root spectral density of the driving noise, m s^-2.5
    /// Correlation time of the acceleration, s. Infinite if the acceleration persists.
    double acceleration_time_s = std::numeric_limits<double>::infinity();
};

/// A first-order Gauss-Markov error of the measured positions, with the same parameters on each
/// axis and independent between axes: db/dt = -b / tau + white noise.
struct GaussMarkovError {
    double tau_s = 1.0;            ///< correlation time, s
    double process_density = 0.0;  ///< root spectral density of the driving noise, m s^-0.5
    double initial_sigma_m = 0.0;  ///< standard deviation at the first epoch of an arc, m

    /// A stationary error of standard deviation `sigma_m` ([YSM22]). A size of zero is taken as
    /// 10 um, which keeps covariances regular and changes nothing.
    static GaussMarkovError steady(double sigma_m, double tau_s);
};

/// The assumptions of an estimate: the motion, and two kinds of error of the measured positions.
/// They are white noise, with the stated covariances times the square of a scale, and a
/// Gauss-Markov error.
struct EstimationModel {
    MotionModel motion;
    double measurement_scale = 1.0;
    GaussMarkovError error = GaussMarkovError::steady(0.0, 1.0);
};

/// What distinguishes the steps of an arc: their length, and the motion possible within them. Steps
/// of the same kind share derived quantities.
struct StepKind {
    std::int64_t length_ns = -1;
    double jerk_factor = 1.0;  ///< jerk density of the step in units of the model's

    double dt_s() const { return static_cast<double>(length_ns) * 1e-9; }
    auto operator<=>(const StepKind&) const = default;
};

/// One time step for one axis.
struct AxisStep {
    double dt_s = 0.0;
    Eigen::Matrix3d transition;     ///< of position, velocity, acceleration
    Eigen::Matrix3d process_noise;  ///< exact covariance of its noise
    double error_transition = 0.0;  ///< of the Gauss-Markov error
    double error_noise = 0.0;       ///< its variance over the step, m^2
};

/// The step over `dt_s` seconds (> 0), exact for continuous time. The closed form makes steps of
/// different lengths cost little more than equal ones. It works in units of the step, so that short
/// steps lose no digits.
AxisStep axis_step(const EstimationModel& model, double dt_s);

/// The step of this kind: its length, and its jerk density in units of the model's.
AxisStep axis_step(const EstimationModel& model, const StepKind& kind);

/// The same step with a jerk density of `factor` times the model's. The given step must have the
/// model's own.
AxisStep with_jerk(AxisStep step, double factor);

/// The upper-triangular W with W' W = inverse of the process noise of position, velocity and
/// acceleration. W turns that noise into three independent unit variances.
Eigen::Matrix3d axis_process_whitener(const AxisStep& step);

/// Transition and process noise of the step for all axes together.
template <int Axes>
StateMatrix<Axes> transition(const AxisStep& step);
template <int Axes>
StateMatrix<Axes> process_noise(const AxisStep& step);

}  // namespace runcert
