#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/random.h"
#include "motion/chain.h"
#include "motion/speed.h"
#include "smooth_test_support.h"
#include "stages/smooth/batch.h"
#include "stages/smooth/robust.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::given_sigma_m;
using test::models;
using test::NamedModel;
using test::solve_robust_whole;

EstimationModel without_error() {
    return models().front().model;
}

/// What is simulated: epochs, their rate, a Gauss-Markov error of the measured positions, and how
/// many measurements in a hundred are missing.
struct ArcSpec {
    std::size_t epochs = 600;
    double rate_hz = 10.0;
    double error_sigma_m = 0.0;
    double error_tau_s = 3.0;
    double missing = 0.05;
    std::uint64_t seed = 11;
};

/// A curve some kilometres from the origin, driven at up to 40 m/s.
template <int Axes>
PositionVector<Axes> true_position(double time_s) {
    PositionVector<Axes> position;
    for (int axis = 0; axis < Axes; ++axis)
        position(axis) = 3000.0 + 1200.0 * std::sin(time_s / 30.0 + axis);
    return position;
}

template <int Axes>
std::vector<ArcEpoch<Axes>> simulate(const ArcSpec& spec) {
    RandomGenerator random(spec.seed);
    PositionMatrix<Axes> factor = PositionMatrix<Axes>::Identity() * given_sigma_m;
    if constexpr (Axes > 1) factor(1, 0) = 0.6 * given_sigma_m;
    const auto noise = [&] {
        return PositionVector<Axes>::NullaryExpr([&] { return random.normal(); }).eval();
    };
    const double phi = std::exp(-1.0 / (spec.rate_hz * spec.error_tau_s));
    PositionVector<Axes> error = spec.error_sigma_m * noise();
    std::vector<ArcEpoch<Axes>> arc(spec.epochs);
    for (std::size_t k = 0; k < spec.epochs; ++k) {
        arc[k].time_s = 2.0 + static_cast<double>(k) / spec.rate_hz;
        PositionMeasurement<Axes> measurement;
        measurement.covariance = factor * factor.transpose();
        measurement.position = true_position<Axes>(arc[k].time_s) + factor * noise() + error;
        error = phi * error + spec.error_sigma_m * std::sqrt(1.0 - phi * phi) * noise();
        if (k == 0 || random.uniform() >= spec.missing) arc[k].measurement = measurement;
    }
    return arc;
}

template <int Axes>
void remove_measurements(std::vector<ArcEpoch<Axes>>& arc, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k)
        arc[k].measurement.reset();
}

template <int Axes>
std::vector<StateVector<Axes>> means(const Chain<Axes>& smoothed) {
    std::vector<StateVector<Axes>> states;
    for (std::size_t k = 0; k < smoothed.size(); ++k)
        states.push_back(smoothed.mean(k));
    return states;
}

/// The largest difference of each of positions, velocities, accelerations and errors.
template <int Axes>
Eigen::Vector4d largest_difference(const std::vector<StateVector<Axes>>& a,
                                   const std::vector<StateVector<Axes>>& b) {
    Eigen::Vector4d largest = Eigen::Vector4d::Zero();
    EXPECT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
        for (int block = 0; block < 4; ++block) {
            const double difference =
                (a[k] - b[k]).template segment<Axes>(block * Axes).cwiseAbs().maxCoeff();
            largest(block) = std::max(largest(block), difference);
        }
    return largest;
}

template <int Axes>
void expect_agreement_with_smoother() {
    for (const double rate_hz : {5.0, 10.0, 20.0})
        for (const NamedModel& one : models()) {
            auto arc = simulate<Axes>(
                {.rate_hz = rate_hz, .error_sigma_m = one.model.error.initial_sigma_m});
            remove_measurements<Axes>(arc, 300, 310);
            const auto smoothed = means<Axes>(Chain<Axes>(arc, one.model));
            const BatchSolution<Axes> batch = solve_batch<Axes>(arc, one.model);
            const Eigen::Vector4d difference = largest_difference<Axes>(batch.states, smoothed);
            const std::string trace = fmt::format("{} Hz, {}", rate_hz, one.name);
            EXPECT_LT(difference(0), 1e-7) << trace;
            EXPECT_LT(difference(1), 1e-6) << trace;
            EXPECT_LT(difference(2), 1e-5) << trace;
            EXPECT_LT(difference(3), 1e-7) << trace;
            EXPECT_EQ(batch.stretches, 1);
        }
}

