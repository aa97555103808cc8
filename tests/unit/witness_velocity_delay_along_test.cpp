#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "late_speeds.h"
#include "witness/velocity_delay.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace velocities;
using late_speeds::always;
using late_speeds::Board;

constexpr double limit_s = 1.0;

struct Recorded {
    Board board = {.longer_s = 3.0, .sails_s = 3600.0};
    double duration_s = 1200.0;
    double interval_s = 1.0;
    double noise_m_s = 0.1;
    std::function<double(double)> delay_s = always(0.0);

    std::vector<SpeedPair> pairs() const {
        RandomGenerator random(7);
        std::vector<SpeedPair> pairs;
        for (int k = 0; interval_s * k < duration_s; ++k) {
            const double time_s = interval_s * k;
            const auto speed = [&](double at_s) {
                return std::max(0.0, board.at(at_s).speed_m_s + noise_m_s * random.normal());
            };
            pairs.push_back({.time_s = time_s,
                             .by_positions_m_s = speed(time_s),
                             .recorded_m_s = speed(time_s - delay_s(time_s))});
        }
        return pairs;
    }
};

TEST(DelaysAlong, OneDelayOfAnySizeIsFound) {
    for (const double interval_s : {0.2, 1.0, 2.0})
        for (const double delay_s : {0.0, 1.0, 2.0, 5.0, 20.0, 43.0, 55.0, 100.0, -7.0, -30.0}) {
            SCOPED_TRACE(delay_s);
            const auto pairs =
                Recorded{.interval_s = interval_s, .delay_s = always(delay_s)}.pairs();
            const auto stretches = delays_along(pairs, limit_s);
            ASSERT_EQ(stretches.size(), 1U);
            EXPECT_NEAR(stretches[0].delay_s, delay_s, 0.51 * interval_s);
            EXPECT_NEAR(stretches[0].delay_s, delay_s, 3.0 * stretches[0].sigma_s);
            EXPECT_LT(stretches[0].difference_m_s, 0.5);
            const bool surely = std::abs(delay_s) > limit_s + 2.0 * interval_s;
            EXPECT_TRUE(stretches[0].is_beyond(limit_s) || !surely) << stretches[0].sigma_s;
            EXPECT_FALSE(stretches[0].is_beyond(limit_s) && std::abs(delay_s) <= limit_s);
        }
}

TEST(DelaysAlong, SpeedsOfAnotherScaleHaveTheirDelayToo) {
    for (const double factor : {0.5, 0.9, 1.05, 1.5, 2.0})
        for (const double delay_s : {0.0, 20.0}) {
            SCOPED_TRACE(factor);
            auto pairs = Recorded{.delay_s = always(delay_s)}.pairs();
            for (SpeedPair& pair : pairs)
                *pair.recorded_m_s *= factor;
            const auto stretches = delays_along(pairs, limit_s);
            ASSERT_EQ(stretches.size(), 1U);
            EXPECT_NEAR(stretches[0].delay_s, delay_s, 0.51);
        }
}

TEST(DelaysAlong, LegsThatRepeatThemselvesAreTakenAsLateRatherThanEarly) {
    // Every 85 s the same: 43 s late and 42 s early differ by a second alone, and by the ends.
    const auto stretches =
        delays_along(Recorded{.board = {.sails_s = 1e4}, .delay_s = always(43.0)}.pairs(), limit_s);
    ASSERT_FALSE(stretches.empty());
    EXPECT_NEAR(stretches.back().delay_s, 43.0, 0.51);
}

