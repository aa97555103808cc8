#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "stages/screen/decisions.h"
#include "stages/screen/screen.h"

namespace runcert::RUNCERT_FILE {
namespace {

// Positions that a receiver has filtered: smooth to a few millimetres, stated to half a metre. The
// craft goes north at 15 m/s and is stopped within 0.4 s, as by a fall.

struct Fall {
    bool velocities = true;
    double lag_s = 0.0;           ///< of the recorded velocities
    bool positions_only = false;  ///< the velocities go on as before: the positions drift
};

double speed_m_s(double time_s) {
    return 15.0 * std::clamp((20.2 - time_s) / 0.4, 0.0, 1.0);
}

EnuTable recorded(const Fall& fall) {
    RandomGenerator random(3);
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    double north_m = 0.0;
    for (int k = 0; k < 400; ++k) {
        const double time_s = 0.1 * k;
        for (int i = 0; k > 0 && i < 10; ++i)
            north_m += 0.01 * speed_m_s(time_s - 0.1 + 0.01 * (i + 0.5));
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time.nanoseconds = k * 100'000'000LL;
        row.east_m = 0.002 * random.normal();
        row.north_m = north_m + 0.002 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.5;
        row.fix = FixType::single;
        if (!fall.velocities) continue;
        row.recorded_velocity_east_m_s = 0.05 * random.normal();
        row.recorded_velocity_north_m_s =
            (fall.positions_only ? 15.0 : speed_m_s(time_s - fall.lag_s)) + 0.05 * random.normal();
        row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s = 0.1;
    }
    return table;
}

ScreenConfig board() {
    Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: board}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    return screen_config(attempt);
}

std::int64_t usable(const EnuTable& table, const ScreenConfig& config) {
    return summarise(screen(table, config).rows).usable;
}

TEST(FilteredPositions, AreNotRefusedForMovesHarderThanTheirNoise) {
    EXPECT_GE(usable(recorded({}), board()), 395);
    EXPECT_GE(usable(recorded({.lag_s = 0.3}), board()), 390);
    // With the white noise taken for what it seems to be the tests refuse good epochs.
    ScreenConfig as_fitted = board();
    as_fitted.noise_scale_min = 0.0;
    EXPECT_LT(usable(recorded({}), as_fitted), usable(recorded({}), board()));
    // Without velocities nothing could settle what then seems to be a drift.
    EXPECT_EQ(usable(recorded({.velocities = false}), as_fitted),
              usable(recorded({.velocities = false}), board()));
}

/// A ramp before row 5 of ten rows at 10 Hz, the positions changing from 10 m/s to 4 m/s there.
struct Ramp {
    std::vector<ScreenedEpoch> rows = std::vector<ScreenedEpoch>(60);
    std::vector<std::size_t> arc_rows;
    ArcDecisions decisions{60};

