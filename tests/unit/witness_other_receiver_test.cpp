#include <gtest/gtest.h>

#include <cmath>

#include "witness/receiver_witness.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;

/// Where a craft on a circle is, and where an antenna on it.
struct Circle {
    double speed_m_s = 60.0;
    double radius_m = 1e6;
    double ahead_m = 0.0;
    double right_m = 0.0;

    TrajectoryEpoch at(double t) const {
        const double rate = speed_m_s / radius_m;
        const double s = std::sin(rate * t), c = std::cos(rate * t);
        // The antenna goes on a circle of its own, as fast as the craft turns.
        const double across = radius_m - right_m;
        TrajectoryEpoch row;
        row.east_m = radius_m - across * c + ahead_m * s;
        row.north_m = across * s + ahead_m * c;
        row.velocity_east_m_s = rate * (across * s + ahead_m * c);
        row.velocity_north_m_s = rate * (across * c - ahead_m * s);
        row.acceleration_east_m_s2 = rate * rate * (across * c - ahead_m * s);
        row.acceleration_north_m_s2 = rate * rate * (-across * s - ahead_m * c);
        row.speed_m_s = std::hypot(*row.velocity_east_m_s, *row.velocity_north_m_s);
        row.sigma_east_m = row.sigma_north_m = 0.005;
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 0.1;
        row.usable = true;
        row.arc = 1;
        return row;
    }
};

/// Ten seconds of it; `later_s` is when the recording begins.
TrajectoryTable trajectory_of(const Circle& course, double later_s = 0.0,
                              std::int64_t interval_ms = 100) {
    TrajectoryTable table;
    table.facts.nominal_interval_s = 1e-3 * static_cast<double>(interval_ms);
    table.facts.first_epoch =
        parse_gps_iso("2026-03-14T03:20:18.000").plus_nanoseconds(std::llround(later_s * 1e9));
    for (std::int64_t ms = 0; ms <= 10'000; ms += interval_ms) {
        TrajectoryEpoch row = course.at(later_s + 1e-3 * static_cast<double>(ms));
        row.epoch = std::ssize(table.rows) + 1;
        row.time = {ms * 1'000'000};
        table.rows.push_back(row);
    }
    return table;
}

Track recorded(const Circle& course, double later_s = 0.0, std::int64_t interval_ms = 100) {
    return track_of(trajectory_of(course, later_s, interval_ms));
}

/// How far the craft itself went.
Vector2d moved(const Circle& course, double from_s, double to_s) {
    const TrajectoryEpoch from = course.at(from_s), to = course.at(to_s);
    return {*to.east_m - *from.east_m, *to.north_m - *from.north_m};
}

TEST(ReceiverWitness, IsOnTheTimeOfThePositionsWhateverItsRecordingBeginsWith) {
    const Circle course{.radius_m = 500.0};
    for (const double later_s : {-1.7, 0.0, 1.9, 4.93}) {
        const auto witness = receiver_witness<2>(recorded(course, later_s), recorded(course));
        ASSERT_TRUE(witness);
        const auto by = witness->between(5.0, 8.0);
        ASSERT_TRUE(by) << later_s;
        EXPECT_LT((by->displacement_m - moved(course, 5.0, 8.0)).norm(), 1e-4) << later_s;
        EXPECT_NEAR(witness->covered().first_s, later_s, 1e-9);
    }
}

TEST(ReceiverWitness, InterpolatesBetweenItsEpochs) {
    const Circle course{.radius_m = 300.0};
    for (const std::int64_t interval_ms : {70, 250, 1000}) {
        const auto witness =
            receiver_witness<2>(recorded(course, 0.031, interval_ms), recorded(course));
        ASSERT_TRUE(witness);
        const auto by = witness->between(5.0, 8.0);
        ASSERT_TRUE(by);
        EXPECT_LT((by->displacement_m - moved(course, 5.0, 8.0)).norm(), 1e-3) << interval_ms;
    }
}

// 0.6 rad over 3 s: the outer antenna is faster by 2 m * 0.2 rad/s.
TEST(ReceiverWitness, OnTheOuterSideOfATurnIsNoFaster) {
    const Circle course{.radius_m = 300.0};
    Circle outer = course;
    outer.right_m = -2.0;
    outer.ahead_m = 1.0;
    const auto witness = receiver_witness<2>(recorded(outer), recorded(course));
    ASSERT_TRUE(witness);
    const auto by = witness->between(5.0, 8.0);
    ASSERT_TRUE(by);
    const Vector2d truth = moved(course, 5.0, 8.0);
    EXPECT_GT(moved(outer, 5.0, 8.0).norm() - truth.norm(), 1.0);
    EXPECT_LT((by->displacement_m - truth).norm(), 0.02);
    EXPECT_NEAR(witness->path_between(5.0, 8.0).value(), 180.0, 0.05);
    // Both ends, and what is not known of where the craft points: 15 mrad of 2.2 m.
    EXPECT_NEAR(by->covariance_m2(0, 0), 2.0 * (2.5e-5 + std::pow(0.015, 2) * 5.0), 1e-6);
}

TEST(ReceiverWitness, EndsWithAnArcAndAtAnUnusableEpoch) {
    const Circle course;
    TrajectoryTable other = trajectory_of(course);
    for (std::size_t k = 30; k < other.rows.size(); ++k)
        other.rows[k].arc = 2;
    other.rows[80].usable = false;
    const auto witness = receiver_witness<2>(track_of(other), recorded(course));
    ASSERT_TRUE(witness);
    EXPECT_TRUE(witness->between(0.5, 2.5));
    EXPECT_FALSE(witness->between(2.5, 3.5));
    EXPECT_TRUE(witness->between(3.5, 6.5));
    EXPECT_TRUE(witness->between(7.5, 8.5));
    EXPECT_FALSE(witness->between(7.5, 8.0));
    EXPECT_FALSE(witness->between(-1.0, 2.0));
    EXPECT_FALSE(witness->between(8.0, 11.0));
}

TEST(ReceiverWitness, NeedsATimeAndAFrameInCommon) {
    const Track own = recorded({});
    Track other = recorded({});
    EXPECT_TRUE(receiver_witness<2>(other, own));
    other.origin = FrameOrigin{.position = {}, .source = "attempt"};
    EXPECT_FALSE(receiver_witness<2>(other, own));
    other = recorded({});
    other.first_epoch.reset();
    EXPECT_FALSE(receiver_witness<2>(other, own));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
