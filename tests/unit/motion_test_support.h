#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <cmath>
#include <span>
#include <vector>

#include "core/random.h"
#include "motion/chain.h"

namespace runcert::test {

/// Numbers of 33 digits: what is solved with them is exact as far as doubles can tell.
using Quad = boost::multiprecision::number<boost::multiprecision::cpp_bin_float_quad::backend_type,
                                           boost::multiprecision::et_off>;
using QuadMatrix = Eigen::Matrix<Quad, Eigen::Dynamic, Eigen::Dynamic>;
using QuadVector = Eigen::Matrix<Quad, Eigen::Dynamic, 1>;

/// An 8 mm Gauss-Markov error beside the white noise, and an acceleration that dies away.
inline const EstimationModel singer_with_error{
    .motion = {.jerk_density = 0.6, .acceleration_time_s = 1.5},
    .measurement_scale = 1.3,
    .error = GaussMarkovError::steady(0.008, 2.0)};

/// An error that is not steady: it grows from 28 to 89 mm.
inline constexpr GaussMarkovError growing_error{
    .tau_s = 10.0, .process_density = 0.04, .initial_sigma_m = 0.0276};

/// An arc with irregular steps, correlated measurement errors of changing size and one epoch
/// without a measurement.
template <int Axes>
std::vector<ArcEpoch<Axes>> sample_arc(std::size_t epochs, std::size_t missing = 4) {
    RandomGenerator random(7);
    std::vector<ArcEpoch<Axes>> arc(epochs);
    std::int64_t time_ns = 2'000'000'000;
    for (std::size_t k = 0; k < epochs; ++k) {
        arc[k].time_s = static_cast<double>(time_ns) * 1e-9;
        PositionMeasurement<Axes> measurement;
        PositionMatrix<Axes> factor =
            PositionMatrix<Axes>::Identity() * (0.008 + 0.004 * random.uniform());
        if constexpr (Axes > 1) factor(1, 0) = 0.006;
        measurement.covariance = factor * factor.transpose();
        for (int axis = 0; axis < Axes; ++axis)
            measurement.position(axis) = 5.0 + 11.0 * arc[k].time_s +
                                         axis * arc[k].time_s * arc[k].time_s +
                                         0.01 * random.normal();
        if (k != missing) arc[k].measurement = measurement;
        time_ns += 80'000'000 + std::llround(4e7 * random.uniform());
    }
    return arc;
}

/// The motion of an arc in turns of seven steps that are alike.
template <int Axes>
std::vector<ArcEpoch<Axes>> with_changing_motion(std::vector<ArcEpoch<Axes>> arc) {
    constexpr double factors[] = {1.0, 6.0, 0.3, 2.5};
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k].jerk_factor = factors[k / 7 % 4];
    return arc;
}

/// The same measurements at equal steps of 0.1 s: only the motion tells one step from another.
template <int Axes>
std::vector<ArcEpoch<Axes>> at_equal_steps(std::vector<ArcEpoch<Axes>> arc) {
    for (std::size_t k = 0; k < arc.size(); ++k)
        arc[k].time_s = 2.0 + 0.1 * static_cast<double>(k);
    return arc;
}

/// The step between two epochs, to the nanosecond.
template <int Axes>
double step_s(const ArcEpoch<Axes>& from, const ArcEpoch<Axes>& to) {
    return static_cast<double>(std::llround((to.time_s - from.time_s) * 1e9)) * 1e-9;
}

/// The step as a model has it whose jerk density is that of the step.
template <int Axes>
AxisStep step_between(EstimationModel model, const ArcEpoch<Axes>& from, const ArcEpoch<Axes>& to) {
    model.motion.jerk_density *= to.jerk_factor;
    return axis_step(model, step_s(from, to));
}

/// The smoothed states of all epochs.
template <int Axes>
std::vector<StateEstimate<Axes>> states_of(const Chain<Axes>& chain) {
    std::vector<StateEstimate<Axes>> states;
    for (std::size_t k = 0; k < chain.size(); ++k)
        states.push_back(chain.state(k));
    return states;
}

/// The estimation problem of an arc as one dense weighted least squares: an independent way to its
/// states and to their whole covariance.
struct DenseSolution {
    Eigen::VectorXd states;
    Eigen::MatrixXd covariance;
    double minimum = 0.0;
};

