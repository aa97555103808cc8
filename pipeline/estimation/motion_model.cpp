#include "estimation/motion_model.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cassert>
#include <cmath>

namespace runcert {
namespace {

/// (1 - exp(-x)) / x.
double decay_mean(double x) {
    return x == 0.0 ? 1.0 : -std::expm1(-x) / x;
}

/// (x - 1 + exp(-x)) / x^2, by its series where the difference would lose digits.
double decay_second_mean(double x) {
    if (x > 1.0) return (1.0 - decay_mean(x)) / x;
    double term = 0.5;
    double sum = term;
    for (int n = 3; std::abs(term) > 1e-18 * sum; ++n) {
        term *= -x / n;
        sum += term;
    }
    return sum;
}

/// What an acceleration of 1 at the beginning makes of position, velocity and acceleration after
/// `s`, with decay rate `alpha`; any unit of time.
Eigen::Vector3d acceleration_response(double alpha, double s) {
    const double x = alpha * s;
    return {s * s * decay_second_mean(x), s * decay_mean(x), std::exp(-x)};
}

/// What white-noise jerk of density 1 does in a step of length 1: the integral over the step of the
/// response times its transpose, by Gauss-Legendre quadrature with 15 points.
Eigen::Matrix3d jerk_noise(double alpha) {
    using Quadrature = boost::math::quadrature::gauss<double, 15>;
    const auto at = [&](double s) -> Eigen::Matrix3d {
        const Eigen::Vector3d one = acceleration_response(alpha, s);
        return one * one.transpose();
    };
    const auto& points = Quadrature::abscissa();
    const auto& weights = Quadrature::weights();
    Eigen::Matrix3d sum = weights[0] * at(0.5);
    for (std::size_t i = 1; i < points.size(); ++i)
        sum += weights[i] * (at(0.5 + 0.5 * points[i]) + at(0.5 - 0.5 * points[i]));
    return 0.5 * sum;
}

/// Spreads a 3x3 matrix and the scalar of the error over the state of all axes.
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

GaussMarkovError GaussMarkovError::bounding(double sigma_m, double tau_min_s, double tau_max_s) {
    const double sigma = std::max(sigma_m, 1e-5);
    return {.tau_s = tau_max_s,
            .process_density = sigma * std::sqrt(2.0 / tau_min_s),
            .initial_sigma_m = sigma * std::sqrt(2.0 / (1.0 + tau_min_s / tau_max_s))};
}

GaussMarkovError GaussMarkovError::bounding_diffusion(double diffusion, double tau_max_s) {
    return steady(diffusion * std::sqrt(0.5 * tau_max_s), tau_max_s);
}

GaussMarkovError GaussMarkovError::larger(const GaussMarkovError& one,
                                          const GaussMarkovError& other) {
    assert(one.tau_s == other.tau_s);
    return {.tau_s = one.tau_s,
            .process_density = std::max(one.process_density, other.process_density),
            .initial_sigma_m = std::max(one.initial_sigma_m, other.initial_sigma_m)};
}

AxisStep axis_step(const EstimationModel& model, double dt_s) {
    // A step long against the acceleration's time is made of two: the quadrature is for smooth
    // integrands.
    if (dt_s > 2.0 * model.motion.acceleration_time_s) {
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
    const Eigen::Vector3d response = acceleration_response(alpha, 1.0);
    const Eigen::Matrix3d noise = jerk_noise(alpha);
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
    // With the diagonal scaled to one, so that short steps lose no digits. The information matrix
    // of the scaled noise is L L': the whitening factor is L'.
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
