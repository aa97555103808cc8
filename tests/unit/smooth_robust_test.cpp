#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/random.h"
#include "motion/chain.h"
#include "motion_test_support.h"
#include "smooth_test_support.h"
#include "stages/smooth/batch_problem.h"
#include "stages/smooth/robust.h"

// The robust solution along the chain of states against the general program for sparse problems
// (Ceres), as which it is stated in its plainest form.

namespace runcert::RUNCERT_FILE {
namespace {

using test::given_sigma_m;
using test::models;
using test::NamedModel;
using test::solve_robust_whole;

constexpr double scale = 2.0;

/// A run drawn from the model some kilometres from the origin; measurements that are missing, one
/// in fifty that is an outlier, and a long gap.
template <int Axes>
std::vector<ArcEpoch<Axes>> draw_arc(const EstimationModel& model, double rate_hz,
                                     std::uint64_t seed) {
    RandomGenerator random(seed);
    auto arc = test::simulate_arc<Axes>(model, 500, 1.0 / rate_hz, given_sigma_m, random).arc;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].measurement->position.array() += 3000.0;
        if (random.uniform() < 0.02) arc[k].measurement->position(0) += 20.0 * given_sigma_m;
        if (k > 0 && (random.uniform() < 0.05 || (k > 350 && k < 380))) arc[k].measurement.reset();
    }
    return arc;
}

template <int Axes>
std::vector<StateVector<Axes>> smoothed_states(const std::vector<ArcEpoch<Axes>>& arc,
                                               const EstimationModel& model) {
    const Chain<Axes> chain(arc, model);
    std::vector<StateVector<Axes>> states;
    for (std::size_t k = 0; k < chain.size(); ++k)
        states.push_back(chain.mean(k));
    return states;
}

/// By Ceres, begun again at where it ended: its last step within the tolerance is not taken, and
/// what the cost still changes by is found about a nearer reference.
template <int Axes>
std::vector<StateVector<Axes>> solved_by_ceres(const std::vector<ArcEpoch<Axes>>& arc,
                                               const EstimationModel& model,
                                               std::vector<StateVector<Axes>> states) {
    for (int times = 0; times < 3; ++times) {
        BatchProblem<Axes> plain(arc, model, states, scale);
        EXPECT_TRUE(plain.solve(500, times == 0 ? 1e-12 : 1e-18).usable);
        states = plain.states();
    }
    return states;
}

template <int Axes>
std::vector<StateVector<Axes>> solved_by_chain(const std::vector<ArcEpoch<Axes>>& arc,
                                               const EstimationModel& model,
                                               const std::vector<StateVector<Axes>>& states) {
    const auto solution = solve_robust_whole<Axes>(arc, model, scale, states, 100);
    EXPECT_TRUE(solution.converged);
    return solution.states;
}

/// The largest difference of each of positions, velocities, accelerations and errors.
template <int Axes>
Eigen::Vector4d largest_difference(const std::vector<StateVector<Axes>>& a,
                                   const std::vector<StateVector<Axes>>& b) {
    Eigen::Vector4d largest = Eigen::Vector4d::Zero();
    for (std::size_t k = 0; k < a.size(); ++k)
        for (int block = 0; block < 4; ++block)
            largest(block) =
                std::max(largest(block),
                         (a[k] - b[k]).template segment<Axes>(block * Axes).cwiseAbs().maxCoeff());
    return largest;
}

template <int Axes>
void expect_the_same(const std::vector<ArcEpoch<Axes>>& arc, const NamedModel& one) {
    const auto start = smoothed_states<Axes>(arc, one.model);
    const Eigen::Vector4d difference = largest_difference<Axes>(
        solved_by_chain<Axes>(arc, one.model, start), solved_by_ceres<Axes>(arc, one.model, start));
    // As far as Ceres gets before rounding hides what the cost still changes by, which depends on
    // the compiler. The chain ends at 1e-5 standard deviations, and accelerations have up to 1
    // m/s^2.
    EXPECT_LT(difference(0), 1e-6) << one.name;
    EXPECT_LT(difference(1), 1e-6) << one.name;
    EXPECT_LT(difference(2), 1e-5) << one.name;
    EXPECT_LT(difference(3), 1e-6) << one.name;
}

template <int Axes>
void expect_the_same_at(double rate_hz) {
    for (const NamedModel& one : models())
        expect_the_same<Axes>(draw_arc<Axes>(one.model, rate_hz, 41), one);
}

TEST(Robust, IsCeresSolutionOnALine) {
    expect_the_same_at<1>(10.0);
    expect_the_same_at<1>(20.0);
}
TEST(Robust, IsCeresSolutionInThePlane) {
    expect_the_same_at<2>(20.0);
}

TEST(Robust, IsCeresSolutionAtIrregularTimes) {
    RandomGenerator random(5);
    for (const NamedModel& one : models()) {
        auto arc = draw_arc<2>(one.model, 10.0, 43);
        for (auto& epoch : arc)
            epoch.time_s = std::round((epoch.time_s + 0.0001 * random.uniform()) * 1e9) * 1e-9;
        expect_the_same<2>(arc, one);
    }
}

TEST(Robust, IsCeresSolutionWhereTheMotionChanges) {
    for (const NamedModel& one : models()) {
        auto arc = draw_arc<2>(one.model, 20.0, 45);
        test::change_motion(arc);
        expect_the_same<2>(arc, one);
    }
}

TEST(Robust, OfAFewEpochsIsCeresSolution) {
    for (const NamedModel& one : models())
        for (const std::size_t epochs : {1U, 2U, 3U, 5U}) {
            auto arc = draw_arc<2>(one.model, 10.0, 47);
            arc.resize(epochs);
            const auto start = smoothed_states<2>(arc, one.model);
            const Eigen::Vector4d difference =
                largest_difference<2>(solved_by_chain<2>(arc, one.model, start),
                                      solved_by_ceres<2>(arc, one.model, start));
            EXPECT_LT(difference(0), 1e-8) << one.name << " " << epochs;
        }
}

