#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "stages/screen/time_order.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Rows = std::vector<EnuEpoch>;

/// Along a slow curve at 20 m/s, ten times a second.
Rows recorded(std::size_t epochs, double from_s = 0.0) {
    Rows rows(epochs);
    for (std::size_t k = 0; k < epochs; ++k) {
        const double t_s = from_s + 0.1 * static_cast<double>(k);
        rows[k].epoch = static_cast<std::int64_t>(k) + 1;
        rows[k].time.nanoseconds = std::llround(t_s * 1e9);
        rows[k].fix = FixType::fixed;
        rows[k].east_m = 500.0 * std::sin(20.0 * t_s / 500.0);
        rows[k].north_m = 500.0 * std::cos(20.0 * t_s / 500.0);
        rows[k].sigma_east_m = rows[k].sigma_north_m = 0.02;
    }
    return rows;
}

TimeOrder ordered(const Rows& rows) {
    return order_by_time(rows, {.interval_s = 0.1});
}

void shift(Rows& rows, std::size_t first, std::size_t count, double by_s) {
    for (std::size_t k = first; k < std::min(first + count, rows.size()); ++k)
        rows[k].time.nanoseconds += std::llround(by_s * 1e9);
}

std::vector<std::size_t> left_out(const TimeOrder& order) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < order.standing.size(); ++k)
        if (order.standing[k] != TimeStanding::in_order) rows.push_back(k);
    return rows;
}

