#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <limits>

namespace runcert {

/// Positions, velocities, accelerations and correlated position errors of `Axes` axes (1: one
/// alone; 2: east, north; 3: and up), in this order: all positions (m), all velocities (m/s), all
/// accelerations (m/s^2), all errors (m).
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

/// How the craft moves, each axis for itself: white-noise jerk on an acceleration that persists
/// (model (32) of [DHD22] in continuous time), or that dies away with a correlation time
/// [Singer70].
struct MotionModel {
    double jerk_density = 1.0;  ///< root spectral density of the driving noise, m s^-2.5
    /// Correlation time of the acceleration, s; infinite where it persists.
    double acceleration_time_s = std::numeric_limits<double>::infinity();
};

/// A first-order Gauss-Markov error of the measured positions, the same for each axis and
/// independent between them: db/dt = -b / tau + white noise.
struct GaussMarkovError {
    double tau_s = 1.0;            ///< correlation time, s
    double process_density = 0.0;  ///< root spectral density of the driving noise, m s^-0.5
    double initial_sigma_m = 0.0;  ///< standard deviation at the first epoch of an arc, m

    /// A steady error of standard deviation `sigma_m` ([YSM22]). A size of zero is taken as 10 um,
    /// which keeps covariances regular and changes nothing.
    static GaussMarkovError steady(double sigma_m, double tau_s);

    /// The process whose covariance bounds that of every steady error of standard deviation
    /// `sigma_m` with a correlation time between `tau_min_s` and `tau_max_s`: correlation time
    /// tau_max, process noise larger by tau_max / tau_min, initial variance
    /// 2 sigma^2 / (1 + tau_min / tau_max) [LGJ21].
    ///
    /// Bounds: the covariance between all epochs less the true one is positive semidefinite, so
    /// that any weighted sum of the errors, by whatever estimator, has at most this variance. The
    /// probability of a path x(t) from 0 to T under the steady error of correlation time tau is
    /// proportional to exp(-I/2),
    ///     sigma^2 I = (x0^2 + xT^2 + tau int x'^2 + int x^2 / tau) / 2,
    /// and under the bounding process, with p its initial variance, tau_min and tau_max as a and b,
    ///     sigma^2 J = sigma^2 x0^2 / p
    ///                 + (a int x'^2 + (a / b^2) int x^2 + (a / b) (xT^2 - x0^2)) / 2.
    /// With that p the terms of x0^2 are the same in both, and those of xT^2, int x'^2 and int x^2
    /// are none of them larger in J, as long as a <= tau <= b^2 / a: I - J is positive semidefinite
    /// for every path, and with the informations in that order the covariances are in the other.
    static GaussMarkovError bounding(double sigma_m, double tau_min_s, double tau_max_s);

    /// The steady process of correlation time `tau_max_s` whose covariance bounds, in the same
    /// sense, that of every steady error that wanders as fast, sigma sqrt(2 / tau) = `diffusion`
    /// (m s^-0.5), with a shorter correlation time: the spectrum, diffusion^2 / (w^2 + 1 / tau^2),
    /// grows with tau at every frequency.
    static GaussMarkovError bounding_diffusion(double diffusion, double tau_max_s);

    /// A process that bounds what either of two bounds; they must have one correlation time.
    static GaussMarkovError larger(const GaussMarkovError& one, const GaussMarkovError& other);
};

/// What the estimate rests on: the motion, and the errors of the measured positions as white noise
/// (the stated covariances times the square of a scale) and a Gauss-Markov error beside it.
struct EstimationModel {
    MotionModel motion;
    double measurement_scale = 1.0;
    GaussMarkovError error = GaussMarkovError::steady(0.0, 1.0);
};

/// What the steps of an arc differ in: their length, and the motion that may happen in them. Steps
/// of the same kind share what is made from them.
struct StepKind {
    std::int64_t length_ns = -1;
    double jerk_factor = 1.0;  ///< jerk density of the step in units of the model's

    double dt_s() const { return static_cast<double>(length_ns) * 1e-9; }
    auto operator<=>(const StepKind&) const = default;
};

/// One step of time for one axis.
struct AxisStep {
    double dt_s = 0.0;
    Eigen::Matrix3d transition;     ///< of position, velocity, acceleration
    Eigen::Matrix3d process_noise;  ///< its exact covariance
    double error_transition = 0.0;  ///< of the Gauss-Markov error
    double error_noise = 0.0;       ///< its variance, m^2
};

/// The step over `dt` seconds (> 0), exact for continuous time, in closed form, so that steps which
/// are all different cost little more than equal ones; in units of the step, so that short ones
/// lose no digits.
AxisStep axis_step(const EstimationModel& model, double dt_s);

/// The same of a step whose jerk density is that many times the model's.
AxisStep axis_step(const EstimationModel& model, const StepKind& kind);

/// A step at the model's jerk density as one at `factor` times that.
AxisStep with_jerk(AxisStep step, double factor);

/// The upper-triangular W with W' W = inverse of the process noise of position, velocity and
/// acceleration: it turns that noise into three independent unit variances.
Eigen::Matrix3d axis_process_whitener(const AxisStep& step);

/// The same step for all axes together.
template <int Axes>
StateMatrix<Axes> transition(const AxisStep& step);
template <int Axes>
StateMatrix<Axes> process_noise(const AxisStep& step);

}  // namespace runcert