TEST(Batch, AgreesWithTheSmootherOnALine) {
    expect_agreement_with_smoother<1>();
}
TEST(Batch, AgreesWithTheSmootherInThePlane) {
    expect_agreement_with_smoother<2>();
}

TEST(Batch, AgreesWithTheSmootherAtIrregularSteps) {
    auto arc = simulate<2>({.error_sigma_m = 0.008});
    RandomGenerator random(5);
    for (auto& epoch : arc)
        epoch.time_s = std::round((epoch.time_s + 0.08 * random.uniform()) * 1e9) * 1e-9;
    for (const NamedModel& one : models()) {
        const auto smoothed = means<2>(Chain<2>(arc, one.model));
        const Eigen::Vector4d difference =
            largest_difference<2>(solve_batch<2>(arc, one.model).states, smoothed);
        EXPECT_LT(difference(0), 1e-7) << one.name;
        EXPECT_LT(difference(1), 1e-6) << one.name;
    }
}

TEST(Batch, AgreesWithTheSmootherWhereTheMotionChanges) {
    auto arc = simulate<2>({.error_sigma_m = 0.008});
    test::change_motion(arc);
    remove_measurements<2>(arc, 300, 310);
    for (const NamedModel& one : models()) {
        const auto smoothed = means<2>(Chain<2>(arc, one.model));
        const Eigen::Vector4d difference =
            largest_difference<2>(solve_batch<2>(arc, one.model).states, smoothed);
        EXPECT_LT(difference(0), 1e-7) << one.name;
        EXPECT_LT(difference(1), 1e-6) << one.name;
        EXPECT_LT(difference(2), 1e-5) << one.name;
        // Of one density for all of it the states are others.
        auto even = arc;
        for (ArcEpoch<2>& epoch : even)
            epoch.jerk_factor = 1.0;
        EXPECT_GT(largest_difference<2>(solve_batch<2>(even, one.model).states, smoothed)(0), 1e-4)
            << one.name;
    }
}

TEST(Batch, SolvesPositionsFreeOfNoiseAndASingleOne) {
    auto arc = simulate<2>({.epochs = 50, .missing = 0.0});
    for (auto& epoch : arc)
        epoch.measurement->position = Eigen::Vector2d(1234.5, -678.9);
    for (const NamedModel& one : models()) {
        for (const StateVector<2>& state : solve_batch<2>(arc, one.model).states) {
            EXPECT_LT((state.head<2>() - Eigen::Vector2d(1234.5, -678.9)).norm(), 1e-9);
            EXPECT_LT(state.tail<6>().norm(), 1e-9);
        }
        const auto alone = solve_batch<2>(std::span(arc).first(1), one.model).states;
        ASSERT_EQ(alone.size(), 1U);
        EXPECT_LT((alone[0].head<2>() - Eigen::Vector2d(1234.5, -678.9)).norm(), 1e-9);
    }
}

