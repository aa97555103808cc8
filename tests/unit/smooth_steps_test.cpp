#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/smooth/smooth.h"

// What smoothing makes of recordings with bridged steps.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::size_t epochs = 400;

/// A craft that turns and changes its speed, at 10 Hz with 10 mm of white noise.
ScreenedTable record() {
    RandomGenerator random(4);
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = true;
    table.facts.nominal_interval_s = 0.1;
    for (std::size_t k = 0; k < epochs; ++k) {
        const double t = 0.1 * static_cast<double>(k);
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time = {static_cast<std::int64_t>(k) * 100'000'000};
        row.east_m = 200.0 * std::sin(t / 10.0) + 0.010 * random.normal();
        row.north_m = 150.0 * std::cos(t / 14.0) + 0.010 * random.normal();
        row.up_m = 0.020 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.sigma_up_m = 0.020;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    table.rows.front().break_before = ArcBreak::start;
    return table;
}

void add_step(ScreenedTable& table, std::size_t row, double east_m,
              ArcBreak by = ArcBreak::bridged) {
    table.rows[row].break_before = by;
    for (std::size_t k = row; k < table.rows.size(); ++k) {
        *table.rows[k].east_m += east_m;
        if (by == ArcBreak::step) ++*table.rows[k].arc;
    }
}

void reject(ScreenedEpoch& row) {
    row.usable = false;
    row.reason = Reason::outlier;
}

TrajectoryTable smoothed(const ScreenedTable& table) {
    const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    return smooth_trajectory(table, smooth_config(attempt));
}

TEST(BridgedTrajectory, SaysWhereItsStepsAre) {
    ScreenedTable table = record();
    add_step(table, 150, 0.5);
    table.rows[399].arc.reset();
    reject(table.rows[399]);
    const TrajectoryTable trajectory = smoothed(table);
    for (std::size_t k = 0; k < 399; ++k)
        EXPECT_EQ(trajectory.rows[k].step_before, k == 150) << k;
    EXPECT_FALSE(trajectory.rows[399].step_before);
}

TEST(BridgedTrajectory, HasTheNoiseOfOneWithoutTheStep) {
    ScreenedTable table = record();
    const NoiseSummary whole = smoothed(table).estimation.horizontal.noise;
    add_step(table, 150, 0.5);
    const AxesEstimation bridged = smoothed(table).estimation.horizontal;
    EXPECT_NEAR(bridged.noise.jerk_density.value / whole.jerk_density.value, 1.0, 0.05);
    EXPECT_NEAR(bridged.noise.measurement_scale.value / whole.measurement_scale.value, 1.0, 0.02);
    EXPECT_TRUE(bridged.health.consistent);
    table.rows[150].break_before.reset();
    const AxesEstimation unbridged = smoothed(table).estimation.horizontal;
    EXPECT_GT(unbridged.noise.jerk_density.value, 1.3 * whole.jerk_density.value);
}

TEST(BridgedTrajectory, EachOffsetThatIsToldCostsItsDegreesOfFreedom) {
    ScreenedTable table = record();
    const auto expect_degrees = [&](std::int64_t degrees) {
        const EstimationSummary summary = smoothed(table).estimation;
        EXPECT_EQ(summary.degrees_of_freedom, degrees);
        // Each innovation that tests the model is one: two ways of counting.
        EXPECT_EQ(summary.horizontal.health.innovations, degrees);
        EXPECT_EQ(summary.vertical->health.innovations, degrees / 2);
    };
    expect_degrees(800 - 6);
    add_step(table, 150, 0.5);
    add_step(table, 151, -0.2);
    expect_degrees(800 - 6 - 4);
    // Between these two lies no measurement: only their sum is told.
    reject(table.rows[150]);
    expect_degrees(798 - 6 - 2);
    // After this one nothing is measured.
    add_step(table, 399, 1.0);
    reject(table.rows[399]);
    expect_degrees(796 - 6 - 2);
}

TEST(BridgedTrajectory, MethodsOfThePaperAreThoseOfEitherSideByItself) {
    ScreenedTable bridged = record();
    add_step(bridged, 150, 0.5);
    reject(bridged.rows[150]);
    ScreenedTable cut = record();
    add_step(cut, 150, 0.5, ArcBreak::step);
    reject(cut.rows[150]);
    cut.rows[150].arc = 1;  // an arc begins with a measurement
    const TrajectoryTable together = smoothed(bridged);
    const TrajectoryTable apart = smoothed(cut);
    for (std::size_t k = 0; k < epochs; ++k) {
        EXPECT_EQ(together.rows[k].speed_v1_m_s, apart.rows[k].speed_v1_m_s) << k;
        EXPECT_EQ(together.rows[k].speed_v2_m_s, apart.rows[k].speed_v2_m_s) << k;
        if (k != 151) {
            EXPECT_EQ(together.rows[k].speed_kalman_m_s, apart.rows[k].speed_kalman_m_s) << k;
        }
    }
    // The filter begins at rest, which the craft is not.
    EXPECT_EQ(apart.rows[151].speed_kalman_m_s, 0.0);
    EXPECT_FALSE(together.rows[151].speed_kalman_m_s);
    // The smoother goes on across the step.
    EXPECT_NEAR(*together.rows[150].speed_m_s, *together.rows[149].speed_m_s, 0.1);
    EXPECT_LT(*together.rows[151].sigma_speed_m_s, *apart.rows[151].sigma_speed_m_s);
}

TEST(BridgedTrajectory, RobustBatchHasTheSameOffset) {
    ScreenedTable table = record();
    add_step(table, 150, 0.5);
    reject(table.rows[150]);
    const TrajectoryTable trajectory = smoothed(table);
    for (std::size_t k = 140; k < 160; ++k) {
        EXPECT_NEAR(*trajectory.rows[k].robust_east_m, *trajectory.rows[k].east_m, 0.02) << k;
        EXPECT_GT(trajectory.rows[k].robust_weight.value(), 0.2) << k;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
