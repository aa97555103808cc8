#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/smooth/smooth.h"

// How the batch that checks the smoother is cut.

namespace runcert::RUNCERT_FILE {
namespace {

/// A craft on a wide curve, with noise as it is stated.
ScreenedTable record_of(std::int64_t epochs, std::int64_t interval_ns, double sigma_m) {
    RandomGenerator random(8);
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    const double interval_s = static_cast<double>(interval_ns) * 1e-9;
    table.facts.nominal_interval_s = interval_s;
    for (std::int64_t k = 0; k < epochs; ++k) {
        const double t = interval_s * static_cast<double>(k);
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * interval_ns};
        row.east_m = 3000.0 * std::sin(t / 200.0) + sigma_m * random.normal();
        row.north_m = 3000.0 * std::cos(t / 200.0) + sigma_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = sigma_m;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    table.rows.front().break_before = ArcBreak::start;
    return table;
}

/// At 20 Hz with 10 mm of noise, long enough for the batch to be cut.
ScreenedTable record() {
    return record_of(14'000, 50'000'000, 0.010);
}

SmoothConfig as_stated(double jerk_density) {
    SmoothConfig config;
    config.fit_noise = false;
    config.fit.initial_jerk_density = jerk_density;
    return config;
}

TEST(BatchStretches, AreShortWhereStatesForgetSoon) {
    const EstimationSummary summary = smooth_trajectory(record(), as_stated(0.6)).estimation;
    EXPECT_EQ(summary.batch_stretches, 2);
    EXPECT_LT(summary.largest_position_difference_m, 1e-7);
}

// At 1 Hz with 100 m stated the two differed by more than a micrometre, and the estimate stopped.
TEST(BatchAgreement, IsJudgedByTheStandardDeviation) {
    const EstimationSummary summary =
        smooth_trajectory(record_of(3'000, 1'000'000'000, 100.0), as_stated(0.001)).estimation;
    EXPECT_GT(summary.largest_position_difference_m, 1e-6);
    EXPECT_LT(summary.largest_position_difference_m, 1e-3);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