TEST(DelaysAlong, OneThatChangesIsFoundWhereItChanges) {
    const auto lost = delays_along(
        Recorded{.duration_s = 3000.0,
                 .delay_s = [](double t) { return t > 1000.0 && t < 1600.0 ? 45.0 : 0.0; }}
            .pairs(),
        limit_s);
    ASSERT_EQ(lost.size(), 3U);
    EXPECT_NEAR(lost[1].delay_s, 45.0, 0.51);
    EXPECT_NEAR(static_cast<double>(lost[1].first), 1000.0, 31.0);
    EXPECT_NEAR(static_cast<double>(lost[1].last), 1600.0, 31.0);
    EXPECT_FALSE(lost[0].is_beyond(limit_s) || lost[2].is_beyond(limit_s));
    const auto growing = delays_along(
        Recorded{.duration_s = 3000.0, .delay_s = [](double t) { return t / 75.0; }}.pairs(),
        limit_s);
    ASSERT_GE(growing.size(), 4U);
    for (std::size_t k = 1; k < growing.size(); ++k)
        EXPECT_GT(growing[k].delay_s, growing[k - 1].delay_s);
    for (const DelayStretch& one : growing)
        EXPECT_NEAR(one.delay_s, 0.5 * static_cast<double>(one.first + one.last) / 75.0, 4.0);
}

TEST(DelaysAlong, DropoutsGapsAndOutliersDecideNothing) {
    std::vector<SpeedPair> pairs = Recorded{.delay_s = always(43.0)}.pairs();
    RandomGenerator random(3);
    std::vector<SpeedPair> kept;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        SpeedPair pair = pairs[k];
        if (random.normal() > 1.0) pair.recorded_m_s.reset();
        if (random.normal() > 2.0) pair.recorded_m_s = 300.0;
        if (random.normal() > 1.5) pair.by_positions_m_s.reset();
        if (k < 300 || k > 340) kept.push_back(pair);
    }
    const auto stretches = delays_along(kept, limit_s);
    ASSERT_EQ(stretches.size(), 1U);
    EXPECT_NEAR(stretches[0].delay_s, 43.0, 0.51);
}

TEST(DelaysAlong, SessionsHaveTheirOwn) {
    std::vector<SpeedPair> pairs = Recorded{.delay_s = always(0.0)}.pairs();
    for (const double later_s : {1e7, -5e6})
        for (SpeedPair pair : Recorded{.delay_s = always(20.0)}.pairs()) {
            pair.time_s += later_s;
            pairs.push_back(pair);
        }
    const auto stretches = delays_along(pairs, limit_s);
    ASSERT_EQ(stretches.size(), 2U);
    EXPECT_FALSE(stretches[0].is_beyond(limit_s));
    EXPECT_NEAR(stretches[1].delay_s, 20.0, 0.51);
}

TEST(DelaysAlong, WhatDoesNotChangeTellsNone) {
    EXPECT_TRUE(delays_along({}, limit_s).empty());
    EXPECT_TRUE(delays_along(std::vector<SpeedPair>(1), limit_s).empty());
    EXPECT_TRUE(delays_along(std::vector<SpeedPair>(500), limit_s).empty());
    std::vector<SpeedPair> pairs = Recorded{}.pairs();
    std::vector<SpeedPair> constant = pairs, still = pairs, backwards = pairs;
    RandomGenerator random(5);
    for (SpeedPair& pair : constant)
        pair.recorded_m_s = 12.0;
    for (SpeedPair& pair : still)
        pair.by_positions_m_s = pair.recorded_m_s = std::abs(0.3 * random.normal());
    std::ranges::reverse(backwards);
    EXPECT_TRUE(delays_along(constant, limit_s).empty());
    EXPECT_TRUE(delays_along(still, limit_s).empty());
    // Each row is a session, and its two speeds are of one moment.
    for (const DelayStretch& one : delays_along(backwards, limit_s))
        EXPECT_EQ(one.delay_s, 0.0);
}

TEST(DelaysAlong, SpeedsOfAnotherSessionTellNoneOfMostOfIt) {
    std::vector<SpeedPair> pairs = Recorded{.duration_s = 1800.0}.pairs();
    const auto others =
        Recorded{.board = {.leg_s = 37.0, .turn_s = 11.0, .longer_s = -0.4, .sails_s = 3600.0},
                 .duration_s = 1800.0}
            .pairs();
    std::size_t told = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k)
        pairs[k].recorded_m_s = others[k].recorded_m_s;
    for (const DelayStretch& one : delays_along(pairs, limit_s))
        told += one.last - one.first;
    EXPECT_LT(told, pairs.size() / 5);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
