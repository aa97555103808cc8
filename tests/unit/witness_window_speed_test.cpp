#include <gtest/gtest.h>

#include <cmath>

#include "motion_test_support.h"
#include "witness/window_speed.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::DenseSolution;
using test::sample_arc;
using test::singer_with_error;
using test::solve_dense;

constexpr auto by_displacement = SpeedDefinition::displacement;
constexpr auto by_path = SpeedDefinition::path_length;
constexpr auto by_mean = SpeedDefinition::mean_n_plus_1;

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
    expect(smoothed_speed(smoothed, {s, e}, duration_s, {by_displacement}),
           [&](const Eigen::VectorXd& x) {
               return (position(x, e) - position(x, s)).norm() / duration_s;
           });
    expect(smoothed_speed(smoothed, {s, e}, duration_s, {by_path}), [&](const Eigen::VectorXd& x) {
        double length_m = 0.0;
        for (std::size_t k = s; k < e; ++k)
            length_m += (position(x, k + 1) - position(x, k)).norm();
        return length_m / duration_s;
    });
    expect(smoothed_speed(smoothed, {s, e}, duration_s, {by_mean}), [&](const Eigen::VectorXd& x) {
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
        smoothed_speed(smoothed, {20, 50}, arc[50].time_s - arc[20].time_s, {by_displacement});
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
    const SpeedEstimate path = smoothed_speed(smoothed, {5, 35}, 3.0, {by_path});
    const SpeedEstimate displacement = smoothed_speed(smoothed, {5, 35}, 3.0, {by_displacement});
    EXPECT_NEAR(path.speed_m_s, 50.0, 1e-6);
    EXPECT_NEAR(path.speed_m_s, displacement.speed_m_s, 1e-9);
    EXPECT_NEAR(path.standard_uncertainty_m_s / displacement.standard_uncertainty_m_s, 1.0, 1e-6);
    EXPECT_NEAR(smoothed_speed(smoothed, {5, 35}, 3.0, {by_mean}).speed_m_s, 50.0, 1e-6);
    const SpeedEstimate one = smoothed_speed(smoothed, {20, 20}, 3.0, {by_mean});
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
        const SpeedEstimate found[] = {smoothed_speed(smoothed, {s, e}, 3.0, {by_displacement}),
                                       smoothed_speed(smoothed, {s, e}, 3.0, {by_path}),
                                       smoothed_speed(smoothed, {s, e}, 3.0, {by_mean})};
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
        const SpeedEstimate speed =
            smoothed_speed(Chain<2>(arc, blind), {10, 40}, 3.0, {by_displacement});
        sum += std::pow((speed.speed_m_s - (truth[40] - truth[10]).head<2>().norm() / 3.0) /
                            speed.standard_uncertainty_m_s,
                        2);
    }
    EXPECT_GT(std::sqrt(sum / runs), 2.0);
}

/// Positions and velocities of two axes, with the speed over samples 1 to 6 as a function of them.
struct TwoAxes {
    std::vector<Eigen::Vector2d> positions, velocities;

    TwoAxes() {
        RandomGenerator random(4);
        for (int k = 0; k < 8; ++k) {
            positions.emplace_back(5.0 * k + random.normal(), random.normal());
            velocities.emplace_back(5.0 + random.normal(), random.normal());
        }
    }
    template <class... Derivatives>
    double speed(const SpeedQuantity& quantity, const Derivatives&... derivatives) const {
        return speed_of(SpeedTrack{[this](std::size_t k) { return positions[k]; },
                                   [this](std::size_t k) { return velocities[k]; }},
                        {1, 6}, 2.5, quantity, derivatives...);
    }
};

TEST(WindowSpeed, DerivativesAreThoseOfTheSpeed) {
    for (const SpeedDefinition definition :
         {by_displacement, by_path, by_mean, SpeedDefinition::mean_n}) {
        SCOPED_TRACE(to_text(definition));
        TwoAxes track;
        std::vector<Eigen::Vector2d> by_position(8, Eigen::Vector2d::Zero());
        std::vector<Eigen::Vector2d> by_velocity = by_position;
        const auto add_to = [](std::vector<Eigen::Vector2d>& sums) {
            return [&sums](std::size_t k, const Eigen::Vector2d& one) { sums[k] += one; };
        };
        const SpeedQuantity quantity{.definition = definition};
        EXPECT_EQ(track.speed(quantity, add_to(by_position), add_to(by_velocity)),
                  track.speed(quantity));
        constexpr double h = 1e-6;
        const auto derivative = [&](double& value) {
            const double at = value;
            value = at + h;
            const double right = track.speed(quantity);
            value = at - h;
            const double left = track.speed(quantity);
            value = at;
            return (right - left) / (2.0 * h);
        };
        for (std::size_t k = 0; k < 8; ++k)
            for (int axis = 0; axis < 2; ++axis) {
                EXPECT_NEAR(by_position[k](axis), derivative(track.positions[k](axis)), 1e-8);
                EXPECT_NEAR(by_velocity[k](axis), derivative(track.velocities[k](axis)), 1e-8);
            }
    }
}

TEST(WindowSpeed, OverACourseChangesWithTheInstantsOfItsCrossings) {
    const TwoAxes track;
    SpeedQuantity course{.definition = SpeedDefinition::elapsed_time, .length_m = 25.0};
    course.start_normal = Eigen::Vector2d(0.8, 0.6);
    course.finish_normal = Eigen::Vector2d::UnitX();
    Eigen::Vector2d at_start, at_finish;
    const double speed_m_s =
        track.speed(course, [&](std::size_t k, const Eigen::Vector2d& derivative) {
            (k == 1 ? at_start : at_finish) = derivative;
        });
    EXPECT_DOUBLE_EQ(speed_m_s, 10.0);
    // Where the track lies further along by 1 mm, it crosses earlier by that over its speed.
    const auto after = [&](double start_m, double finish_m) {
        return 25.0 / (2.5 + start_m / course.start_normal.dot(track.velocities[1]) -
                       finish_m / course.finish_normal.dot(track.velocities[6]));
    };
    EXPECT_NEAR(at_start.dot(course.start_normal), (after(1e-3, 0.0) - 10.0) / 1e-3, 2e-3);
    EXPECT_NEAR(at_finish.dot(course.finish_normal), (after(0.0, 1e-3) - 10.0) / 1e-3, 2e-3);
    EXPECT_NEAR(at_start.dot(Eigen::Vector2d(-0.6, 0.8)), 0.0, 1e-12);
}

TEST(WindowSpeed, OfAStandIsAsUnsureAsItsLeastCertainDirection) {
    std::vector<ArcEpoch<2>> arc(20);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].time_s = 0.1 * static_cast<double>(k);
        arc[k].measurement =
            PositionMeasurement<2>{.position = Eigen::Vector2d::Zero(),
                                   .covariance = Eigen::Vector2d(1e-4, 9e-4).asDiagonal()};
    }
    const Chain<2> smoothed(arc, singer_with_error);
    const SpeedEstimate speed = smoothed_speed(smoothed, {5, 15}, 1.0, {});
    EXPECT_EQ(speed.speed_m_s, 0.0);
    EXPECT_NEAR(speed.standard_uncertainty_m_s,
                std::sqrt(displacement_covariance(smoothed, 5, 15)(1, 1)), 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