/// What holds whatever was recorded: each row once, those kept in strictly increasing time.
void expect_in_order(const Rows& rows, const TimeOrder& order) {
    std::vector<std::size_t> each = order.rows;
    std::ranges::sort(each);
    std::vector<std::size_t> all(rows.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    EXPECT_EQ(each, all);
    std::int64_t latest_ns = std::numeric_limits<std::int64_t>::min();
    for (const std::size_t k : order.rows) {
        if (order.standing[k] != TimeStanding::in_order) continue;
        EXPECT_GT(rows[k].time.nanoseconds, latest_ns);
        latest_ns = rows[k].time.nanoseconds;
    }
}

TEST(TimeOrder, OfAGoodRecordingIsItsOwn) {
    const Rows rows = recorded(500);
    const TimeOrder order = ordered(rows);
    EXPECT_TRUE(left_out(order).empty());
    EXPECT_EQ(order.moved, 0);
    EXPECT_TRUE(std::ranges::is_sorted(order.rows));
}

TEST(TimeOrder, OfEpochsNextToNoTimeApartOneStays) {
    Rows rows = recorded(500);
    shift(rows, 200, 1, 0.096);
    shift(rows, 300, 1, 0.094);
    const TimeOrder order = ordered(rows);
    expect_in_order(rows, order);
    EXPECT_EQ(left_out(order), std::vector<std::size_t>{201});
    EXPECT_EQ(order.standing[201], TimeStanding::same_time);
}

TEST(TimeOrder, FewEpochsAheadOrBehindAreLeftOutAndNothingElse) {
    constexpr double day_s = 86'400.0;
    for (const std::size_t count : {1U, 2U, 3U, 30U})
        for (const double by_s : {3.7, 20.0, 1200.0, day_s, 1024 * 7 * day_s})
            for (const double sign : {1.0, -1.0}) {
                SCOPED_TRACE(fmt::format("{} by {} s", count, sign * by_s));
                Rows rows = recorded(701);
                shift(rows, 120, count, sign * by_s);
                const TimeOrder order = ordered(rows);
                expect_in_order(rows, order);
                std::vector<std::size_t> shifted(count);
                std::iota(shifted.begin(), shifted.end(), std::size_t{120});
                EXPECT_EQ(left_out(order), shifted);
            }
}

TEST(TimeOrder, FewAtTheBeginningOrTheEndAreLeftOutToo) {
    for (const std::size_t from : {0U, 698U})
        for (const double by_s : {1200.0, -1200.0, 86'400.0, -86'400.0}) {
            SCOPED_TRACE(fmt::format("from {} by {} s", from, by_s));
            Rows rows = recorded(701);
            shift(rows, from, 3, by_s);
            EXPECT_EQ(left_out(ordered(rows)),
                      (std::vector<std::size_t>{from, from + 1, from + 2}));
        }
}

TEST(TimeOrder, OfFewByAnIntervalOneIsLeftOut) {
    for (const double by_s : {0.1, -0.1}) {
        Rows rows = recorded(701);
        shift(rows, 120, 1, by_s);
        const TimeOrder order = ordered(rows);
        ASSERT_EQ(left_out(order).size(), 1U);
        EXPECT_EQ(order.standing[left_out(order).front()], TimeStanding::same_time);
    }
}

TEST(TimeOrder, ALaterSessionThatWasWrittenFirstStandsBehind) {
    Rows rows = recorded(300, 7200.0);
    for (const EnuEpoch& row : recorded(701))
        rows.push_back(row);
    const TimeOrder order = ordered(rows);
    EXPECT_TRUE(left_out(order).empty());
    EXPECT_EQ(order.moved, 701);
    EXPECT_EQ(order.rows.front(), 300U);
    EXPECT_EQ(order.rows.back(), 299U);
}

TEST(TimeOrder, BlocksThatFitAreJoinedWhereTheMotionGoesOn) {
    const Rows rows = recorded(600);
    Rows shuffled(rows.begin() + 200, rows.begin() + 400);
    shuffled.insert(shuffled.end(), rows.begin(), rows.begin() + 200);
    shuffled.insert(shuffled.end(), rows.begin() + 400, rows.end());
    const TimeOrder order = ordered(shuffled);
    EXPECT_TRUE(left_out(order).empty());
    EXPECT_EQ(std::ranges::count(order.seam, true), 0);
    std::int64_t epoch = 0;
    for (const std::size_t k : order.rows)
        EXPECT_EQ(shuffled[k].epoch, ++epoch);
}

TEST(TimeOrder, WhatRepeatsAnotherStandsBehindItAndIsNotOutOfOrder) {
    const Rows rows = recorded(600);
    Rows again(rows.begin(), rows.begin() + 400);
    again.insert(again.end(), rows.begin() + 100, rows.end());
    const TimeOrder order = ordered(again);
    expect_in_order(again, order);
    EXPECT_EQ(std::ranges::count(order.standing, TimeStanding::repeated), 300);
    EXPECT_EQ(std::ranges::count(order.standing, TimeStanding::in_order), 600);
    for (std::size_t i = 1; i < order.rows.size(); ++i)
        EXPECT_LE(again[order.rows[i - 1]].time.nanoseconds, again[order.rows[i]].time.nanoseconds);
}

TEST(TimeOrder, OfManyPositionsWithOneStampOneIsKept) {
    Rows rows = recorded(600);
    for (EnuEpoch& row : rows)
        row.time.nanoseconds = row.time.nanoseconds / 1'000'000'000 * 1'000'000'000;
    const TimeOrder order = ordered(rows);
    EXPECT_EQ(std::ranges::count(order.standing, TimeStanding::in_order), 60);
    EXPECT_EQ(std::ranges::count(order.standing, TimeStanding::same_time), 540);
}

TEST(TimeOrder, OfOverlappingSessionsTheOverlapIsOnesAlone) {
    Rows rows = recorded(1000);
    shift(rows, 500, 500, -5.0);
    const TimeOrder order = ordered(rows);
    expect_in_order(rows, order);
    EXPECT_EQ(left_out(order).size(), 50U);
}

TEST(TimeOrder, AStuckClockIsJudgedInLittleTime) {
    Rows rows = recorded(200'000);
    for (std::size_t k = 100'000; k < rows.size(); ++k)
        rows[k].time = rows[100'000].time;
    const TimeOrder order = ordered(rows);
    EXPECT_EQ(std::ranges::count(order.standing, TimeStanding::in_order), 100'001);
}

TEST(TimeOrder, AnyPermutationOfBlocksIsUndone) {
    RandomGenerator random(44);
    const auto below = [&](std::size_t bound) {
        return static_cast<std::size_t>(random.uniform() * static_cast<double>(bound));
    };
    for (int draw = 0; draw < 500; ++draw) {
        const Rows rows = recorded(300);
        std::vector<std::size_t> cuts{0, rows.size()};
        for (std::size_t k = 1 + below(6); k > 0; --k)
            cuts.push_back(below(rows.size()));
        std::ranges::sort(cuts);
        std::vector<Rows> blocks;
        for (std::size_t k = 1; k < cuts.size(); ++k)
            blocks.emplace_back(rows.begin() + static_cast<std::ptrdiff_t>(cuts[k - 1]),
                                rows.begin() + static_cast<std::ptrdiff_t>(cuts[k]));
        for (std::size_t k = blocks.size(); k > 1; --k)
            std::swap(blocks[k - 1], blocks[below(k)]);
        Rows shuffled;
        for (const Rows& block : blocks)
            shuffled.insert(shuffled.end(), block.begin(), block.end());
        const TimeOrder order = ordered(shuffled);
        SCOPED_TRACE(draw);
        expect_in_order(shuffled, order);
        EXPECT_TRUE(left_out(order).empty());
        EXPECT_EQ(std::ranges::count(order.seam, true), 0);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