    Ramp() {
        for (std::size_t k = 0; k < 60; ++k) {
            ScreenedEpoch& row = rows[k];
            const double time_s = 0.1 * static_cast<double>(k);
            row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
            row.usable = true;
            row.arc = 1;
            row.east_m = 0.0;
            row.north_m = k < 30 ? 10.0 * time_s : 30.0 + 4.0 * (time_s - 3.0);
            row.up_m = row.north_m;
            arc_rows.push_back(k);
        }
        rows[0].break_before = ArcBreak::start;
        decisions.breaks[30] = ScreeningDecision{.hypothesis = Hypothesis::ramp,
                                                 .first = 30,
                                                 .last = 30,
                                                 .statistic = 99.0,
                                                 .threshold = 40.0,
                                                 .estimated = {}};
        decisions.breaks[30]->estimated.rate_north_m_s = -6.0;
    }
    /// Velocities north that change by so much, that much later.
    void record(double change_m_s, std::size_t later = 0) {
        for (std::size_t k = 0; k < 60; ++k) {
            rows[k].recorded_velocity_east_m_s = 0.0;
            rows[k].recorded_velocity_north_m_s = k < 30 + later ? 10.0 : 10.0 + change_m_s;
        }
    }
    std::int64_t left(TestedAxes axes = TestedAxes::horizontal, bool on_the_ground = true) {
        std::vector<ScreenedEpoch> marked = rows;
        mark_rows(marked, arc_rows, decisions, axes, on_the_ground);
        return std::ranges::count_if(marked, &ScreenedEpoch::usable);
    }
};

TEST(Drift, ThatTheRecordedVelocitiesShareIsMotion) {
    Ramp ramp;
    EXPECT_EQ(ramp.left(), 0);  // nobody can tell which side drifts
    ramp.record(-6.0);
    EXPECT_EQ(ramp.left(), 60);
    ramp.record(-6.0, 4);  // 0.4 s late
    EXPECT_EQ(ramp.left(), 60);
    ramp.record(-3.5);  // more than half of it
    EXPECT_EQ(ramp.left(), 60);
    ramp.record(-2.5);  // less than half
    EXPECT_EQ(ramp.left(), 0);
    ramp.record(0.0);  // the positions alone
    EXPECT_EQ(ramp.left(), 0);
    ramp.record(6.0);
    EXPECT_EQ(ramp.left(), 0);
    // Not told at one epoch beside it: not asked.
    ramp.record(-6.0);
    ramp.rows[20].recorded_velocity_north_m_s.reset();
    EXPECT_EQ(ramp.left(), 0);
}

TEST(Drift, OfHeightsIsAskedOfTheHorizontalVelocitiesForCraftsOnTheGround) {
    Ramp ramp;
    ramp.decisions.breaks[30]->estimated = {};
    ramp.decisions.breaks[30]->estimated.rate_up_m_s = -6.0;
    ramp.record(-6.0);
    EXPECT_EQ(ramp.left(TestedAxes::vertical), 60);
    EXPECT_EQ(ramp.left(TestedAxes::vertical, false), 0);
    // Where vertical velocities are recorded they are asked.
    for (ScreenedEpoch& row : ramp.rows)
        row.recorded_velocity_up_m_s = 10.0;
    EXPECT_EQ(ramp.left(TestedAxes::vertical), 0);
    for (std::size_t k = 30; k < 60; ++k)
        ramp.rows[k].recorded_velocity_up_m_s = 4.0;
    EXPECT_EQ(ramp.left(TestedAxes::vertical, false), 60);
}

TEST(Drift, ASideThatTheVelocitiesVouchForLosesNothing) {
    Ramp ramp;
    for (ScreenedEpoch& row : ramp.rows)
        row.sigma_east_m = row.sigma_north_m = 0.02;
    ramp.record(0.0);  // as the positions before the ramp: those after it drift
    EXPECT_EQ(ramp.left(), 30);
    for (ScreenedEpoch& row : ramp.rows)
        row.recorded_velocity_north_m_s = 4.0;  // as those after it
    EXPECT_EQ(ramp.left(), 30);
    for (ScreenedEpoch& row : ramp.rows)
        row.recorded_velocity_north_m_s = 7.0;  // as neither
    EXPECT_EQ(ramp.left(), 0);
    // Where the positions' own noise is as large as the rate nobody can tell.
    ramp.record(0.0);
    for (ScreenedEpoch& row : ramp.rows)
        row.sigma_east_m = row.sigma_north_m = 5.0;
    EXPECT_EQ(ramp.left(), 0);
}

/// 600 s at 1 Hz, and a drift of 10 m/s that begins or ends in the middle.
struct LongRamp {
    std::vector<ScreenedEpoch> rows = std::vector<ScreenedEpoch>(600);
    std::vector<std::size_t> arc_rows;
    ArcDecisions decisions{600};

