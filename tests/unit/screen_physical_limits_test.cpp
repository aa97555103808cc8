#include <gtest/gtest.h>

#include <cmath>

#include "stages/screen/physical_limits.h"

namespace runcert::RUNCERT_FILE {
namespace {

// Standard normal quantile of 1 - 1e-9 (scipy.stats.norm.isf(1e-9)).
constexpr double quantile_1e9 = 5.9978070150076865;

struct Table {
    std::vector<ScreenedEpoch> rows;
    Motion motion;
};

/// One arc at 10 Hz with no acceleration and no uncertainty; heights not measured.
Table at_rest(std::size_t epochs) {
    Table table;
    for (std::size_t k = 0; k < epochs; ++k) {
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        row.usable = true;
        row.arc = 1;
        row.statistic = 1.5;
        row.threshold = 20.0;
        EpochMotion motion;
        motion.acceleration_covariance.setZero();
        motion.velocity_covariance.setZero();
        table.motion.emplace_back(motion);
    }
    return table;
}

PhysicalLimits limits(double acceleration_m_s2, double jerk_m_s3, double vertical_rate_m_s) {
    return {acceleration_m_s2, jerk_m_s3, vertical_rate_m_s};
}

void expect_kept(const ScreenedEpoch& row) {
    EXPECT_TRUE(row.usable);
    EXPECT_EQ(row.reason, Reason::none);
    EXPECT_FALSE(row.hypothesis);
    EXPECT_EQ(row.statistic, 1.5);
    EXPECT_EQ(row.threshold, 20.0);
}

void expect_marked(const ScreenedEpoch& row, Hypothesis hypothesis, double statistic,
                   double threshold) {
    EXPECT_FALSE(row.usable);
    EXPECT_EQ(row.reason, Reason::physical_limit);
    EXPECT_EQ(row.hypothesis, hypothesis);
    EXPECT_NEAR(row.statistic.value(), statistic, 1e-9);
    EXPECT_NEAR(row.threshold.value(), threshold, 1e-9);
    EXPECT_EQ(row.tested_axes, hypothesis == Hypothesis::vertical_rate ? TestedAxes::vertical
                                                                       : TestedAxes::horizontal);
    EXPECT_TRUE(row.arc.has_value());
}

TEST(PhysicalLimits, AnAccelerationAtTheLimitIsKeptAndOneBeyondItMarked) {
    Table table = at_rest(3);
    table.motion[1]->acceleration = {3.0, 4.0};
    LimitComparison found = check_limits(table.rows, table.motion, limits(5.0, 0.0, 0.0));
    EXPECT_EQ(found.rejected, 0);
    EXPECT_EQ(found.acceleration_m_s2, 5.0);
    EXPECT_EQ(found.acceleration_max_m_s2, 5.0);
    for (const ScreenedEpoch& row : table.rows)
        expect_kept(row);

    const double below = std::nextafter(5.0, 0.0);
    found = check_limits(table.rows, table.motion, limits(below, 0.0, 0.0));
    EXPECT_EQ(found.rejected, 1);
    EXPECT_EQ(found.acceleration_m_s2, 0.0);
    expect_marked(table.rows[1], Hypothesis::acceleration, 5.0, 5.0);
    expect_kept(table.rows[0]);
    expect_kept(table.rows[2]);
}

TEST(PhysicalLimits, TheAllowanceIsTheQuantileTimesTheUncertaintyAlongTheAcceleration) {
    Table table = at_rest(2);
    Eigen::Matrix2d covariance;
    covariance << 0.09, 0.02, 0.02, 0.04;
    // Along (0.6, 0.8): 0.36 0.09 + 2 0.48 0.02 + 0.64 0.04 = 0.0772.
    const double threshold = 5.0 + quantile_1e9 * std::sqrt(0.0772);
    for (const double factor : {1.0 - 1e-9, 1.0 + 1e-9}) {
        for (auto& motion : table.motion)
            motion->acceleration_covariance = covariance;
        table.motion[1]->acceleration = Eigen::Vector2d(0.6, 0.8) * threshold * factor;
        std::vector<ScreenedEpoch> rows = table.rows;
        const LimitComparison found = check_limits(rows, table.motion, limits(5.0, 0.0, 0.0));
        if (factor < 1.0) {
            EXPECT_EQ(found.rejected, 0);
            expect_kept(rows[1]);
            EXPECT_NEAR(found.acceleration_m_s2, threshold, 1e-6);
        } else {
            EXPECT_EQ(found.rejected, 1);
            expect_marked(rows[1], Hypothesis::acceleration, threshold * factor, threshold);
        }
    }
}

TEST(PhysicalLimits, AMoreLenientTestAllowsLess) {
    Table table = at_rest(1);
    table.motion[0]->acceleration = {6.7, 0.0};
    table.motion[0]->acceleration_covariance = Eigen::Matrix2d::Identity();
    PhysicalLimits five = limits(5.0, 0.0, 0.0);
    EXPECT_EQ(check_limits(table.rows, table.motion, five).rejected, 0);
    five.test_size = 0.05;  // 1.6449 standard uncertainties
    EXPECT_EQ(check_limits(table.rows, table.motion, five).rejected, 1);
    EXPECT_NEAR(table.rows[0].threshold.value(), 6.644853626951472, 1e-9);
}

TEST(PhysicalLimits, JerkIsTheChangeOfAccelerationWithBothUncertaintiesAdded) {
    Table table = at_rest(3);
    // (0.6, 0.8) m/s^2 in 0.1 s is 10 m/s^3; the standard uncertainties along it are 0.01 and 0.03.
    for (const std::size_t k : {std::size_t{1}, std::size_t{2}})
        table.motion[k]->acceleration = {0.6, 0.8};
    table.motion[0]->acceleration_covariance = Eigen::Matrix2d::Identity() * 0.0001;
    table.motion[1]->acceleration_covariance = Eigen::Matrix2d::Identity() * 0.0009;
    const double allowance = quantile_1e9 * 0.4;
    std::vector<ScreenedEpoch> rows = table.rows;
    LimitComparison found =
        check_limits(rows, table.motion, limits(0.0, 10.0 - allowance + 1e-6, 0.0));
    EXPECT_EQ(found.rejected, 0);
    EXPECT_NEAR(found.jerk_m_s3, 10.0, 1e-9);

    rows = table.rows;
    const double limit = 10.0 - allowance - 1e-6;
    found = check_limits(rows, table.motion, limits(0.0, limit, 0.0));
    EXPECT_EQ(found.rejected, 1);
    expect_kept(rows[0]);
    expect_marked(rows[1], Hypothesis::jerk, 10.0, limit + allowance);
    // Against the last epoch kept, 0.2 s before.
    expect_kept(rows[2]);
    EXPECT_NEAR(found.jerk_m_s3, 5.0, 1e-9);
    EXPECT_EQ(found.jerk_max_m_s3, limit);
}

TEST(PhysicalLimits, JerkIsNotTakenAcrossArcs) {
    Table table = at_rest(4);
    for (const std::size_t k : {std::size_t{2}, std::size_t{3}}) {
        table.rows[k].arc = 2;
        table.motion[k]->acceleration = {100.0, 0.0};
    }
    const LimitComparison found = check_limits(table.rows, table.motion, limits(0.0, 1.0, 0.0));
    EXPECT_EQ(found.rejected, 0);
    EXPECT_EQ(found.jerk_m_s3, 0.0);
}

TEST(PhysicalLimits, OneWildEpochDoesNotTakeTheNextWithIt) {
    Table table = at_rest(5);
    table.motion[2]->acceleration = {50.0, 0.0};
    const LimitComparison found = check_limits(table.rows, table.motion, limits(10.0, 20.0, 0.0));
    EXPECT_EQ(found.rejected, 1);
    expect_marked(table.rows[2], Hypothesis::acceleration, 50.0, 10.0);
    expect_kept(table.rows[3]);
}

TEST(PhysicalLimits, VerticalRateUpAndDown) {
    Table table = at_rest(4);
    const double threshold = 2.0 + quantile_1e9 * 0.1;
    for (auto& motion : table.motion) {
        motion->vertical_rate_m_s = 0.0;
        motion->sigma_vertical_rate_m_s = 0.1;
    }
    table.motion[1]->vertical_rate_m_s = -(threshold + 1e-10);
    table.motion[2]->vertical_rate_m_s = threshold - 1e-10;
    table.motion[3]->vertical_rate_m_s = threshold + 1e-10;
    const LimitComparison found = check_limits(table.rows, table.motion, limits(1.0, 1.0, 2.0));
    EXPECT_EQ(found.rejected, 2);
    expect_marked(table.rows[1], Hypothesis::vertical_rate, threshold, threshold);
    expect_kept(table.rows[2]);
    expect_marked(table.rows[3], Hypothesis::vertical_rate, threshold, threshold);
    EXPECT_NEAR(found.vertical_rate_m_s, threshold, 1e-6);
}

TEST(PhysicalLimits, WithoutHeightsNoVerticalRateIsTested) {
    Table table = at_rest(3);
    for (auto& motion : table.motion)
        motion->sigma_vertical_rate_m_s = 1.0;
    const LimitComparison found = check_limits(table.rows, table.motion, limits(1.0, 1.0, 1e-6));
    EXPECT_EQ(found.rejected, 0);
    EXPECT_EQ(found.vertical_rate_m_s, 0.0);
    EXPECT_EQ(found.vertical_rate_max_m_s, 1e-6);
}

TEST(PhysicalLimits, RowsOutsideArcsOrNotUsableAreUntouched) {
    Table table = at_rest(5);
    for (auto& motion : table.motion)
        motion->acceleration = {100.0, 0.0};
    table.rows[1].arc.reset();
    table.motion[2].reset();
    table.rows[3].usable = false;
    table.rows[3].reason = Reason::outlier;
    table.rows[3].hypothesis = Hypothesis::outlier;
    const LimitComparison found = check_limits(table.rows, table.motion, limits(10.0, 0.0, 0.0));
    EXPECT_EQ(found.rejected, 2);
    EXPECT_FALSE(table.rows[0].usable);
    expect_kept(table.rows[1]);
    expect_kept(table.rows[2]);
    EXPECT_EQ(table.rows[3].reason, Reason::outlier);
    EXPECT_EQ(table.rows[3].hypothesis, Hypothesis::outlier);
    EXPECT_EQ(table.rows[3].statistic, 1.5);
    EXPECT_EQ(found.acceleration_m_s2, 0.0);
}

TEST(PhysicalLimits, AMarkReplacesWhatAnEarlierTestOfTheEpochFound) {
    Table table = at_rest(1);
    table.motion[0]->acceleration = {100.0, 0.0};
    table.rows[0].hypothesis = Hypothesis::step;
    table.rows[0].estimated.east_m = 3.0;
    table.rows[0].detectable.outlier_m = 0.1;
    check_limits(table.rows, table.motion, limits(10.0, 0.0, 0.0));
    expect_marked(table.rows[0], Hypothesis::acceleration, 100.0, 10.0);
    EXPECT_FALSE(table.rows[0].estimated.east_m);
    EXPECT_EQ(table.rows[0].detectable.outlier_m, 0.1);
}

TEST(PhysicalLimits, WithoutLimitsNothingIsMarkedAndTheLargestFiguresAreStillGiven) {
    Table table = at_rest(2);
    table.motion[1]->acceleration = {100.0, 0.0};
    table.motion[1]->vertical_rate_m_s = -30.0;
    const LimitComparison found = check_limits(table.rows, table.motion, {});
    EXPECT_EQ(found.rejected, 0);
    EXPECT_EQ(found.acceleration_m_s2, 100.0);
    EXPECT_NEAR(found.jerk_m_s3, 1000.0, 1e-9);
    EXPECT_EQ(found.vertical_rate_m_s, 30.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
