#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/random.h"
#include "motion/smoother.h"
#include "motion/speed.h"
#include "motion_test_support.h"
#include "smooth_test_support.h"
#include "stages/smooth/batch.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::given_sigma_m;
using test::models;
using test::NamedModel;

/// A run drawn from the model some kilometres from the origin, one measurement in twenty missing.
template <int Axes>
std::vector<ArcEpoch<Axes>> draw_arc(const EstimationModel& model, std::size_t epochs,
                                     double rate_hz) {
    RandomGenerator random(31);
    auto arc = test::simulate_arc<Axes>(model, epochs, 1.0 / rate_hz, given_sigma_m, random).arc;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].measurement->position.array() += 3000.0;
        if (k > 0 && random.uniform() < 0.05) arc[k].measurement.reset();
    }
    return arc;
}

/// Offsets all measured positions from an epoch on, and bridges the step.
template <int Axes>
void add_step(std::vector<ArcEpoch<Axes>>& arc, std::size_t at, double offset_m) {
    arc[at].step_before = true;
    for (std::size_t k = at; k < arc.size(); ++k)
        if (arc[k].measurement) arc[k].measurement->position.array() += offset_m;
}

template <int Axes>
std::vector<StateVector<Axes>> means(const SmoothedArc<Axes>& smoothed) {
    std::vector<StateVector<Axes>> states;
    for (const StateEstimate<Axes>& state : smoothed.states)
        states.push_back(state.mean);
    return states;
}

/// The largest difference of each of positions, velocities, accelerations and errors.
template <int Axes>
Eigen::Vector4d largest_difference(const std::vector<StateVector<Axes>>& a,
                                   const std::vector<StateVector<Axes>>& b) {
    Eigen::Vector4d largest = Eigen::Vector4d::Zero();
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
        for (int block = 0; block < 4; ++block)
            largest(block) =
                std::max(largest(block),
                         (a[k] - b[k]).template segment<Axes>(block * Axes).cwiseAbs().maxCoeff());
    return largest;
}

template <int Axes>
void expect_agreement(const std::vector<ArcEpoch<Axes>>& arc, const NamedModel& one) {
    const auto smoothed = means<Axes>(smooth<Axes>(arc, one.model));
    const Eigen::Vector4d difference =
        largest_difference<Axes>(solve_batch<Axes>(arc, one.model).states, smoothed);
    EXPECT_LT(difference(0), 1e-7) << one.name;
    EXPECT_LT(difference(1), 1e-6) << one.name;
    EXPECT_LT(difference(2), 1e-5) << one.name;
    EXPECT_LT(difference(3), 1e-7) << one.name;
}

template <int Axes>
void expect_agreement_across_steps() {
    for (const double rate_hz : {1.0, 10.0, 20.0})
        for (const NamedModel& one : models()) {
            auto arc = draw_arc<Axes>(one.model, 600, rate_hz);
            add_step<Axes>(arc, 200, 0.5);
            add_step<Axes>(arc, 201, -20.0);
            add_step<Axes>(arc, 430, 0.02);
            expect_agreement<Axes>(arc, one);
        }
}

TEST(BridgedBatch, AgreesWithTheSmootherOnALine) {
    expect_agreement_across_steps<1>();
}
TEST(BridgedBatch, AgreesWithTheSmootherInThePlane) {
    expect_agreement_across_steps<2>();
}

TEST(BridgedBatch, AgreesWhereMeasurementsAreMissingAroundTheStep) {
    for (const NamedModel& one : models()) {
        auto arc = draw_arc<2>(one.model, 300, 10.0);
        add_step<2>(arc, 150, 0.5);
        for (std::size_t k = 145; k < 155; ++k)
            arc[k].measurement.reset();
        expect_agreement<2>(arc, one);
        // Two, with nothing between them to tell one offset from the other.
        add_step<2>(arc, 153, 0.3);
        expect_agreement<2>(arc, one);
        // And one that no measurement follows.
        add_step<2>(arc, 290, 0.3);
        for (std::size_t k = 290; k < 300; ++k)
            arc[k].measurement.reset();
        expect_agreement<2>(arc, one);
    }
}

