#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/random.h"
#include "witness/runs.h"

namespace runcert::RUNCERT_FILE {
namespace {

struct Velocity {
    double speed_m_s = 0.0;
    double heading_deg = 0.0;
};

/// Rows at 10 Hz, all with an estimate, moving as a function of time (s) says.
std::vector<TrajectoryEpoch> moving(double duration_s,
                                    const std::function<Velocity(double)>& velocity_at,
                                    double sigma_m_s = 0.0) {
    RandomGenerator random(7);
    std::vector<TrajectoryEpoch> rows;
    double east_m = 0.0, north_m = 0.0;
    for (std::int64_t k = 0; k <= std::llround(10.0 * duration_s); ++k) {
        const Velocity velocity = velocity_at(0.1 * static_cast<double>(k));
        const double heading = velocity.heading_deg * std::numbers::pi / 180.0;
        TrajectoryEpoch& row = rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.velocity_east_m_s = velocity.speed_m_s * std::sin(heading);
        row.velocity_north_m_s = velocity.speed_m_s * std::cos(heading);
        east_m += 0.1 * *row.velocity_east_m_s;
        north_m += 0.1 * *row.velocity_north_m_s;
        row.east_m = east_m;
        row.north_m = north_m;
        *row.velocity_east_m_s += sigma_m_s * random.normal();
        *row.velocity_north_m_s += sigma_m_s * random.normal();
        row.speed_m_s = std::hypot(*row.velocity_east_m_s, *row.velocity_north_m_s);
        row.arc = 1;
        row.usable = true;
    }
    return rows;
}

/// Linear between (time, value) corners, constant outside them.
double between(std::initializer_list<std::pair<double, double>> corners, double time_s) {
    std::pair<double, double> last = *corners.begin();
    if (time_s <= last.first) return last.second;
    for (const auto& corner : corners) {
        if (time_s <= corner.first && corner.first > last.first)
            return last.second + (corner.second - last.second) * (time_s - last.first) /
                                     (corner.first - last.first);
        last = corner;
    }
    return last.second;
}

void remove_estimate(std::vector<TrajectoryEpoch>& rows, std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
        TrajectoryEpoch row;
        row.epoch = rows[i].epoch;
        row.time = rows[i].time;
        rows[i] = row;
    }
}

void expect_run(const CraftRun& run, std::size_t first, std::size_t last, RunEdge began,
                RunEdge ended) {
    EXPECT_EQ(run.first_row, first);
    EXPECT_EQ(run.last_row, last);
    EXPECT_EQ(run.began, began);
    EXPECT_EQ(run.ended, ended);
}

TEST(Runs, StopAndGoAreTwoFromStandingToStanding) {
    // At 2.1 m/s^2 from 10 s on: 0.84 m/s at 10.4 s, 1.05 at 10.5; down the same way.
    const auto rows = moving(80.0, [](double t) {
        return Velocity{between({{10, 0}, {20, 21}, {30, 0}, {50, 0}, {60, 21}, {70, 0}}, t), 40};
    });
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 2u);
    expect_run(runs[0], 104, 296, RunEdge::standing, RunEdge::standing);
    expect_run(runs[1], 504, 696, RunEdge::standing, RunEdge::standing);
    EXPECT_EQ(runs[0].stood_from_row, 0u);
    EXPECT_EQ(runs[1].stood_from_row, 296u);
}

TEST(Runs, AShortStopIsWithinTheRunAndALongOneIsNot) {
    for (const auto& [stop_s, count] : {std::pair{4.0, 1u}, {6.0, 2u}}) {
        const auto rows = moving(60.0, [stop_s = stop_s](double t) {
            return Velocity{t > 20.0 && t < 20.0 + stop_s ? 0.5 : 10.0, 0.0};
        });
        const auto runs = runs_in(rows);
        ASSERT_EQ(runs.size(), count) << stop_s;
        EXPECT_EQ(runs.front().began, RunEdge::recording);
        EXPECT_EQ(runs.back().ended, RunEdge::recording);
        EXPECT_EQ(runs.back().last_row, 600u);
    }
}

TEST(Runs, DipsBeforeItWasFastAreNotPartOfIt) {
    const auto rows = moving(30.0, [](double t) {
        return Velocity{t < 5.0 ? 1.5 : t < 6.05 ? 0.5 : t < 8.0 ? 1.5 : 10.0, 0.0};
    });
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 1u);
    expect_run(runs[0], 60, 300, RunEdge::standing, RunEdge::recording);
    EXPECT_EQ(runs[0].stood_from_row, 50u);
}

TEST(Runs, WithoutAFastPartThereIsNone) {
    EXPECT_TRUE(runs_in(moving(60.0, [](double) { return Velocity{1.9, 0.0}; })).empty());
    EXPECT_EQ(runs_in(moving(60.0, [](double) { return Velocity{2.1, 0.0}; })).size(), 1u);
    EXPECT_TRUE(runs_in({}).empty());
}

