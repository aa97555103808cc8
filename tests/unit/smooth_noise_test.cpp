#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/random.h"
#include "core/statistics.h"
#include "stages/smooth/health.h"
#include "stages/smooth/noise.h"
#include "stages/smooth/smooth.h"
#include "witness/arcs.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A craft that turns and changes its speed, measured at 10 Hz.
struct Recording {
    std::int64_t epochs = 600;
    double stated_m = 0.010;
    /// Standard deviation of the white noise at an epoch, in units of what is stated.
    std::function<double(std::int64_t)> size = [](std::int64_t) { return 1.0; };
    /// What the device makes a position from: shares of the latest measurements, newest first.
    std::vector<double> filter = {1.0};
    std::uint64_t seed = 1;
};

ScreenedTable record(const Recording& recording) {
    RandomGenerator random(recording.seed);
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    std::vector<Eigen::Vector2d> raw;
    const auto taps = static_cast<std::int64_t>(recording.filter.size());
    for (std::int64_t k = 1 - taps; k < recording.epochs; ++k) {
        const double t = 0.1 * static_cast<double>(k);
        const double sigma_m = recording.stated_m * recording.size(k);
        raw.emplace_back(200.0 * std::sin(t / 10.0) + sigma_m * random.normal(),
                         150.0 * std::cos(t / 14.0) + sigma_m * random.normal());
        if (k < 0) continue;
        Eigen::Vector2d position = Eigen::Vector2d::Zero();
        for (std::size_t i = 0; i < recording.filter.size(); ++i)
            position += recording.filter[i] * raw[raw.size() - 1 - i];
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = position.x();
        row.north_m = position.y();
        row.sigma_east_m = row.sigma_north_m = recording.stated_m;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    return table;
}

SmoothConfig config() {
    SmoothConfig config;
    config.fit.initial_jerk_density = 0.6;
    return config;
}

SmoothConfig as_stated() {
    SmoothConfig config = RUNCERT_FILE::config();
    config.fit_noise = false;
    return config;
}

NoiseSummary estimated(const ScreenedTable& table, const SmoothConfig& with = config()) {
    std::vector<Arc<2>> arcs = arcs_of<2>(table);
    return estimate_noise<2>(arcs, with);
}

TEST(LearnNoise, FromTooFewEpochs) {
    // 30, and the three at the beginning of an arc that its vague prior makes worthless.
    const NoiseSummary noise = estimated(record({.epochs = 32}));
    EXPECT_EQ(noise.status, NoiseBasis::too_few_epochs);
    EXPECT_EQ(noise.epochs, 32);
    EXPECT_EQ(noise.epochs_needed, 33);
    EXPECT_GE(noise.measurement_scale.value, 1.0);
    EXPECT_NEAR(noise.jerk_density.value / noise.measurement_scale.value, 0.6, 1e-6);
    EXPECT_EQ(estimated(record({.epochs = 33})).status, NoiseBasis::fitted);
}

TEST(LearnNoise, OnlyMeasuredEpochsCount) {
    ScreenedTable table = record({.epochs = 34});
    table.rows[10].usable = table.rows[20].usable = false;
    table.rows[10].reason = table.rows[20].reason = Reason::outlier;
    EXPECT_EQ(estimated(table).status, NoiseBasis::too_few_epochs);
    EXPECT_EQ(estimated(table).epochs, 32);
}

TEST(LearnNoise, FromConstantPositions) {
    ScreenedTable table = record({.epochs = 200});
    for (ScreenedEpoch& row : table.rows) {
        row.east_m = 12.345;
        row.north_m = -6.789;
    }
    const NoiseSummary noise = estimated(table);
    EXPECT_EQ(noise.status, NoiseBasis::constant_positions);
    EXPECT_EQ(noise.measurement_scale.value, 1.0);  // never below what is stated
    EXPECT_EQ(noise.jerk_density.value, 0.6);
    EXPECT_FALSE(noise.correlated_error_detected);
    *table.rows[100].east_m += 0.001;
    EXPECT_EQ(estimated(table).status, NoiseBasis::fitted);
}

TEST(LearnNoise, StatedAccuraciesThatAreAllEqual) {
    ScreenedTable table = record({.epochs = 100});
    EXPECT_TRUE(estimated(table).stated_all_equal);
    EXPECT_NEAR(estimated(table).stated_sigma_m, 0.010, 1e-6);
    table.rows[50].sigma_north_m = 0.012;
    EXPECT_FALSE(estimated(table).stated_all_equal);
    EXPECT_NEAR(estimated(table).stated_sigma_m,
                std::sqrt((199 * 0.010 * 0.010 + 0.012 * 0.012) / 200.0), 1e-6);
}

TEST(LearnNoise, AsStatedWhereTheAttemptAsksForIt) {
    const NoiseSummary noise = estimated(record({.epochs = 300}), as_stated());
    EXPECT_EQ(noise.status, NoiseBasis::stated);
    EXPECT_EQ(noise.epochs, 300);
    EXPECT_EQ(noise.passes, 0.0);
    EXPECT_TRUE(noise.posterior.empty());
}

TEST(LearnNoise, StatedNoiseIsScaledByTheVarianceFactorAboveOneOnly) {
    const auto scale_of = [](double size) {
        return estimated(record({.epochs = 2000, .size = [=](std::int64_t) { return size; }}),
                         as_stated());
    };
    // Part of an innovation is the motion's, so that 3 times the noise is seen as a little less.
    EXPECT_NEAR(scale_of(3.0).measurement_scale.value, 2.7, 0.3);
    EXPECT_EQ(scale_of(3.0).white_scale, scale_of(3.0).measurement_scale.value);
    EXPECT_NEAR(scale_of(3.0).jerk_density.value, 0.6 * scale_of(3.0).measurement_scale.value,
                1e-6);
    EXPECT_EQ(scale_of(0.3).measurement_scale.value, 1.0);
    EXPECT_NEAR(scale_of(0.3).white_scale, 0.3, 0.1);
}

TEST(LearnNoise, UnfittedCovariancesGrowWithTheVarianceFactor) {
    const ScreenedTable table = record({.epochs = 400, .size = [](std::int64_t) { return 3.0; }});
    const TrajectoryTable trajectory = smooth_trajectory(table, as_stated());
    const double scale = trajectory.estimation.horizontal.noise.measurement_scale.value;
    ASSERT_GT(scale, 2.5);
    EXPECT_EQ(trajectory.estimation.variance_factor_applied, scale * scale);
    // After the scaling the factor of unit weight is one.
    EXPECT_NEAR(trajectory.estimation.variance_factor, 1.0, 0.02);
    EstimationModel stated;
    stated.motion.jerk_density = 0.6;
    const Chain<2> unscaled = Chain<2>(arcs_of<2>(table).front().epochs, stated);
    for (const std::size_t k : {std::size_t{0}, std::size_t{37}, std::size_t{200}}) {
        const TrajectoryEpoch& row = trajectory.rows[k];
        const StateVector<2> sigma = unscaled.state(k).covariance.diagonal().cwiseSqrt();
        EXPECT_NEAR(*row.sigma_east_m, scale * sigma(0), 1e-4 * scale * sigma(0));
        EXPECT_NEAR(*row.sigma_velocity_north_m_s, scale * sigma(3), 1e-4 * scale * sigma(3));
        EXPECT_NEAR(*row.east_m, unscaled.mean(k)(0), 1e-6);
    }
}

TEST(LearnNoise, AFitAtTheLimitOfItsRangeSaysSo) {
    // Straight on without any change of speed: no jerk is too small for it.
    ScreenedTable table = record({.epochs = 300});
    RandomGenerator random(4);
    for (ScreenedEpoch& row : table.rows) {
        row.east_m = 20.0 * row.time.seconds() + 0.010 * random.normal();
        row.north_m = 0.010 * random.normal();
    }
    const NoiseSummary noise = estimated(table);
    EXPECT_EQ(noise.status, NoiseBasis::fitted);
    EXPECT_TRUE(noise.jerk_density.at_bound);
    EXPECT_FALSE(noise.jerk_density.relative_uncertainty.has_value());
    EXPECT_NEAR(noise.measurement_scale.value, 1.0, 0.1);
    EXPECT_FALSE(noise.measurement_scale.at_bound);
    EXPECT_FALSE(estimated(record({})).jerk_density.at_bound);
}

/// At rest, then back and forth by 12 m every 8 s for half a minute, then at rest.
ScreenedTable waited_and_sailed(double swing_m = 6.0) {
    ScreenedTable table = record({.epochs = 3000});
    RandomGenerator random(9);
    for (std::int64_t k = 0; k < 3000; ++k) {
        ScreenedEpoch& row = table.rows[static_cast<std::size_t>(k)];
        const double since_s = std::clamp(0.1 * static_cast<double>(k) - 200.0, 0.0, 32.0);
        row.east_m =
            swing_m * (1.0 - std::cos(0.25 * std::numbers::pi * since_s)) + 0.010 * random.normal();
        row.north_m = 0.010 * random.normal();
    }
    return table;
}

TEST(LearnNoise, FitsWithTheMotionWhereItIs) {
    std::vector<Arc<2>> arcs = arcs_of<2>(waited_and_sailed());
    const NoiseSummary noise = estimate_noise<2>(arcs, config());
    ASSERT_EQ(noise.status, NoiseBasis::fitted);
    const std::vector<ArcEpoch<2>>& epochs = arcs.front().epochs;
    double least_moving = epochs[2020].jerk_factor;
    double largest_quiet = 0.0;
    for (std::size_t k = 2020; k < 2300; ++k)
        least_moving = std::min(least_moving, epochs[k].jerk_factor);
    for (std::size_t k = 0; k < 1860; ++k)
        largest_quiet = std::max(largest_quiet, epochs[k].jerk_factor);
    EXPECT_GT(least_moving, 1.5);
    EXPECT_LT(largest_quiet, 0.2 * least_moving);
    // What is white is not lost in the motion, nor the motion in it.
    EXPECT_NEAR(noise.measurement_scale.value, 1.0, 0.05);
    EXPECT_FALSE(noise.correlated_error_detected);
    EXPECT_TRUE(filter_health<2>(arcs, model_of(noise)).white);
}

TEST(LearnNoise, WhereNothingIsFittedNoMotionIsFollowed) {
    std::vector<Arc<2>> arcs = arcs_of<2>(record({.epochs = 32}));
    EXPECT_EQ(estimate_noise<2>(arcs, config()).status, NoiseBasis::too_few_epochs);
    for (const ArcEpoch<2>& epoch : arcs.front().epochs)
        EXPECT_EQ(epoch.jerk_factor, 1.0);
    arcs = arcs_of<2>(record({.epochs = 300}));
    const NoiseSummary noise = estimate_noise<2>(arcs, as_stated());
    set_jerk_densities<2>(arcs, noise, as_stated());
    for (const ArcEpoch<2>& epoch : arcs.front().epochs)
        EXPECT_EQ(epoch.jerk_factor, 1.0);
}

TEST(JerkDensities, AreNowhereLessThanTheClassesAndTheFittedOne) {
    for (const double swing_m : {0.0, 0.2, 6.0}) {
        std::vector<Arc<2>> arcs = arcs_of<2>(waited_and_sailed(swing_m));
        const NoiseSummary noise = estimate_noise<2>(arcs, config());
        const double fitted = noise.jerk_density.value;
        std::vector<double> motion;
        for (const ArcEpoch<2>& epoch : arcs.front().epochs)
            motion.push_back(fitted * epoch.jerk_factor);
        set_jerk_densities<2>(arcs, noise, config());
        const double floor = std::max(0.6, fitted);
        for (std::size_t k = 0; k < motion.size(); ++k) {
            const double density = fitted * arcs.front().epochs[k].jerk_factor;
            EXPECT_NEAR(density, std::max(floor, motion[k]), 1e-5 * density) << swing_m << " " << k;
        }
        // Quiet the estimate has the freedom of the class, and no more.
        EXPECT_NEAR(fitted * arcs.front().epochs[500].jerk_factor, floor, 1e-5) << swing_m;
    }
}

TEST(JerkDensities, OfHardMotionAreTheMotions) {
    // 6 m back and forth every 8 s: up to 3.7 m/s^2 and 2.9 m/s^3.
    std::vector<Arc<2>> arcs = arcs_of<2>(waited_and_sailed());
    const NoiseSummary noise = estimate_noise<2>(arcs, config());
    set_jerk_densities<2>(arcs, noise, config());
    for (std::size_t k = 2020; k < 2300; ++k)
        EXPECT_GT(noise.jerk_density.value * arcs.front().epochs[k].jerk_factor, 0.8) << k;
}

TEST(LearnNoise, WhatIsWrittenAndReadGivesTheSameModel) {
    ScreenedTable table = record({.epochs = 300, .size = [](std::int64_t k) {
                                      return 1.0 + 0.3 * std::sin(0.01 * static_cast<double>(k));
                                  }});
    // A time-correlated error besides, so that every member of the model has something to say.
    RandomGenerator random(9);
    Eigen::Vector2d slow = Eigen::Vector2d::Zero();
    for (ScreenedEpoch& row : table.rows) {
        slow = 0.9 * slow + 0.015 * Eigen::Vector2d(random.normal(), random.normal());
        *row.east_m += slow.x();
        *row.north_m += slow.y();
    }
    for (const SmoothConfig& with : {config(), as_stated()}) {
        TrajectoryTable trajectory = smooth_trajectory(table, with);
        trajectory.header.stage = "smooth";
        trajectory.header.program_version = "1.1.0";
        trajectory.header.source_revision = "0";
        const TrajectoryTable back = read_trajectory(write_trajectory(trajectory), "trajectory");
        const NoiseSummary& written = trajectory.estimation.horizontal.noise;
        const NoiseSummary& read = back.estimation.horizontal.noise;
        if (with.fit_noise) {
            EXPECT_TRUE(written.correlated_error_detected);
            EXPECT_GT(written.posterior.size(), 1U);
        }
        const auto expect_same = [](const EstimationModel& a, const EstimationModel& b) {
            EXPECT_EQ(a.motion.jerk_density, b.motion.jerk_density);
            EXPECT_EQ(a.motion.acceleration_time_s, b.motion.acceleration_time_s);
            EXPECT_EQ(a.measurement_scale, b.measurement_scale);
            EXPECT_EQ(a.error.tau_s, b.error.tau_s);
            EXPECT_EQ(a.error.process_density, b.error.process_density);
            EXPECT_EQ(a.error.initial_sigma_m, b.error.initial_sigma_m);
        };
        expect_same(model_of(written), model_of(read));
        const auto models = posterior_of(written);
        const auto again = posterior_of(read);
        ASSERT_EQ(models.size(), again.size());
        for (std::size_t i = 0; i < models.size(); ++i) {
            expect_same(models[i].model, again[i].model);
            EXPECT_EQ(models[i].weight, again[i].weight);
        }
        // And the same states, from what was read: to the last bits, which are the compiler's.
        const Chain<2> smoothed =
            Chain<2>(arcs_of<2>(table, trajectory).front().epochs, model_of(read));
        EXPECT_NEAR(smoothed.mean(123)(0), trajectory.rows[123].east_m.value(), 1e-11);
    }
}

FilterHealth health_of(const Recording& recording) {
    return smooth_trajectory(record(recording), config()).estimation.horizontal.health;
}

TEST(FilterHealth, OfWhiteNoiseIsWhiteAndConsistent) {
    // One of twenty good recordings may be called inconsistent by its mean, and some by its spans.
    int consistent = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const FilterHealth health = health_of({.seed = seed});
        EXPECT_TRUE(health.white) << health.autocorrelation;
        EXPECT_LT(health.lower, 1.0);
        EXPECT_GT(health.upper, 1.0);
        EXPECT_EQ(health.innovations, 2 * (600 - 3));
        EXPECT_EQ(health.spans, 11);
        EXPECT_LT(health.largest_asymmetry, 1e-6);
        consistent += health.consistent ? 1 : 0;
    }
    EXPECT_GE(consistent, 8);
}