TEST(Robust, StaysAtItsSolution) {
    for (const NamedModel& one : models()) {
        const auto arc = draw_arc<2>(one.model, 20.0, 59);
        const auto solved = solved_by_chain<2>(arc, one.model, smoothed_states<2>(arc, one.model));
        const Eigen::Vector4d difference =
            largest_difference<2>(solved_by_chain<2>(arc, one.model, solved), solved);
        EXPECT_LT(difference(0), 1e-8) << one.name;
        EXPECT_LT(difference(1), 1e-7) << one.name;
    }
}

TEST(Robust, DoesNotEndBeforeItsSolution) {
    const NamedModel one = models().front();
    const auto arc = draw_arc<2>(one.model, 10.0, 53);
    const auto start = smoothed_states<2>(arc, one.model);
    EXPECT_FALSE(solve_robust_whole<2>(arc, one.model, scale, start, 2).converged);
    const auto solution = solve_robust_whole<2>(arc, one.model, scale, start);
    EXPECT_TRUE(solution.converged);
    EXPECT_GT(solution.passes, 4);
}

/// Standing and running with hardly any noise for what is stated, written to a centimetre, with
/// outliers of many metres.
std::vector<ArcEpoch<2>> coarse_arc(std::size_t epochs, double interval_s, double sigma_m) {
    RandomGenerator random(61);
    std::vector<ArcEpoch<2>> arc(epochs);
    double east_m = 0.0;
    for (std::size_t k = 0; k < epochs; ++k) {
        arc[k].time_s = static_cast<double>(k) * interval_s;
        if (k % 600 > 400) east_m += 10.0 * interval_s;
        Eigen::Vector2d position(std::round(100.0 * east_m) / 100.0, 0.0);
        if (random.uniform() < 0.03) position(0) += 100.0 * (random.uniform() - 0.5);
        arc[k].measurement = {position, sigma_m * sigma_m * Eigen::Matrix2d::Identity()};
    }
    return arc;
}

TEST(Robust, EndsWhereThereIsHardlyAnyNoise) {
    for (const NamedModel& one : models())
        for (const double sigma_m : {0.001, 0.1, 5.0})
            for (const double interval_s : {0.1, 1.0}) {
                const auto arc = coarse_arc(3000, interval_s, sigma_m);
                EXPECT_TRUE(
                    solve_robust_whole<2>(arc, one.model, scale, smoothed_states<2>(arc, one.model))
                        .converged)
                    << one.name << " " << sigma_m << " " << interval_s;
            }
}

TEST(Robust, TakesTensOfStepsWhereNewtonsCurvatureCannotBeTaken) {
    // A recording that was smoothed before it was written, with motion that its noise says nothing
    // of: many measurements stand far out of so little noise, each where little else is known.
    RandomGenerator random(67);
    const EstimationModel model{.motion = {.jerk_density = 6.0, .acceleration_time_s = 1.0},
                                .measurement_scale = 0.0026,
                                .error = GaussMarkovError::steady(0.09, 7.0)};
    std::vector<ArcEpoch<2>> arc(2600);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const double t = 0.04 * static_cast<double>(k);
        arc[k].time_s = t;
        Eigen::Vector2d position(200.0 * std::sin(0.05 * t), 100.0 * std::cos(0.1 * t));
        position += 0.002 * Eigen::Vector2d(random.normal(), random.normal());
        if (k % 300 > 200) position += 0.03 * Eigen::Vector2d(random.normal(), random.normal());
        arc[k].measurement = {position, Eigen::Matrix2d::Identity()};
    }
    const auto solution = solve_robust_whole<2>(arc, model, scale, smoothed_states<2>(arc, model));
    EXPECT_TRUE(solution.converged);
    EXPECT_LT(solution.passes, 120);
}

TEST(Robust, IsCeresSolutionWithCorrelatedAxesOfUnlikeAccuracy) {
    Eigen::Matrix2d covariance;
    covariance << 4.0, -1.5, -1.5, 1.0;
    for (const NamedModel& one : models()) {
        auto arc = draw_arc<2>(one.model, 20.0, 71);
        for (auto& epoch : arc)
            if (epoch.measurement)
                epoch.measurement->covariance = given_sigma_m * given_sigma_m * covariance;
        expect_the_same<2>(arc, one);
    }
}

TEST(Robust, StaysWithTheGoodHalfWhereTheOtherIsAKilometreOff) {
    for (const NamedModel& one : models()) {
        const auto good = draw_arc<2>(one.model, 10.0, 73);
        auto arc = good;
        for (std::size_t k = 1; k < arc.size(); k += 2)
            if (arc[k].measurement) arc[k].measurement->position(0) += 1000.0;
        auto kept = good;
        for (std::size_t k = 1; k < kept.size(); k += 2)
            kept[k].measurement.reset();
        const auto start = smoothed_states<2>(kept, one.model);
        const auto without = solved_by_chain<2>(kept, one.model, start);
        const auto solution = solve_robust_whole<2>(arc, one.model, scale, start);
        ASSERT_TRUE(solution.converged) << one.name;
        // Each of them pulls by scale^2 over its distance: a millionth of the others' pull.
        EXPECT_LT(largest_difference<2>(solution.states, without)(0), 1e-3) << one.name;
        for (std::size_t k = 1; k < arc.size(); k += 2)
            EXPECT_LT(solution.weights[k].value_or(0.0), 1e-8) << one.name;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