TEST(Batch, StretchesAgreeWithTheWholeArc) {
    auto arc = simulate<2>({.epochs = 3'000, .rate_hz = 20.0});
    const EstimationModel model = without_error();
    const BatchOptions options{.epochs_at_once = 1'000, .overlap = 400};
    const auto whole = solve_batch<2>(arc, model).states;
    const BatchSolution<2> cut = solve_batch<2>(arc, model, options);
    // Begun at 0, 600, 1200, 1800 and 2400, or at a measured epoch shortly before.
    EXPECT_EQ(cut.stretches, 5);
    EXPECT_LT(largest_difference<2>(cut.states, whole)(0), 1e-6);
    EXPECT_LT(largest_difference<2>(cut.states, whole)(1), 1e-5);

    // Where the second would begin there is a gap: it begins before.
    remove_measurements<2>(arc, 580, 640);
    const auto with_gap = solve_batch<2>(arc, model).states;
    EXPECT_LT(largest_difference<2>(solve_batch<2>(arc, model, options).states, with_gap)(0), 1e-6);
}

TEST(Batch, AGapAsLongAsAStretchLengthensIt) {
    auto arc = simulate<1>({.epochs = 900, .rate_hz = 20.0});
    remove_measurements<1>(arc, 1, 400);
    const EstimationModel model = without_error();
    const auto whole = solve_batch<1>(arc, model).states;
    const BatchSolution<1> cut =
        solve_batch<1>(arc, model, {.epochs_at_once = 300, .overlap = 100});
    EXPECT_GT(cut.stretches, 2);
    // Inside the gap the motion is known to metres and more.
    for (std::size_t k = 400; k < arc.size(); ++k)
        EXPECT_NEAR(cut.states[k](0), whole[k](0), 1e-5) << k;
}

TEST(Batch, DefaultOverlapIsEnoughForAGrowingErrorOfTenSecondsAtTwentyHertz) {
    const auto arc = simulate<2>(
        {.epochs = 16'000, .rate_hz = 20.0, .error_sigma_m = 0.02, .error_tau_s = 10.0});
    EstimationModel model = models().back().model;  // growing, Singer: the longest memory
    model.motion.jerk_density = 0.3;
    const auto whole = solve_batch<2>(arc, model).states;
    const BatchSolution<2> cut = solve_batch<2>(arc, model, {.epochs_at_once = 10'500});
    EXPECT_EQ(cut.stretches, 2);
    EXPECT_LT(largest_difference<2>(cut.states, whole)(0), 1e-6);
    // The test can tell: with an overlap of 15 s it is not enough.
    const auto short_overlap =
        solve_batch<2>(arc, model, {.epochs_at_once = 10'500, .overlap = 300}).states;
    EXPECT_GT(largest_difference<2>(short_overlap, whole)(0), 1e-5);
}

TEST(Batch, SaysWhereItDoesNotConverge) {
    auto arc = simulate<2>({.epochs = 50});
    arc[20].measurement = arc[0].measurement;
    arc[20].measurement->position(0) = std::numeric_limits<double>::quiet_NaN();
    try {
        solve_batch<2>(arc, without_error());
        FAIL();
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), "arc from 2.000 s to 6.900 s");
    }
}

/// Each epoch's difference between two positions in units of the smoother's standard deviation,
/// the larger of both axes.
std::vector<double> in_sigmas(const Chain<2>& smoothed, const std::vector<StateVector<2>>& states,
                              const std::vector<Eigen::Vector2d>& positions) {
    std::vector<double> result;
    for (std::size_t k = 0; k < states.size(); ++k) {
        const Eigen::Vector2d sigma = smoothed.state(k).covariance.diagonal().head<2>().cwiseSqrt();
        result.push_back(
            (states[k].head<2>() - positions[k]).cwiseAbs().cwiseQuotient(sigma).maxCoeff());
    }
    return result;
}

double largest(const std::vector<double>& values) {
    return *std::max_element(values.begin(), values.end());
}

double root_mean_square(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<Eigen::Vector2d> positions_of(const std::vector<StateVector<2>>& states) {
    std::vector<Eigen::Vector2d> positions;
    for (const StateVector<2>& state : states)
        positions.push_back(state.head<2>());
    return positions;
}

constexpr double cauchy_scale = 3.0;

/// An arc with outliers of 50 standard deviations at one epoch in twenty.
struct Contaminated {
    std::vector<ArcEpoch<2>> arc;
    std::vector<bool> is_outlier;
    std::vector<Eigen::Vector2d> truth;
};

Contaminated contaminate(std::vector<ArcEpoch<2>> arc) {
    RandomGenerator random(23);
    Contaminated result{.arc = std::move(arc), .is_outlier = {}, .truth = {}};
    for (auto& epoch : result.arc) {
        result.truth.push_back(true_position<2>(epoch.time_s));
        result.is_outlier.push_back(epoch.measurement && random.uniform() < 0.05);
        if (!result.is_outlier.back()) continue;
        const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
        epoch.measurement->position(random.uniform() < 0.5 ? 0 : 1) += sign * 50.0 * given_sigma_m;
    }
    return result;
}

EstimationModel white_model() {
    EstimationModel model;
    model.motion.jerk_density = 1.5;
    return model;
}

TEST(RobustBatch, WithoutOutliersDiffersLittleFromTheLinearSolution) {
    const auto arc = simulate<2>({.epochs = 1'000});
    const Chain<2> smoothed = Chain<2>(arc, white_model());
    const auto linear = means<2>(smoothed);
    const RobustSolution<2> robust =
        solve_robust_whole<2>(arc, white_model(), cauchy_scale, linear);
    const auto difference = in_sigmas(smoothed, robust.states, positions_of(linear));
    // Of 5 % less efficiency than least squares: a quarter of a standard deviation.
    EXPECT_LT(root_mean_square(difference), 0.25);
    EXPECT_GT(root_mean_square(difference), 0.01);
    // A wider loss is nearer to none.
    const auto wide = solve_robust_whole<2>(arc, white_model(), 100.0, linear).states;
    EXPECT_LT(largest(in_sigmas(smoothed, wide, positions_of(linear))), 2e-3);
}

TEST(RobustBatch, HoldsAgainstOutliersThatSpoilTheLinearSolution) {
    const Contaminated data = contaminate(simulate<2>({.epochs = 1'000}));
    const Chain<2> smoothed = Chain<2>(data.arc, white_model());
    const auto linear = means<2>(smoothed);
    const RobustSolution<2> robust =
        solve_robust_whole<2>(data.arc, white_model(), cauchy_scale, linear);
    const auto within_three = [&](const std::vector<StateVector<2>>& states) {
        const auto errors = in_sigmas(smoothed, states, data.truth);
        const auto count = std::ranges::count_if(errors, [](double e) { return e < 3.0; });
        return static_cast<double>(count) / static_cast<double>(errors.size());
    };
    EXPECT_GT(within_three(robust.states), 0.99);
    EXPECT_LT(largest(in_sigmas(smoothed, robust.states, data.truth)), 4.0);
    EXPECT_LT(within_three(linear), 0.8);
    EXPECT_GT(largest(in_sigmas(smoothed, linear, data.truth)), 20.0);
    std::size_t good = 0;
    std::size_t good_and_trusted = 0;
    for (std::size_t k = 0; k < data.arc.size(); ++k) {
        ASSERT_EQ(robust.weights[k].has_value(), data.arc[k].measurement.has_value()) << k;
        if (!robust.weights[k]) continue;
        EXPECT_GT(*robust.weights[k], 0.0);
        EXPECT_LE(*robust.weights[k], 1.0);
        if (data.is_outlier[k]) {
            EXPECT_LT(*robust.weights[k], 0.1) << k;
        } else {
            ++good;
            good_and_trusted += *robust.weights[k] > 0.5 ? 1 : 0;
        }
    }
    EXPECT_GT(static_cast<double>(good_and_trusted), 0.95 * static_cast<double>(good));
}

TEST(RobustBatch, IsTheLinearSolutionOfTheWeightedMeasurements) {
    // Where the Cauchy cost is least, its weights make the linear problem give the same states.
    for (const NamedModel& one : models()) {
        Contaminated data =
            contaminate(simulate<2>({.error_sigma_m = 0.5 * one.model.error.initial_sigma_m}));
        const auto start = means<2>(Chain<2>(data.arc, one.model));
        const RobustSolution<2> robust =
            solve_robust_whole<2>(data.arc, one.model, cauchy_scale, start);
        for (std::size_t k = 0; k < data.arc.size(); ++k)
            if (robust.weights[k]) data.arc[k].measurement->covariance /= *robust.weights[k];
        const Chain<2> weighted = Chain<2>(data.arc, one.model);
        const auto difference =
            in_sigmas(weighted, robust.states, positions_of(means<2>(weighted)));
        EXPECT_LT(largest(difference), 1e-3) << one.name;
    }
}

TEST(RobustBatch, StaysAtItsSolutionAndDoesNotDependOnTheCuts) {
    const Contaminated data = contaminate(simulate<2>({.epochs = 2'000, .rate_hz = 20.0}));
    const Chain<2> smoothed = Chain<2>(data.arc, white_model());
    const auto linear = means<2>(smoothed);
    const RobustSolution<2> robust =
        solve_robust_whole<2>(data.arc, white_model(), cauchy_scale, linear);
    const auto again = solve_robust_whole<2>(data.arc, white_model(), cauchy_scale, robust.states);
    EXPECT_LT(largest(in_sigmas(smoothed, again.states, positions_of(robust.states))), 1e-3);
    const auto sections = sections_of<2>(data.arc, 15.0, 700);
    EXPECT_EQ(sections.size(), 3U);
    const auto cut = solve_robust<2>(data.arc, white_model(), cauchy_scale, linear, sections);
    EXPECT_LT(largest(in_sigmas(smoothed, cut.states, positions_of(robust.states))), 1e-3);
    // The same bytes each time.
    const auto repeated = solve_robust_whole<2>(data.arc, white_model(), cauchy_scale, linear);
    EXPECT_EQ(repeated.weights, robust.weights);
    EXPECT_EQ(repeated.states, robust.states);
    EXPECT_EQ(repeated.passes, robust.passes);
}

TEST(RobustBatch, SaysThatItDoesNotConverge) {
    const auto arc = simulate<2>({.epochs = 50});
    auto start = means<2>(Chain<2>(arc, white_model()));
    start[7](0) = std::numeric_limits<double>::quiet_NaN();
    const RobustSolution<2> robust = solve_robust_whole<2>(arc, white_model(), cauchy_scale, start);
    EXPECT_FALSE(robust.converged);
    EXPECT_TRUE(robust.states.empty());
    EXPECT_TRUE(robust.weights.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