template <int Axes>
DenseSolution solve_dense(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model) {
    constexpr int n = state_size<Axes>;
    const auto size = static_cast<Eigen::Index>(arc.size()) * n;
    QuadMatrix normal = QuadMatrix::Zero(size, size);
    QuadVector right = QuadVector::Zero(size);
    Quad constant = 0;
    const auto prior = KalmanFilter<Axes>(model).prior(arc[0].measurement->position);
    const QuadMatrix prior_weight = prior.covariance.template cast<Quad>().inverse();
    const QuadVector prior_mean = prior.mean.template cast<Quad>();
    normal.topLeftCorner(n, n) += prior_weight;
    right.head(n) += prior_weight * prior_mean;
    constant += prior_mean.dot(prior_weight * prior_mean);
    QuadMatrix design = QuadMatrix::Zero(Axes, n);
    design.leftCols(Axes).setIdentity();
    design.rightCols(Axes).setIdentity();
    const Quad scale = Quad(model.measurement_scale) * model.measurement_scale;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k) * n;
        if (arc[k].measurement) {
            const QuadMatrix weight =
                (scale * arc[k].measurement->covariance.template cast<Quad>()).inverse();
            const QuadVector z = arc[k].measurement->position.template cast<Quad>();
            normal.block(at, at, n, n) += design.transpose() * weight * design;
            right.segment(at, n) += design.transpose() * (weight * z);
            constant += z.dot(weight * z);
        }
        if (k == 0) continue;
        const AxisStep step = step_between(model, arc[k - 1], arc[k]);
        QuadMatrix row(n, 2 * n);
        row << (-transition<Axes>(step)).template cast<Quad>(), QuadMatrix::Identity(n, n);
        const QuadMatrix noise = process_noise<Axes>(step).template cast<Quad>();
        const QuadMatrix weight = (noise + noise.transpose()).inverse() * Quad(2);  // symmetric
        normal.block(at - n, at - n, 2 * n, 2 * n) += row.transpose() * weight * row;
    }
    const Eigen::LLT<QuadMatrix> factor(normal);
    const QuadVector states = factor.solve(right);
    const QuadMatrix covariance = factor.solve(QuadMatrix::Identity(size, size));
    return {.states = states.cast<double>(),
            .covariance = covariance.cast<double>(),
            .minimum = static_cast<double>(Quad(constant - right.dot(states)))};
}

/// True states drawn from a model, and what would be measured of them.
template <int Axes>
struct SimulatedArc {
    std::vector<StateVector<Axes>> truth;
    std::vector<ArcEpoch<Axes>> arc;
};

/// White noise has `stated_sigma_m` times the model's measurement scale.
template <int Axes>
SimulatedArc<Axes> simulate_arc(const EstimationModel& model, std::size_t epochs, double dt_s,
                                double stated_sigma_m, RandomGenerator& random) {
    const AxisStep step = axis_step(model, dt_s);
    const Eigen::Matrix3d factor = step.process_noise.llt().matrixL();
    SimulatedArc<Axes> run;
    StateVector<Axes> state = StateVector<Axes>::Zero();
    for (int axis = 0; axis < Axes; ++axis) {
        state(Axes + axis) = 30.0 - 10.0 * axis;
        state(3 * Axes + axis) = model.error.initial_sigma_m * random.normal();
    }
    for (std::size_t k = 0; k < epochs; ++k) {
        PositionMeasurement<Axes> measurement;
        measurement.covariance *= stated_sigma_m * stated_sigma_m;
        if (k > 0) state = transition<Axes>(step) * state;
        for (int axis = 0; axis < Axes; ++axis) {
            if (k > 0) {
                const Eigen::Vector3d noise =
                    factor * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
                for (int block = 0; block < 3; ++block)
                    state(block * Axes + axis) += noise(block);
                state(3 * Axes + axis) += std::sqrt(step.error_noise) * random.normal();
            }
            measurement.position(axis) = state(axis) + state(3 * Axes + axis) +
                                         model.measurement_scale * stated_sigma_m * random.normal();
        }
        run.truth.push_back(state);
        run.arc.push_back({.time_s = dt_s * static_cast<double>(k), .measurement = measurement});
    }
    return run;
}

}  // namespace runcert::test
