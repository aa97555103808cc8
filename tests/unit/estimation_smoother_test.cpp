#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "core/random.h"
#include "estimation/smoother.h"
#include "estimation/speed.h"

namespace runcert {
namespace {

const MotionModel model{.jerk_density = 0.6};

/// An arc with irregular steps, correlated measurement errors and one epoch without a measurement.
template <int Axes>
std::vector<ArcEpoch<Axes>> sample_arc(std::size_t epochs) {
    RandomGenerator random(7);
    std::vector<ArcEpoch<Axes>> arc(epochs);
    double time_s = 2.0;
    for (std::size_t k = 0; k < epochs; ++k) {
        arc[k].time_s = time_s;
        PositionMeasurement<Axes> measurement;
        PositionMatrix<Axes> factor = PositionMatrix<Axes>::Identity() * 0.01;
        factor(1, 0) = 0.006;
        measurement.covariance = factor * factor.transpose();
        for (int axis = 0; axis < Axes; ++axis)
            measurement.position(axis) =
                50.0 + 11.0 * time_s + axis * time_s * time_s + 0.01 * random.normal();
        if (k != 4) arc[k].measurement = measurement;
        time_s += 0.08 + 0.04 * random.uniform();
    }
    return arc;
}

/// The same problem as one dense weighted least squares: an independent way to states and to their
/// whole covariance.
template <int Axes>
struct DenseSolution {
    Eigen::VectorXd states;
    Eigen::MatrixXd covariance;
    double minimum = 0.0;
};

template <int Axes>
DenseSolution<Axes> solve_dense(const std::vector<ArcEpoch<Axes>>& arc) {
    constexpr int n = state_size<Axes>;
    const auto size = static_cast<Eigen::Index>(arc.size()) * n;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    double constant = 0.0;
    const auto prior = vague_prior<Axes>(arc[0].measurement->position);
    normal.topLeftCorner(n, n) += prior.covariance.inverse();
    right.head(n) += prior.covariance.inverse() * prior.mean;
    constant += prior.mean.dot(prior.covariance.inverse() * prior.mean);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k) * n;
        if (arc[k].measurement) {
            const PositionMatrix<Axes> weight = arc[k].measurement->covariance.inverse();
            const PositionVector<Axes>& z = arc[k].measurement->position;
            normal.block(at, at, Axes, Axes) += weight;
            right.segment(at, Axes) += weight * z;
            constant += z.dot(weight * z);
        }
        if (k == 0) continue;
        const double dt_s = arc[k].time_s - arc[k - 1].time_s;
        Eigen::MatrixXd row = Eigen::MatrixXd::Zero(n, size);
        row.block(0, at, n, n).setIdentity();
        row.block(0, at - n, n, n) = -transition<Axes>(dt_s);
        normal += row.transpose() * process_noise<Axes>(model, dt_s).inverse() * row;
    }
    DenseSolution<Axes> solution;
    solution.covariance = normal.inverse();
    solution.states = normal.ldlt().solve(right);
    solution.minimum = constant - right.dot(solution.states);
    return solution;
}

template <int Axes>
void expect_equal_to_dense() {
    constexpr int n = state_size<Axes>;
    const auto arc = sample_arc<Axes>(12);
    const SmoothedArc<Axes> smoothed = smooth<Axes>(arc, model);
    const DenseSolution<Axes> dense = solve_dense<Axes>(arc);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k) * n;
        const StateVector<Axes> difference = smoothed.states[k].mean - dense.states.segment(at, n);
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-5) << k;
        EXPECT_TRUE(
            smoothed.states[k].covariance.isApprox(dense.covariance.block(at, at, n, n), 1e-5))
            << k;
    }
    // Joint covariance of two states, across the missing measurement.
    const auto s = 2;
    const auto e = 9;
    EXPECT_TRUE(
        smoothed.cross_covariance(s, e).isApprox(dense.covariance.block(s * n, e * n, n, n), 1e-5));
    EXPECT_EQ(smoothed.measurements, 11);
}

TEST(Smoother, EqualsDenseLeastSquaresInThePlane) {
    expect_equal_to_dense<2>();
}
TEST(Smoother, EqualsDenseLeastSquaresInSpace) {
    expect_equal_to_dense<3>();
}

TEST(Smoother, SumOfInnovationStatisticsIsTheMinimumOfLeastSquares) {
    auto arc = sample_arc<2>(12);
    // Near the origin, so that the dense minimum is not lost in its large terms.
    for (auto& epoch : arc)
        if (epoch.measurement) epoch.measurement->position.array() -= 50.0 + 11.0 * epoch.time_s;
    const SmoothedArc<2> smoothed = smooth<2>(arc, model);
    EXPECT_NEAR(smoothed.innovation_sum / solve_dense<2>(arc).minimum, 1.0, 1e-5);
}

