#include <gtest/gtest.h>

#include "core/failure.h"
#include "reports/compare/compare.h"

namespace runcert::RUNCERT_FILE {
namespace {

const std::string header = "time_s,east_m,north_m,up_m,speed_m_s,acceleration_m_s2\n";

std::string refused(const std::string& text) {
    try {
        (void)read_truth(text, "truth.csv");
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.remedy().empty());
        return failure.where() + " " + failure.problem();
    }
    return "";
}

TEST(Truth, IsReadByColumnName) {
    const auto truth =
        read_truth(header + "0.000,1.5,-2.5,0,3,0\n0.100,2.5,-3.5,0,4,0\n", "truth.csv");
    ASSERT_EQ(truth.size(), 2U);
    EXPECT_EQ(truth[1].time.nanoseconds, 100'000'000);
    EXPECT_EQ(truth[1].position, Eigen::Vector2d(2.5, -3.5));
    EXPECT_EQ(truth[1].speed_m_s, 4.0);
    const auto moved = read_truth("speed_m_s, north_m, east_m, time_s\r\n4, 2, 1, 7.5\r\n", "t");
    EXPECT_EQ(moved[0].position, Eigen::Vector2d(1.0, 2.0));
    EXPECT_EQ(moved[0].time.nanoseconds, 7'500'000'000);
}

TEST(Truth, WhatIsNotTruthIsRefusedWithItsLine) {
    EXPECT_NE(refused("").find("no epoch"), std::string::npos);
    EXPECT_NE(refused(header).find("no epoch"), std::string::npos);
    EXPECT_NE(refused("time_s,east_m\n").find("truth.csv:1 there is no column north_m"),
              std::string::npos);
    EXPECT_NE(refused(header + "0,1,1,1,fast,0\n").find("truth.csv:2 \"fast\""), std::string::npos);
    EXPECT_NE(refused(header + "0,1,1,1,1,0\n1,1,1\n").find("truth.csv:3 3 cells"),
              std::string::npos);
    EXPECT_NE(refused(header + "0,1,1,1,1,0\n0,1,1,1,1,0\n").find("truth.csv:3 the time"),
              std::string::npos);
    EXPECT_NE(refused(header + "0,1,1,1,1,0\n\n").find("truth.csv:3"), std::string::npos);
}

TEST(Truth, IsMatchedToRowsByTime) {
    const auto truth = read_truth(header + "0,0,0,0,1,0\n0.1,0,0,0,2,0\n0.3,0,0,0,3,0\n", "t");
    TrajectoryTable trajectory;
    for (const std::int64_t nanoseconds : {0, 100'400'000, 200'000'000, 299'400'000, 400'000'000})
        trajectory.rows.emplace_back().time.nanoseconds = nanoseconds;
    const auto rows = truth_at_rows(truth, trajectory);
    EXPECT_EQ(rows[0].speed_m_s, 1.0);
    EXPECT_EQ(rows[0].position_m, Eigen::Vector2d(0.0, 0.0));
    EXPECT_EQ(rows[1].speed_m_s, 2.0);  // within half a millisecond
    EXPECT_FALSE(rows[2].speed_m_s.has_value());
    EXPECT_FALSE(rows[3].speed_m_s.has_value());  // 0.6 ms off
    EXPECT_FALSE(rows[3].position_m.has_value());
    EXPECT_FALSE(rows[4].speed_m_s.has_value());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
