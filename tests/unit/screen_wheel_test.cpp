#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "stages/screen/screen.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;

constexpr double length_s = 120.0;

ScreenConfig config() {
    return screen_config(
        read_attempt("schema: attempt/1.0\nid: t\ncraft: {name: t, class: car}\n"
                     "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
                     "attempt"));
}

/// A car that goes faster and slower on a wide curve.
double speed_at(double time_s) {
    return 20.0 + 9.0 * std::sin(0.3 * time_s);
}
double way_at(double time_s) {
    return 20.0 * time_s - 30.0 * std::cos(0.3 * time_s);
}
constexpr double radius_m = 2000.0;
Vector2d place_at(double time_s) {
    const double angle = way_at(time_s) / radius_m;
    return radius_m * Vector2d(std::sin(angle), 1.0 - std::cos(angle));
}
Vector2d along(double time_s) {
    const double angle = way_at(time_s) / radius_m;
    return {std::cos(angle), std::sin(angle)};
}

/// At 10 Hz with 10 mm of white noise; from 50 s on for ten seconds the positions drift forwards.
EnuTable positions(double drift_m_s, std::uint64_t seed) {
    RandomGenerator random(seed);
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    for (int k = 0; k <= std::lround(10.0 * length_s); ++k) {
        const double time_s = 0.1 * k;
        const double drifted_m = drift_m_s * std::clamp(time_s - 50.0, 0.0, 10.0);
        const Vector2d place = place_at(time_s) + drifted_m * along(time_s);
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {std::llround(time_s * 1e9)};
        row.east_m = place.x() + 0.010 * random.normal();
        row.north_m = place.y() + 0.010 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.fix = FixType::fixed;
    }
    return table;
}

/// As an attempt hands it in.
HandedIn handed_in(const std::vector<TimedValue>& speeds) {
    HandedIn given;
    given.attempt.wheel.emplace();
    MeasuredSeries& series = given.series["wheel"];
    for (const TimedValue& one : speeds)
        series.samples.push_back({.time_s = one.time_s, .value = one.value});
    return given;
}

std::vector<TimedValue> wheel(std::uint64_t seed) {
    RandomGenerator random(1000 + seed);
    std::vector<TimedValue> speeds;
    for (int k = 0; k <= std::lround(20.0 * length_s); ++k)
        speeds.push_back({.time_s = 0.05 * k,
                          .value = speed_at(0.05 * k - 0.2) / 1.013 + 0.05 * random.normal()});
    return speeds;
}

TEST(ScreenedBesideAWheel, CleanPositionsAreNotMarked) {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const std::vector<TimedValue> speeds = wheel(seed);
        const ScreenedTable clean =
            screen(positions(0.0, seed), config(), {.handed_in = handed_in(speeds)});
        alarms += summarise(clean.rows).usable != std::ssize(clean.rows);
        ASSERT_EQ(clean.basis.displacements.size(), 1U);
        const DisplacementComparison& found = clean.basis.displacements.front();
        EXPECT_EQ(found.kind, WitnessKind::wheel);
        ASSERT_FALSE(found.spreads.empty());
        EXPECT_LT(found.spreads.front().sd_m, 0.1);
    }
    EXPECT_EQ(alarms, 0);
}

TEST(ScreenedBesideAWheel, ADriftIsMarkedWithItsSizeAndDirection) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const std::vector<TimedValue> speeds = wheel(seed);
        EXPECT_EQ(summarise(screen(positions(0.4, seed), config()).rows).usable, 1201)
            << "by themselves the positions do not show it";
        const ScreenedTable drifting =
            screen(positions(0.4, seed), config(), {.handed_in = handed_in(speeds)});
        int marked = 0;
        for (const ScreenedEpoch& row : drifting.rows) {
            if (row.reason != Reason::wheel) continue;
            EXPECT_EQ(row.hypothesis, Hypothesis::wheel);
            EXPECT_GE(row.time.seconds(), 48.0);
            EXPECT_LE(row.time.seconds(), 62.0);
            EXPECT_GT(*row.statistic, *row.threshold);
            const Vector2d apart(row.estimated.east_m.value(), row.estimated.north_m.value());
            EXPECT_GT(apart.dot(along(row.time.seconds())), 0.4);
            ++marked;
        }
        found += marked > 10;
        EXPECT_EQ(drifting.basis.displacements.front().rejected, marked);
    }
    EXPECT_GE(found, 9);
}

// A wheel that stands still while the craft moves, or is of another time, is no witness.
TEST(ScreenedBesideAWheel, OneThatSaysNothingIsNotCompared) {
    std::vector<TimedValue> nothing = wheel(1);
    for (TimedValue& one : nothing)
        one.value = 0.0;
    EXPECT_TRUE(screen(positions(0.0, 1), config(), {.handed_in = handed_in(nothing)})
                    .basis.displacements.empty());
    std::vector<TimedValue> later = wheel(1);
    for (TimedValue& one : later)
        one.time_s += 1000.0;
    EXPECT_TRUE(screen(positions(0.0, 1), config(), {.handed_in = handed_in(later)})
                    .basis.displacements.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
