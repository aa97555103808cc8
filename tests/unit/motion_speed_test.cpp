#include <gtest/gtest.h>

#include <cmath>

#include "motion/speed.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::DenseSolution;
using test::sample_arc;
using test::singer_with_error;
using test::solve_dense;

/// First-order uncertainty of a function of all states by numeric derivatives and the dense
/// covariance.
template <class Function>
double dense_uncertainty(const DenseSolution& dense, const Function& function) {
    Eigen::VectorXd gradient(dense.states.size());
    for (Eigen::Index i = 0; i < gradient.size(); ++i) {
        constexpr double h = 1e-4;
        Eigen::VectorXd moved = dense.states;
        moved(i) += h;
        const double right = function(moved);
        moved(i) -= 2.0 * h;
        gradient(i) = (right - function(moved)) / (2.0 * h);
    }
    return std::sqrt(gradient.dot(dense.covariance * gradient));
}

template <int Axes>
void expect_uncertainties_of_dense() {
    constexpr Eigen::Index n = state_size<Axes>;
    constexpr std::size_t s = 1;
    constexpr std::size_t e = 8;
    const auto arc = sample_arc<Axes>(10);
    const Chain<Axes> smoothed = Chain<Axes>(arc, singer_with_error);
    const DenseSolution dense = solve_dense<Axes>(arc, singer_with_error);
    const double duration_s = arc[e].time_s - arc[s].time_s;
    const auto position = [](const Eigen::VectorXd& x, std::size_t k) {
        return Eigen::Vector2d(x.segment<2>(static_cast<Eigen::Index>(k) * n));
    };
    const auto expect = [&](const SpeedEstimate& speed, const auto& function) {
        EXPECT_NEAR(speed.speed_m_s / function(dense.states), 1.0, 1e-9);
        EXPECT_NEAR(speed.standard_uncertainty_m_s / dense_uncertainty(dense, function), 1.0, 1e-6);
    };
    expect(displacement_speed(smoothed, s, e, duration_s), [&](const Eigen::VectorXd& x) {
        return (position(x, e) - position(x, s)).norm() / duration_s;
    });
    expect(path_speed(smoothed, s, e, duration_s), [&](const Eigen::VectorXd& x) {
        double length_m = 0.0;
        for (std::size_t k = s; k < e; ++k)
            length_m += (position(x, k + 1) - position(x, k)).norm();
        return length_m / duration_s;
    });
    expect(mean_speed(smoothed, s, e), [&](const Eigen::VectorXd& x) {
        double sum_m_s = 0.0;
        for (std::size_t k = s; k <= e; ++k)
            sum_m_s += x.segment<2>(static_cast<Eigen::Index>(k) * n + Axes).norm();
        return sum_m_s / static_cast<double>(e - s + 1);
    });
}

TEST(Speed, UncertaintiesAreThoseOfTheDenseSolution) {
    expect_uncertainties_of_dense<2>();
}

TEST(Speed, DisplacementCovarianceNeedsTheCovarianceBetweenTheEnds) {
    const auto arc = sample_arc<2>(60);
    const Chain<2> smoothed = Chain<2>(arc, singer_with_error);
    const SpeedEstimate speed =
        displacement_speed(smoothed, 20, 50, arc[50].time_s - arc[20].time_s);
    const Eigen::Vector2d direction =
        (smoothed.mean(50) - smoothed.mean(20)).head<2>().normalized();
    const double apart = std::sqrt(direction.dot(
        (smoothed.state(20).covariance + smoothed.state(50).covariance).topLeftCorner<2, 2>() *
        direction));
    EXPECT_GT(
        std::abs(apart / (arc[50].time_s - arc[20].time_s) / speed.standard_uncertainty_m_s - 1.0),
        1e-3);
}

TEST(Speed, ThreeFiguresAgreeOnAStraightRun) {
    // On a straight line at constant speed path and displacement are one; over one step as well.
    std::vector<ArcEpoch<2>> arc(40);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].time_s = 0.1 * static_cast<double>(k);
        arc[k].measurement =
            PositionMeasurement<2>{.position = arc[k].time_s * Eigen::Vector2d(30.0, 40.0),
                                   .covariance = 1e-4 * Eigen::Matrix2d::Identity()};
    }
    const Chain<2> smoothed = Chain<2>(arc, singer_with_error);
    const SpeedEstimate path = path_speed(smoothed, 5, 35, 3.0);
    const SpeedEstimate displacement = displacement_speed(smoothed, 5, 35, 3.0);
    EXPECT_NEAR(path.speed_m_s, 50.0, 1e-6);
    EXPECT_NEAR(path.speed_m_s, displacement.speed_m_s, 1e-9);
    EXPECT_NEAR(path.standard_uncertainty_m_s / displacement.standard_uncertainty_m_s, 1.0, 1e-6);
    EXPECT_NEAR(mean_speed(smoothed, 5, 35).speed_m_s, 50.0, 1e-6);
    const SpeedEstimate one = mean_speed(smoothed, 20, 20);
    const SpeedEstimate same = horizontal_speed(smoothed.mean(20).segment<2>(2),
                                                smoothed.state(20).covariance.block<2, 2>(2, 2));
    EXPECT_NEAR(one.speed_m_s, same.speed_m_s, 1e-12);
    EXPECT_NEAR(one.standard_uncertainty_m_s, same.standard_uncertainty_m_s, 1e-12);
}

