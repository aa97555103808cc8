#include "motion/motion_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace runcert {
namespace {

/// (1 - exp(-x)) / x.
double decay_mean(double x) {
    return x == 0.0 ? 1.0 : -std::expm1(-x) / x;
}

/// Number of terms of the power series below: enough for a double's precision where x is at most 1.
constexpr int terms = 21;
using Coefficients = std::array<double, terms>;

/// Coefficients of (x - 1 + exp(-x)) / x^2: (-1)^n / (n + 2)!.
constexpr Coefficients response_coefficients() {
    Coefficients of{};
    double factorial = 2.0;
    for (int n = 0; n < terms; ++n) {
        of[static_cast<std::size_t>(n)] = (n % 2 == 0 ? 1.0 : -1.0) / factorial;
        factorial *= n + 3;
    }
    return of;
}

/// Coefficients of the integral over s from 0 to 1 of (x s - 1 + exp(-x s))^2 / x^4. The square is
/// expanded and integrated term by term: with m = n + 4, (-1)^m (2^m - 2 (m + 1)) / (m! (m + 1)).
constexpr Coefficients response_square_coefficients() {
    Coefficients of{};
    double power = 16.0;
    double factorial = 24.0;
    for (int n = 0; n < terms; ++n) {
        const int m = n + 4;
        of[static_cast<std::size_t>(n)] =
            (m % 2 == 0 ? 1.0 : -1.0) * (power - 2.0 * (m + 1)) / (factorial * (m + 1));
        power *= 2.0;
        factorial *= m + 1;
    }
    return of;
}

/// Effect of a step of length 1 on acceleration, and through it on velocity and position.
struct UnitStep {
    Eigen::Vector3d response;  ///< of position, velocity, acceleration to an acceleration of 1
    Eigen::Matrix3d noise;     ///< covariance caused by white-noise jerk of density 1
};

/// The unit step where the acceleration decays at the rate `alpha` (at most 1). The response at s
/// is
///     r0(s) = (alpha s - 1 + exp(-alpha s)) / alpha^2, r1 = s - alpha r0, r2 = 1 - alpha r1,
/// each the derivative of the one before. The noise is the integral of r r' from 0 to 1. By parts,
/// all of it follows from r0(1) and the integral of r0^2, which are series. Nothing is divided by a
/// small alpha, and differences lose no more than two bits.
UnitStep unit_step(double alpha) {
    static constexpr Coefficients of_response = response_coefficients();
    static constexpr Coefficients of_square = response_square_coefficients();
    double r0 = of_response[0];
    double square = of_square[0];
    double power = alpha;
    for (std::size_t n = 1; n < terms && power > 1e-17; ++n) {
        r0 += of_response[n] * power;
        square += of_square[n] * power;
        power *= alpha;
    }
    const double r1 = 1.0 - alpha * r0;
    const double r2 = 1.0 - alpha * r1;
    const double r1_square = 1.0 / 3.0 - alpha * (r0 * r0 + alpha * square);
    const double r0_r1 = 0.5 * r0 * r0;
    const double r0_r2 = r0 * r1 - r1_square;
    const double r1_r2 = 0.5 * r1 * r1;
    UnitStep unit;
    unit.response << r0, r1, r2;
    unit.noise << square, r0_r1, r0_r2,  //
        r0_r1, r1_square, r1_r2,         //
        r0_r2, r1_r2, 0.5 * r1 * (1.0 + r2);
    return unit;
}

/// Expands a 3x3 matrix and the scalar of the error to the state of all axes.
template <int Axes>
StateMatrix<Axes> on_all_axes(const Eigen::Matrix3d& motion, double error) {
    StateMatrix<Axes> all = StateMatrix<Axes>::Zero();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            all.template block<Axes, Axes>(row * Axes, column * Axes)
                .diagonal()
                .setConstant(motion(row, column));
    all.template bottomRightCorner<Axes, Axes>().diagonal().setConstant(error);
    return all;
}

}  // namespace

GaussMarkovError GaussMarkovError::steady(double sigma_m, double tau_s) {
    const double sigma = std::max(sigma_m, 1e-5);
    return {.tau_s = tau_s,
            .process_density = sigma * std::sqrt(2.0 / tau_s),
            .initial_sigma_m = sigma};
}

AxisStep axis_step(const EstimationModel& model, double dt_s) {
    // A step longer than the acceleration's correlation time is made of two, because the series
    // hold for short ones.
    if (dt_s > model.motion.acceleration_time_s) {
        AxisStep step = axis_step(model, 0.5 * dt_s);
        const Eigen::Matrix3d carried =
            step.transition * step.process_noise * step.transition.transpose();
        step.process_noise += 0.5 * (carried + carried.transpose());
        step.transition = (step.transition * step.transition).eval();
        step.error_noise *= 1.0 + step.error_transition * step.error_transition;
        step.error_transition *= step.error_transition;
        step.dt_s = dt_s;
        return step;
    }
    // In units of the step: position 1, velocity 1/dt, acceleration 1/dt^2.
    const double alpha = dt_s / model.motion.acceleration_time_s;
    const auto [response, noise] = unit_step(alpha);
    const double q = model.motion.jerk_density * model.motion.jerk_density;
    const Eigen::Vector3d unit(dt_s * dt_s, dt_s, 1.0);
    AxisStep step;
    step.dt_s = dt_s;
    step.transition << 1.0, dt_s, dt_s * dt_s * response(0),  //
        0.0, 1.0, dt_s * response(1),                         //
        0.0, 0.0, response(2);
    step.process_noise = q * dt_s * noise.cwiseProduct(unit * unit.transpose());
    const double x = dt_s / model.error.tau_s;
    step.error_transition = std::exp(-x);
    step.error_noise =
        model.error.process_density * model.error.process_density * dt_s * decay_mean(2.0 * x);
    return step;
}

AxisStep axis_step(const EstimationModel& model, const StepKind& kind) {
    return with_jerk(axis_step(model, kind.dt_s()), kind.jerk_factor);
}

AxisStep with_jerk(AxisStep step, double factor) {
    step.process_noise *= factor * factor;
    return step;
}

Eigen::Matrix3d axis_process_whitener(const AxisStep& step) {
    // The diagonal is scaled to one, so that short steps lose no digits. The information matrix of
    // the scaled noise is L L', and the whitening factor is L'.
    const Eigen::Vector3d scale = step.process_noise.diagonal().cwiseSqrt();
    const Eigen::Vector3d inverse_scale = scale.cwiseInverse();
    const Eigen::Matrix3d scaled =
        inverse_scale.asDiagonal() * step.process_noise * inverse_scale.asDiagonal();
    const Eigen::Matrix3d information = scaled.inverse();
    const Eigen::Matrix3d factor = information.llt().matrixL().transpose();
    return factor * inverse_scale.asDiagonal();
}

template <int Axes>
StateMatrix<Axes> transition(const AxisStep& step) {
    return on_all_axes<Axes>(step.transition, step.error_transition);
}

template <int Axes>
StateMatrix<Axes> process_noise(const AxisStep& step) {
    return on_all_axes<Axes>(step.process_noise, step.error_noise);
}

template StateMatrix<1> transition<1>(const AxisStep&);
template StateMatrix<2> transition<2>(const AxisStep&);
template StateMatrix<3> transition<3>(const AxisStep&);
template StateMatrix<1> process_noise<1>(const AxisStep&);
template StateMatrix<2> process_noise<2>(const AxisStep&);
template StateMatrix<3> process_noise<3>(const AxisStep&);

}  // namespace runcert