    explicit LongRamp(double still_until_s = 0.0) {
        for (std::size_t k = 0; k < 600; ++k) {
            const auto time_s = static_cast<double>(k);
            rows[k].epoch = static_cast<std::int64_t>(k) + 1;
            rows[k].time.nanoseconds = static_cast<std::int64_t>(k) * 1'000'000'000;
            rows[k].usable = true;
            rows[k].arc = 1;
            rows[k].east_m = 0.0;
            rows[k].north_m = 10.0 * std::max(0.0, time_s - still_until_s);
            arc_rows.push_back(k);
        }
        decisions.breaks[300] = ScreeningDecision{.hypothesis = Hypothesis::ramp,
                                                  .first = 300,
                                                  .last = 300,
                                                  .statistic = 47.2,
                                                  .threshold = 42.8,
                                                  .estimated = {}};
        decisions.breaks[300]->estimated.rate_north_m_s = 10.0;
    }
};

TEST(Drift, ReachesAsFarAsAnErrorCanGrow) {
    LongRamp ramp;
    const auto largest =
        mark_rows(ramp.rows, ramp.arc_rows, ramp.decisions, TestedAxes::horizontal);
    for (std::size_t k = 0; k < 600; ++k)
        EXPECT_EQ(ramp.rows[k].usable, k < 200 || k > 400) << k;
    ASSERT_TRUE(largest);
    EXPECT_EQ(largest->hypothesis, Hypothesis::ramp);
    EXPECT_EQ(largest->first_epoch, 201);
    EXPECT_EQ(largest->last_epoch, 401);
    EXPECT_EQ(largest->epochs, 201);
    EXPECT_EQ(largest->statistic, 47.2);
}

TEST(Drift, DoesNotReachOverStandingStill) {
    LongRamp ramp(260.0);
    mark_rows(ramp.rows, ramp.arc_rows, ramp.decisions, TestedAxes::horizontal);
    EXPECT_TRUE(ramp.rows[255].usable);
    EXPECT_FALSE(ramp.rows[265].usable);
    EXPECT_FALSE(ramp.rows[400].usable);
}

TEST(Drift, ThatIsDatedLosesItsOwnSpan) {
    LongRamp ramp;
    ramp.decisions.breaks[330] = *ramp.decisions.breaks[300];
    ramp.decisions.breaks[330]->first = ramp.decisions.breaks[330]->last = 330;
    ramp.decisions.breaks[330]->estimated.rate_north_m_s = -10.0;
    for (const std::size_t k : {300U, 330U})
        ramp.decisions.breaks[k]->sigma_rate_m_s = 0.05;
    const auto largest =
        mark_rows(ramp.rows, ramp.arc_rows, ramp.decisions, TestedAxes::horizontal);
    for (std::size_t k = 0; k < 600; ++k)
        EXPECT_EQ(ramp.rows[k].usable, k < 300 || k >= 330) << k;
    EXPECT_EQ(largest.value().epochs, 30);
}

TEST(Losses, OfAStretchAreCountedWhateverWasDecidedBefore) {
    LongRamp ramp;
    ramp.decisions.breaks[300].reset();
    const ScreeningDecision stretch{.hypothesis = Hypothesis::model,
                                    .first = 100,
                                    .last = 199,
                                    .statistic = 99.0,
                                    .threshold = 40.0,
                                    .estimated = {}};
    for (std::size_t k = 100; k < 200; ++k)
        ramp.decisions.left_out[k] = stretch;
    for (const std::size_t k : {100U, 150U, 199U}) {
        ScreeningDecision outlier = stretch;
        outlier.hypothesis = Hypothesis::outlier;
        outlier.first = outlier.last = k;
        ramp.decisions.left_out[k] = outlier;
    }
    const auto largest =
        mark_rows(ramp.rows, ramp.arc_rows, ramp.decisions, TestedAxes::horizontal);
    ASSERT_TRUE(largest);
    EXPECT_EQ(largest->hypothesis, Hypothesis::model);
    EXPECT_GE(largest->epochs, 49);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