TEST(Smoother, DisplacementUncertaintyIsThatOfTheDenseSolution) {
    const auto arc = sample_arc<3>(12);
    const SmoothedArc<3> smoothed = smooth<3>(arc, model);
    const DenseSolution<3> dense = solve_dense<3>(arc);
    const double duration_s = arc[10].time_s - arc[1].time_s;
    const SpeedEstimate speed = displacement_speed(smoothed, 1, 10, duration_s);
    Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(2, dense.states.size());
    difference.block<2, 2>(0, 90).setIdentity();
    difference.block<2, 2>(0, 9) = -Eigen::Matrix2d::Identity();
    const Eigen::Vector2d displacement = difference * dense.states;
    const Eigen::Vector2d direction = displacement.normalized();
    const double variance =
        direction.dot(difference * dense.covariance * difference.transpose() * direction);
    EXPECT_NEAR(speed.speed_mps, displacement.norm() / duration_s, 1e-6);
    EXPECT_NEAR(speed.standard_uncertainty_mps, std::sqrt(variance) / duration_s, 1e-8);
    // Without the covariance between the ends it would be another figure.
    const double apart = std::sqrt(direction.dot(
        (smoothed.states[1].covariance + smoothed.states[10].covariance).topLeftCorner<2, 2>() *
        direction));
    EXPECT_GT(std::abs(apart / duration_s - speed.standard_uncertainty_mps), 1e-7);
}

TEST(Smoother, DisplacementUncertaintyHoldsUnderTheModel) {
    // Monte Carlo: runs drawn from the very model, 3 mm noise at 10 Hz, a 3 s displacement.
    RandomGenerator random(11);
    constexpr int runs = 2000;
    constexpr std::size_t epochs = 51;
    constexpr double dt_s = 0.1;
    const Eigen::Matrix3d noise_factor = axis_process_noise(model, dt_s).llt().matrixL();
    double sum = 0.0;
    for (int run = 0; run < runs; ++run) {
        Eigen::Matrix<double, 3, 2> state;
        state << 0.0, 0.0, 30.0, 20.0, 0.0, 0.0;
        std::vector<ArcEpoch<2>> arc(epochs);
        std::vector<Eigen::Vector2d> truth;
        for (std::size_t k = 0; k < epochs; ++k) {
            if (k > 0)
                for (int axis = 0; axis < 2; ++axis)
                    state.col(axis) =
                        axis_transition(dt_s) * state.col(axis) +
                        noise_factor *
                            Eigen::Vector3d(random.normal(), random.normal(), random.normal());
            truth.emplace_back(state.row(0).transpose());
            arc[k].time_s = dt_s * static_cast<double>(k);
            arc[k].measurement = PositionMeasurement<2>{
                .position =
                    truth.back() + 0.003 * Eigen::Vector2d(random.normal(), random.normal()),
                .covariance = 9e-6 * Eigen::Matrix2d::Identity()};
        }
        const SpeedEstimate speed = displacement_speed(smooth<2>(arc, model), 10, 40, 3.0);
        const double error = speed.speed_mps - (truth[40] - truth[10]).norm() / 3.0;
        sum += std::pow(error / speed.standard_uncertainty_mps, 2);
    }
    // The mean of 2000 squares of standard normal deviates has a standard deviation of 0.032.
    EXPECT_NEAR(sum / runs, 1.0, 0.1);
}

TEST(HorizontalSpeed, UncertaintyByNumericDerivatives) {
    const Eigen::Vector2d velocity(3.0, -4.0);
    Eigen::Matrix2d covariance;
    covariance << 0.04, 0.01, 0.01, 0.09;
    const SpeedEstimate speed = horizontal_speed(velocity, covariance);
    EXPECT_DOUBLE_EQ(speed.speed_mps, 5.0);
    Eigen::Vector2d gradient;
    for (int i = 0; i < 2; ++i) {
        Eigen::Vector2d step = Eigen::Vector2d::Zero();
        step(i) = 1e-6;
        gradient(i) = ((velocity + step).norm() - (velocity - step).norm()) / 2e-6;
    }
    EXPECT_NEAR(speed.standard_uncertainty_mps, std::sqrt(gradient.dot(covariance * gradient)),
                1e-9);
    EXPECT_NEAR(horizontal_speed(Eigen::Vector2d::Zero(), Eigen::Vector2d(0.04, 0.09).asDiagonal())
                    .standard_uncertainty_mps,
                0.3, 1e-12);
}

}  // namespace
}  // namespace runcert