/// Mean square of error over stated uncertainty of the three figures, over runs of 5 s at 10 Hz
/// drawn from the very model; windows of 3 s.
Eigen::Array3d mean_square_of_normalised_errors(const EstimationModel& model, int runs) {
    RandomGenerator random(11);
    constexpr std::size_t s = 10;
    constexpr std::size_t e = 40;
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (int run = 0; run < runs; ++run) {
        const auto [truth, arc] = test::simulate_arc<2>(model, 51, 0.1, 0.003, random);
        const Chain<2> smoothed = Chain<2>(arc, model);
        double length_m = 0.0;
        double speeds_m_s = 0.0;
        for (std::size_t k = s; k <= e; ++k) {
            if (k < e) length_m += (truth[k + 1] - truth[k]).head<2>().norm();
            speeds_m_s += truth[k].segment<2>(2).norm();
        }
        const Eigen::Array3d expected((truth[e] - truth[s]).head<2>().norm() / 3.0, length_m / 3.0,
                                      speeds_m_s / 31.0);
        const SpeedEstimate found[] = {displacement_speed(smoothed, s, e, 3.0),
                                       path_speed(smoothed, s, e, 3.0), mean_speed(smoothed, s, e)};
        for (int i = 0; i < 3; ++i)
            sum(i) +=
                std::pow((found[i].speed_m_s - expected(i)) / found[i].standard_uncertainty_m_s, 2);
    }
    return sum / runs;
}

TEST(Speed, UncertaintiesHoldUnderTheModel) {
    // The standard deviation of 2000 normalised errors has a relative standard error of
    // 1 / sqrt(2 * 2000) = 0.016: three of them.
    constexpr int runs = 2000;
    const double limit = 3.0 / std::sqrt(2.0 * runs);
    EstimationModel white;
    white.motion.jerk_density = 0.6;
    for (const EstimationModel& model : {white, singer_with_error}) {
        const Eigen::Array3d ratio = mean_square_of_normalised_errors(model, runs).sqrt();
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(ratio(i), 1.0, limit) << i;
    }
}

TEST(Speed, IgnoringTheCorrelatedErrorWouldShow) {
    // The same check tells a model that leaves the error out.
    RandomGenerator random(11);
    EstimationModel blind = singer_with_error;
    blind.error = GaussMarkovError::steady(0.0, 1.0);
    double sum = 0.0;
    constexpr int runs = 300;
    for (int run = 0; run < runs; ++run) {
        const auto [truth, arc] = test::simulate_arc<2>(singer_with_error, 51, 0.1, 0.003, random);
        const SpeedEstimate speed = displacement_speed(Chain<2>(arc, blind), 10, 40, 3.0);
        sum += std::pow((speed.speed_m_s - (truth[40] - truth[10]).head<2>().norm() / 3.0) /
                            speed.standard_uncertainty_m_s,
                        2);
    }
    EXPECT_GT(std::sqrt(sum / runs), 2.0);
}

TEST(HorizontalSpeed, UncertaintyByNumericDerivatives) {
    const Eigen::Vector2d velocity(3.0, -4.0);
    Eigen::Matrix2d covariance;
    covariance << 0.04, 0.01, 0.01, 0.09;
    const SpeedEstimate speed = horizontal_speed(velocity, covariance);
    EXPECT_DOUBLE_EQ(speed.speed_m_s, 5.0);
    Eigen::Vector2d gradient;
    for (int i = 0; i < 2; ++i) {
        Eigen::Vector2d step = Eigen::Vector2d::Zero();
        step(i) = 1e-6;
        gradient(i) = ((velocity + step).norm() - (velocity - step).norm()) / 2e-6;
    }
    EXPECT_NEAR(speed.standard_uncertainty_m_s, std::sqrt(gradient.dot(covariance * gradient)),
                1e-9);
    EXPECT_NEAR(horizontal_speed(Eigen::Vector2d::Zero(), Eigen::Vector2d(0.04, 0.09).asDiagonal())
                    .standard_uncertainty_m_s,
                0.3, 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