TEST(FilterHealth, PositionsThatTheDeviceAveragedAreWhitened) {
    const FilterHealth health = health_of({.filter = std::vector<double>(5, 0.2)});
    EXPECT_GT(health.autocorrelation_stated, 0.3);
    EXPECT_TRUE(health.white) << health.autocorrelation;
}

TEST(FilterHealth, PositionsThatTheDeviceExtrapolatedAreNotWhite) {
    // 1.8 times the latest less 0.8 times the one before: neighbouring errors of opposite sign,
    // which no model of the kind can have.
    const FilterHealth health = health_of({.filter = {1.8, -0.8}});
    EXPECT_LT(health.autocorrelation, -0.2);
    EXPECT_FALSE(health.white);
}

TEST(FilterHealth, AccuracyThatJumpsIsNotConsistent) {
    const FilterHealth health = health_of(
        {.epochs = 2000, .size = [](std::int64_t k) { return k % 600 < 300 ? 0.5 : 2.0; }});
    EXPECT_FALSE(health.consistent);
    EXPECT_GT(health.spans_outside, health.spans_allowed);
    EXPECT_TRUE(health.white);
}

TEST(FilterHealth, ChanceAllowsOneSpanInTwentyAndABitMore) {
    // Binomial with p = 0.05: of 39 spans at most 5 in 95 % of cases (exactly 0.952).
    EXPECT_EQ(health_of({.epochs = 2000}).spans, 39);
    EXPECT_NEAR(static_cast<double>(health_of({.epochs = 2000}).spans_allowed), 4.5, 0.6);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