TEST(Runs, EndsWhereItStopsForGood) {
    // The last rows are below the limit for less than stop_s.
    const auto rows = moving(23.0, [](double t) { return Velocity{t < 20.95 ? 8.0 : 0.2, 0.0}; });
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 1u);
    expect_run(runs[0], 0, 210, RunEdge::recording, RunEdge::standing);
}

TEST(Runs, OutAndBackIsCutWhereItIsSlowest) {
    // Turns to the right by 180 degrees over 20 s, slowest (3 m/s) in the middle of that, at 50 s.
    const auto rows = moving(
        100.0,
        [](double t) {
            return Velocity{between({{0, 20}, {30, 20}, {50, 3}, {70, 20}}, t),
                            between({{0, 60}, {40, 60}, {60, 240}}, t)};
        },
        0.02);
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_NEAR(static_cast<double>(runs[0].last_row), 500.0, 3.0);
    expect_run(runs[0], 0, runs[1].first_row, RunEdge::recording, RunEdge::turn);
    expect_run(runs[1], runs[0].last_row, 1000, RunEdge::turn, RunEdge::recording);
}

TEST(Runs, AShortStandAtTheTurnBeginsTheNextAtItsEnd) {
    const auto rows = moving(100.0, [](double t) {
        return Velocity{std::abs(t - 50.0) < 1.45 ? 0.4 : 8.0, t < 50.0 ? 10.0 : 190.0};
    });
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_EQ(runs[0].ended, RunEdge::turn);
    EXPECT_GE(runs[0].last_row, 486u);
    expect_run(runs[1], 514, 1000, RunEdge::standing, RunEdge::recording);
}

TEST(Runs, TurnsByNoMoreThanTheLimitAreOneRun) {
    const auto turning_by = [](double angle_deg) {
        return runs_in(moving(60.0,
                              [angle_deg](double t) {
                                  return Velocity{
                                      12.0,
                                      between({{0, 350}, {30, 350}, {31, 350 + angle_deg}}, t)};
                              }))
            .size();
    };
    EXPECT_EQ(turning_by(85.0), 1u);
    EXPECT_EQ(turning_by(-85.0), 1u);
    EXPECT_EQ(turning_by(95.0), 2u);
    EXPECT_EQ(turning_by(-95.0), 2u);
}

TEST(Runs, NorthIsNoTurn) {
    const auto rows = moving(60.0, [](double t) {
        return Velocity{12.0, 360.0 + 20.0 * std::sin(t)};
    });
    EXPECT_EQ(runs_in(rows).size(), 1u);
}

TEST(Runs, RepeatedTurnsAreCutEach) {
    // A circle of 40 s: the run so far has a direction, that of the chord; each cut begins anew.
    const auto rows = moving(400.0, [](double t) { return Velocity{15.0, 9.0 * t}; });
    const auto runs = runs_in(rows);
    // The chord of an arc of angle a lies a/2 off its end: 90 degrees after about half a circle.
    ASSERT_GE(runs.size(), 16u);
    EXPECT_LE(runs.size(), 24u);
    for (std::size_t i = 1; i < runs.size(); ++i) {
        EXPECT_EQ(runs[i].first_row, runs[i - 1].last_row);
        EXPECT_GT(runs[i].last_row, runs[i].first_row + 20);
    }
}

TEST(Runs, SpanAShortGapAndEndAtALongOne) {
    const auto all = moving(60.0, [](double) { return Velocity{12.0, 0.0}; });
    auto rows = all;
    remove_estimate(rows, 201, 250);  // 5.0 s from row 200 to row 250
    auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 1u);
    expect_run(runs[0], 0, 600, RunEdge::recording, RunEdge::recording);
    remove_estimate(rows, 250, 251);
    runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 2u);
    expect_run(runs[0], 0, 200, RunEdge::recording, RunEdge::gap);
    expect_run(runs[1], 251, 600, RunEdge::gap, RunEdge::recording);
    EXPECT_FALSE(runs[1].stood_from_row.has_value());
}

TEST(Runs, AGapAfterAStopIsAStop) {
    auto rows = moving(60.0, [](double t) { return Velocity{t < 20.0 ? 12.0 : 0.1, 0.0}; });
    remove_estimate(rows, 0, 10);
    remove_estimate(rows, 210, 300);
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 1u);
    expect_run(runs[0], 10, 200, RunEdge::recording, RunEdge::standing);
}

TEST(Runs, ThresholdsAreTheCallers) {
    const auto rows = moving(60.0, [](double t) { return Velocity{12.0, t < 30.0 ? 0.0 : 60.0}; });
    EXPECT_EQ(runs_in(rows).size(), 1u);
    EXPECT_EQ(runs_in(rows, {.turn_deg = 45.0}).size(), 2u);
    EXPECT_EQ(runs_in(rows, {.start_m_s = 13.0}).size(), 0u);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
