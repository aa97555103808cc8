#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/smooth/smooth.h"

// How the batch that checks the smoother is cut.

namespace runcert::RUNCERT_FILE {
namespace {

/// A craft on a wide curve at 20 Hz, long enough for the batch to be cut, with 10 mm of noise.
ScreenedTable record() {
    RandomGenerator random(8);
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.05;
    for (std::int64_t k = 0; k < 14'000; ++k) {
        const double t = 0.05 * static_cast<double>(k);
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 50'000'000};
        row.east_m = 3000.0 * std::sin(t / 200.0) + 0.010 * random.normal();
        row.north_m = 3000.0 * std::cos(t / 200.0) + 0.010 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    table.rows.front().break_before = ArcBreak::start;
    return table;
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

}  // namespace
}  // namespace runcert::RUNCERT_FILE
