#include "reports/run_speeds/run_speeds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace runcert::RUNCERT_FILE {
namespace {

/// Straight north at 10 Hz, 10 m/s and 0.5 m/s faster with each epoch, falling at 2 m/s.
TrajectoryTable straight(std::int64_t epochs) {
    TrajectoryTable table;
    table.facts.nominal_interval_s = 0.1;
    double north_m = 0.0;
    for (std::int64_t k = 0; k < epochs; ++k) {
        const double speed_m_s = 10.0 + 0.5 * static_cast<double>(k);
        if (k > 0) north_m += 0.1 * (speed_m_s - 0.25);
        TrajectoryEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = 0.0;
        row.north_m = north_m;
        row.up_m = -0.2 * static_cast<double>(k);
        row.speed_m_s = speed_m_s;
        row.velocity_up_m_s = -2.0;
        row.arc = 1;
    }
    return table;
}

Profile over_time(double duration_s, Dimension dimension = Dimension::horizontal) {
    Profile profile;
    profile.window_kind = WindowKind::time;
    profile.duration_s = duration_s;
    profile.dimension = dimension;
    return profile;
}

TEST(RunSpeeds, OverATimeAreTheMeanOfBothEndsAndAllBetween) {
    const auto speeds = speeds_over_length(straight(11), over_time(0.5));
    ASSERT_EQ(speeds.size(), 11U);
    for (std::size_t k = 0; k < 5; ++k)
        EXPECT_FALSE(speeds[k]) << k;
    // Of six speeds up to 10 + 0.5 k.
    for (std::size_t k = 5; k < 11; ++k)
        EXPECT_NEAR(speeds[k].value(), 10.0 + 0.5 * (static_cast<double>(k) - 2.5), 1e-12) << k;
}

TEST(RunSpeeds, ReachBackToTheNearestEpochThatIsFarEnough) {
    // 0.25 s: the nearest so far back is 0.3 s away, so that four speeds count.
    const auto speeds = speeds_over_length(straight(6), over_time(0.25));
    EXPECT_FALSE(speeds[2]);
    EXPECT_NEAR(speeds[3].value(), 10.0 + 0.5 * 1.5, 1e-12);
}

TEST(RunSpeeds, EndAtABreak) {
    TrajectoryTable table = straight(30);
    for (std::size_t k = 10; k < 20; ++k)
        table.rows[k].arc = 2;
    for (std::size_t k = 20; k < 30; ++k) {
        table.rows[k].arc = 2;
        table.rows[k].time.nanoseconds += 100'000'000;  // one epoch is missing before
    }
    const auto speeds = speeds_over_length(table, over_time(0.5));
    for (std::size_t k = 0; k < 30; ++k)
        EXPECT_EQ(speeds[k].has_value(), k % 10 >= 5) << k;
    table.rows[25].speed_m_s.reset();
    const auto fewer = speeds_over_length(table, over_time(0.5));
    for (std::size_t k = 25; k < 30; ++k)
        EXPECT_FALSE(fewer[k]) << k;
}

TEST(RunSpeeds, AreOfTheRulesDimension) {
    const TrajectoryTable table = straight(6);
    EXPECT_NEAR(speeds_over_length(table, over_time(0.1, Dimension::vertical))[5].value(), 2.0,
                1e-12);
    EXPECT_NEAR(speeds_over_length(table, over_time(0.1, Dimension::space))[5].value(),
                0.5 * (std::hypot(12.5, 2.0) + std::hypot(12.0, 2.0)), 1e-12);
}

TEST(RunSpeeds, OverADistanceArePathOverTime) {
    Profile profile = over_time(0.0);
    profile.window_kind = WindowKind::distance;
    profile.distance_m = 2.0;
    const TrajectoryTable table = straight(6);
    const auto speeds = speeds_over_length(table, profile);
    // 1.025 m and 1.075 m up to the third epoch.
    EXPECT_FALSE(speeds[1]);
    EXPECT_NEAR(speeds[2].value(), 2.1 / 0.2, 1e-12);
    EXPECT_NEAR(speeds[5].value(), (1.175 + 1.225) / 0.2, 1e-12);
}

TEST(RunSpeeds, OfACourseThereAreNone) {
    Profile profile = over_time(0.0);
    profile.window_kind = WindowKind::course;
    EXPECT_TRUE(speeds_over_length(straight(6), profile).empty());
}

TEST(MethodSpeeds, HaveMeanAndStandardDeviationOfTheWindowsEpochs) {
    TrajectoryTable table = straight(11);
    for (TrajectoryEpoch& row : table.rows)
        row.speed_v1_m_s = 2.0 * *row.speed_m_s;
    table.rows[0].speed_v1_m_s.reset();  // not defined at the ends
    const auto inside = method_speeds(table, 4, 8);
    ASSERT_EQ(inside.size(), 2U);
    EXPECT_EQ(inside[0].epochs, 5);
    EXPECT_NEAR(inside[0].mean_m_s, 12.5, 1e-12);
    EXPECT_NEAR(inside[0].standard_deviation_m_s, 0.5 * std::sqrt(2.5), 1e-12);
    EXPECT_NEAR(inside[0].half_width_m_s(), 1.96 * 0.5 * std::sqrt(2.5), 1e-12);
    EXPECT_EQ(inside[1].method, "method v1 of [DHD22]");
    EXPECT_NEAR(inside[1].mean_m_s, 25.0, 1e-12);
    EXPECT_EQ(method_speeds(table, 1, 5).size(), 1U);
    EXPECT_TRUE(method_speeds(table, 5, 99).empty());
    EXPECT_TRUE(method_speeds(table, 5, 5).empty());
    EXPECT_TRUE(method_speeds(table, 8, 4).empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