TEST(BridgedBatch, StretchesAgreeWithTheWholeArc) {
    const EstimationModel model = models().front().model;
    auto arc = draw_arc<2>(model, 3'000, 20.0);
    // The second stretch begins at 600, the third at 1200; the first ends at 1000, the second at
    // 1600. Steps in what two have in common, at its end, and near the border of what is taken.
    for (const std::size_t at : {700U, 799U, 801U, 999U, 1201U, 1400U, 1599U, 2500U})
        add_step<2>(arc, at, 0.4);
    const auto whole = solve_batch<2>(arc, model).states;
    const BatchSolution<2> cut =
        solve_batch<2>(arc, model, {.epochs_at_once = 1'000, .overlap = 400});
    EXPECT_EQ(cut.stretches, 5);
    EXPECT_LT(largest_difference<2>(cut.states, whole)(0), 1e-6);
    EXPECT_LT(largest_difference<2>(cut.states, whole)(1), 1e-5);
    EXPECT_LT(largest_difference<2>(whole, means<2>(smooth<2>(arc, model)))(0), 1e-7);
}

TEST(BridgedBatch, AStretchThatEndsAfterAStepInAGapIsSolved) {
    const EstimationModel model = models().front().model;
    auto arc = draw_arc<2>(model, 2'000, 20.0);
    add_step<2>(arc, 990, 0.4);
    for (std::size_t k = 985; k < 1'005; ++k)
        arc[k].measurement.reset();
    const auto cut = solve_batch<2>(arc, model, {.epochs_at_once = 1'000, .overlap = 400}).states;
    EXPECT_LT(largest_difference<2>(cut, means<2>(smooth<2>(arc, model)))(0), 1e-6);
}

/// The largest difference between positions in units of the smoother's standard deviation.
double largest_in_sigmas(const SmoothedArc<2>& smoothed,
                         const std::vector<StateVector<2>>& states) {
    double largest = 0.0;
    for (std::size_t k = 0; k < states.size(); ++k) {
        const Eigen::Vector2d sigma =
            smoothed.states[k].covariance.diagonal().head<2>().cwiseSqrt();
        const Eigen::Vector2d difference = (states[k] - smoothed.states[k].mean).head<2>();
        largest = std::max(largest, difference.cwiseQuotient(sigma).cwiseAbs().maxCoeff());
    }
    return largest;
}

TEST(BridgedRobustBatch, IsTheLinearSolutionOfTheWeightedMeasurements) {
    for (const NamedModel& one : models()) {
        auto arc = draw_arc<2>(one.model, 600, 10.0);
        add_step<2>(arc, 300, 0.5);
        for (const std::size_t outlier : {100U, 298U, 303U, 450U})
            if (arc[outlier].measurement) arc[outlier].measurement->position(0) += 0.3;
        const auto start = means<2>(smooth<2>(arc, one.model));
        const RobustSolution<2> robust = solve_robust<2>(arc, one.model, 3.0, start);
        auto weighted = arc;
        for (std::size_t k = 0; k < arc.size(); ++k)
            if (robust.weights[k]) weighted[k].measurement->covariance /= *robust.weights[k];
        EXPECT_LT(largest_in_sigmas(smooth<2>(weighted, one.model), robust.states), 1e-3)
            << one.name;
        // Begun without the step, it comes to the same solution.
        std::vector<StateVector<2>> flat = start;
        for (std::size_t k = 300; k < flat.size(); ++k)
            flat[k].head<2>().array() -= 0.5;
        const auto again = solve_robust<2>(arc, one.model, 3.0, flat);
        EXPECT_LT(largest_difference<2>(again.states, robust.states)(0), 1e-5) << one.name;
    }
}

TEST(BridgedRobustBatch, WithAWideLossIsTheSmoother) {
    const NamedModel one = models().front();
    auto arc = draw_arc<2>(one.model, 600, 10.0);
    add_step<2>(arc, 300, 0.5);
    const SmoothedArc<2> smoothed = smooth<2>(arc, one.model);
    const auto wide = solve_robust<2>(arc, one.model, 100.0, means<2>(smoothed)).states;
    EXPECT_LT(largest_in_sigmas(smoothed, wide), 2e-3);
    // An unbridged step is a thousand standard deviations of motion: that shows.
    arc[300].step_before = false;
    const auto blind = solve_robust<2>(arc, one.model, 100.0, means<2>(smoothed)).states;
    EXPECT_GT(largest_in_sigmas(smoothed, blind), 10.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
