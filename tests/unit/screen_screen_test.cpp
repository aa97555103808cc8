#include "stages/screen/screen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/screen/decisions.h"

namespace runcert::RUNCERT_FILE {
namespace {

ScreenConfig config() {
    const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    return screen_config(attempt);
}

/// A run at 30 m/s with 10 mm noise at 10 Hz, fixed, with true stated standard deviations.
EnuTable clean_run(std::size_t epochs, std::uint64_t seed = 1) {
    RandomGenerator random(seed);
    EnuTable table;
    table.facts = {.receiver = "primary",
                   .first_epoch = std::nullopt,
                   .georeferenced = true,
                   .vertical_measured = true,
                   .nominal_interval_s = 0.1};
    for (std::size_t k = 0; k < epochs; ++k) {
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        row.east_m = 3.0 * static_cast<double>(k) + 0.01 * random.normal();
        row.north_m = 0.01 * random.normal();
        row.up_m = 0.02 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.01;
        row.sigma_up_m = 0.02;
        row.fix = FixType::fixed;
    }
    return table;
}

TEST(Screen, ACleanRunIsOneArcAndAllUsable) {
    const ScreenedTable screened = screen(clean_run(400), config());
    const ScreeningSummary summary = summarise(screened.rows);
    EXPECT_EQ(summary.usable, 400);
    EXPECT_EQ(summary.arcs, 1);
    EXPECT_EQ(screened.rows[0].break_before, ArcBreak::start);
    EXPECT_GE(screened.variance_factor, 1.0);
    EXPECT_LT(screened.variance_factor, 1.3);
    for (std::size_t k = 3; k < 400; ++k) {
        ASSERT_TRUE(screened.rows[k].statistic.has_value());
        EXPECT_LE(*screened.rows[k].statistic, *screened.rows[k].threshold);
    }
}

struct EpochCase {
    const char* name;
    void (*damage)(EnuTable&);
    Reason reason;
};

TEST(Screen, EachEpochByItself) {
    const EpochCase cases[] = {
        {"no position", [](EnuTable& t) { t.rows[50].east_m.reset(); }, Reason::no_position},
        {"no height", [](EnuTable& t) { t.rows[50].up_m.reset(); }, Reason::no_position},
        {"half the earth away", [](EnuTable& t) { t.rows[50].east_m = 1.0e7; },
         Reason::far_position},
        {"no fix", [](EnuTable& t) { t.rows[50].fix = FixType::none; }, Reason::no_fix},
        {"float", [](EnuTable& t) { t.rows[50].fix = FixType::float_ambiguities; },
         Reason::float_ambiguities},
        {"single", [](EnuTable& t) { t.rows[50].fix = FixType::single; }, Reason::other_fix},
        {"same time", [](EnuTable& t) { t.rows[50].time = t.rows[49].time; },
         Reason::duplicate_time},
        {"backward", [](EnuTable& t) { t.rows[50].time = t.rows[40].time; }, Reason::backward_time},
        {"no accuracy", [](EnuTable& t) { t.rows[50].sigma_north_m.reset(); },
         Reason::accuracy_missing},
        {"no vertical accuracy", [](EnuTable& t) { t.rows[50].sigma_up_m.reset(); },
         Reason::accuracy_missing},
        {"four satellites", [](EnuTable& t) { t.rows[50].satellites = 4; }, Reason::few_satellites},
        {"ratio", [](EnuTable& t) { t.rows[50].ratio = 1.4; }, Reason::low_ratio},
        {"old corrections", [](EnuTable& t) { t.rows[50].age_s = 31.0; }, Reason::old_corrections},
        {"optimistic", [](EnuTable& t) { t.rows[50].sigma_east_m = 1e-6; },
         Reason::accuracy_absurd},
        {"pessimistic", [](EnuTable& t) { t.rows[50].sigma_up_m = 1.7e6; },
         Reason::accuracy_absurd},
        {"correlation of two", [](EnuTable& t) { t.rows[50].correlation_east_north = 2.0; },
         Reason::accuracy_absurd},
        {"not positive definite",
         [](EnuTable& t) {
             t.rows[50].correlation_east_north = 0.9;
             t.rows[50].correlation_east_up = 0.9;
             t.rows[50].correlation_north_up = -0.9;
         },
         Reason::accuracy_absurd}};
    for (const EpochCase& one : cases) {
        SCOPED_TRACE(one.name);
        EnuTable table = clean_run(100);
        one.damage(table);
        const ScreenedTable screened = screen(table, config());
        EXPECT_EQ(screened.rows.size(), 100U);
        EXPECT_FALSE(screened.rows[50].usable);
        EXPECT_EQ(screened.rows[50].reason, one.reason) << to_text(screened.rows[50].reason);
        EXPECT_EQ(summarise(screened.rows).usable, 99);
        // The arc goes on over a sample that is missing.
        EXPECT_EQ(screened.rows[51].break_before, std::nullopt);
        EXPECT_EQ(screened.rows[51].arc, 1);
    }
}

TEST(Screen, AGapEndsTheArc) {
    EnuTable table = clean_run(100);
    table.rows.erase(table.rows.begin() + 40, table.rows.begin() + 65);
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(summarise(screened.rows).arcs, 2);
    EXPECT_EQ(screened.rows[39].arc, 1);
    EXPECT_EQ(screened.rows[40].arc, 2);
    EXPECT_EQ(screened.rows[40].break_before, ArcBreak::gap);
}

TEST(Screen, OneOutlierIsRejectedAndTheArcGoesOn) {
    EnuTable table = clean_run(200);
    *table.rows[100].north_m += 0.3;
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(screened.rows[100].reason, Reason::outlier);
    EXPECT_EQ(screened.rows[100].hypothesis, Hypothesis::outlier);
    EXPECT_NEAR(*screened.rows[100].estimated.north_m, 0.3,
                4.0 * *screened.rows[100].estimated.sigma_north_m);
    EXPECT_GT(*screened.rows[100].statistic, *screened.rows[100].threshold);
    EXPECT_EQ(screened.rows[100].arc, 1);
    EXPECT_EQ(summarise(screened.rows).usable, 199);
    EXPECT_EQ(summarise(screened.rows).arcs, 1);
}

TEST(Screen, AStepIsABreakAtItsFirstEpoch) {
    EnuTable table = clean_run(200);
    for (std::size_t k = 100; k < 200; ++k)
        *table.rows[k].north_m += 0.5;
    const ScreenedTable screened = screen(table, config());
    EXPECT_NEAR(*screened.rows[100].estimated.north_m, 0.5,
                4.0 * *screened.rows[100].estimated.sigma_north_m);
    EXPECT_EQ(summarise(screened.rows).arcs, 2);
    EXPECT_EQ(screened.rows[99].arc, 1);
    EXPECT_EQ(screened.rows[100].arc, 2);
    EXPECT_EQ(screened.rows[100].break_before, ArcBreak::step);
    EXPECT_GT(*screened.rows[100].statistic, *screened.rows[100].threshold);
    EXPECT_EQ(summarise(screened.rows).usable, 200);
}

TEST(Screen, LateStampsAreAJumpAlongTheTrack) {
    // Positions at 30 m/s that are 20 ms older than their stamps say.
    EnuTable table = clean_run(200);
    for (std::size_t k = 100; k < 200; ++k)
        *table.rows[k].east_m -= 0.6;
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(screened.rows[100].break_before, ArcBreak::time_shift);
    EXPECT_NEAR(*screened.rows[100].estimated.time_s, 0.020, 0.002);
    EXPECT_EQ(summarise(screened.rows).usable, 200);
}

TEST(Screen, ABurstIsLeftOutWhole) {
    // Errors of their own in every direction, which a test of one epoch at a time would mask.
    EnuTable table = clean_run(300);
    for (std::size_t k = 150; k < 158; ++k) {
        *table.rows[k].east_m += 0.4 * std::cos(2.4 * static_cast<double>(k));
        *table.rows[k].north_m += 0.4 * std::sin(2.4 * static_cast<double>(k));
    }
    const ScreenedTable screened = screen(table, config());
    for (std::size_t k = 0; k < 300; ++k)
        EXPECT_EQ(screened.rows[k].usable, k < 150 || k >= 158) << k;
    EXPECT_EQ(screened.rows[150].arc, 1);
    EXPECT_EQ(summarise(screened.rows).arcs, 1);
}

// A gap is judged by time: up to two seconds are bridged, whatever the rate.
TEST(Screen, AGapIsJudgedByTime) {
    const auto arcs_without = [](std::size_t missing) {
        EnuTable table = clean_run(400);
        table.rows.erase(table.rows.begin() + 200,
                         table.rows.begin() + 200 + static_cast<std::ptrdiff_t>(missing));
        return summarise(screen(table, config()).rows).arcs;
    };
    EXPECT_EQ(arcs_without(1), 1);
    EXPECT_EQ(arcs_without(19), 1);
    EXPECT_EQ(arcs_without(20), 2);
    // The same for epochs that are there and cannot be used.
    const auto arcs_unusable = [](std::size_t unusable) {
        EnuTable table = clean_run(400);
        for (std::size_t k = 200; k < 200 + unusable; ++k)
            table.rows[k].fix = FixType::float_ambiguities;
        return summarise(screen(table, config()).rows).arcs;
    };
    EXPECT_EQ(arcs_unusable(19), 1);
    EXPECT_EQ(arcs_unusable(20), 2);
}

TEST(Screen, ADriftIsLeftOutOnBothSidesOfItsBeginning) {
    EnuTable table = clean_run(300);
    for (std::size_t k = 150; k < 300; ++k)
        *table.rows[k].north_m += 0.2 * static_cast<double>(k - 150);
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(summarise(screened.rows).usable, 0);
    EXPECT_EQ(screened.rows[10].reason, Reason::model);
    EXPECT_EQ(screened.rows[200].hypothesis, Hypothesis::ramp);
    EXPECT_NEAR(*screened.rows[200].estimated.rate_north_m_s, 2.0, 0.2);
}

TEST(Screen, AStepWhoseFirstEpochIsLeftOutShowsAtTheNext) {
    std::vector<ScreenedEpoch> rows(8);
    std::vector<std::size_t> arc_rows;
    ArcDecisions decisions(8);
    for (std::size_t k = 0; k < 8; ++k) {
        rows[k].usable = true;
        rows[k].arc = 1;
        arc_rows.push_back(k);
    }
    rows[0].break_before = ArcBreak::start;
    decisions.breaks[3] = ScreeningDecision{.hypothesis = Hypothesis::step,
                                            .first = 3,
                                            .last = 3,
                                            .statistic = 99.0,
                                            .threshold = 40.0,
                                            .estimated = {}};
    decisions.left_out[3] = ScreeningDecision{.hypothesis = Hypothesis::outlier,
                                              .first = 3,
                                              .last = 3,
                                              .statistic = 88.0,
                                              .threshold = 40.0,
                                              .estimated = {}};
    mark_rows(rows, arc_rows, decisions, TestedAxes::horizontal);
    finish_arcs(rows, 20.0, 2);
    EXPECT_EQ(rows[3].reason, Reason::outlier);
    EXPECT_EQ(rows[3].statistic, 88.0);
    EXPECT_EQ(rows[4].break_before, ArcBreak::step);
    EXPECT_EQ(rows[4].hypothesis, Hypothesis::step);
    EXPECT_EQ(rows[4].statistic, 99.0);
    EXPECT_EQ(rows[2].arc, 1);
    EXPECT_EQ(rows[4].arc, 2);
}

TEST(Screen, AStepAndAnOutlierOnItsFirstEpochsLeaveNoWindowAcrossThem) {
    EnuTable table = clean_run(200);
    for (std::size_t k = 100; k < 200; ++k)
        *table.rows[k].north_m += 0.5;
    *table.rows[100].east_m += 3.0;
    *table.rows[101].north_m -= 2.0;
    const ScreenedTable screened = screen(table, config());
    EXPECT_FALSE(screened.rows[100].usable);
    EXPECT_FALSE(screened.rows[101].usable);
    // What hides the step is left out with it: a run of outliers, no longer than those tested.
    EXPECT_GE(summarise(screened.rows).usable, 180);
    for (std::size_t k = 0; k < 95; ++k)
        EXPECT_TRUE(screened.rows[k].usable) << k;
}

TEST(Screen, WrongHeightsAloneAreFound) {
    EnuTable table = clean_run(200);
    *table.rows[80].up_m += 1.0;
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(screened.rows[80].reason, Reason::outlier);
    EXPECT_EQ(screened.rows[80].tested_axes, TestedAxes::vertical);
    EXPECT_NEAR(*screened.rows[80].estimated.up_m, 1.0, 0.1);
    EXPECT_EQ(summarise(screened.rows).usable, 199);
}

TEST(Screen, AFaultThatShowsAsThreeTimesTheSpeedIsLeftOut) {
    // The shape that [DHD22] tell of their vehicle trial: for two seconds a vehicle at 27 m/s shows
    // speeds up to 75 m/s, as the positions run ahead and come back.
    EnuTable table = clean_run(800);
    for (std::size_t k = 0; k < table.rows.size(); ++k)
        *table.rows[k].east_m *= 27.0 / 30.0;
    for (std::size_t k = 400; k < 420; ++k)
        *table.rows[k].east_m += 4.8 * static_cast<double>(k < 410 ? k - 399 : 419 - k);
    const ScreenedTable screened = screen(table, config());
    for (std::size_t k = 0; k < table.rows.size(); ++k)
        EXPECT_EQ(screened.rows[k].usable, k < 400 || k >= 419) << k;
}

TEST(Screen, EveryEpochSaysWhatWouldHaveBeenFound) {
    const ScreenedTable screened = screen(clean_run(300), config());
    for (std::size_t k = 10; k < 290; ++k) {
        const MinimalDetectableBias& size = screened.rows[k].detectable;
        ASSERT_TRUE(size.outlier_m && size.step_m && size.ramp_m_s && size.outlier_up_m);
        // Above the noise, of 10 mm, and far below what would make a record.
        EXPECT_GT(*size.outlier_m, 0.03);
        EXPECT_LT(*size.outlier_m, 0.12);
        EXPECT_GT(*size.step_m, *size.outlier_m);
        EXPECT_LT(*size.step_m, 0.2);
        ASSERT_TRUE(screened.rows[k].hypothesis);
        EXPECT_LE(*screened.rows[k].statistic, *screened.rows[k].threshold);
    }
}

TEST(Screen, ShortArcsAreNotUsed) {
    EnuTable table = clean_run(150);
    table.rows.erase(table.rows.begin() + 40, table.rows.begin() + 65);
    table.rows.erase(table.rows.begin() + 44, table.rows.begin() + 69);
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(screened.rows[40].reason, Reason::short_arc);
    EXPECT_EQ(screened.rows[43].reason, Reason::short_arc);
    EXPECT_EQ(*screened.rows[43].statistic, 4.0);
    EXPECT_FALSE(screened.rows[40].arc.has_value());
    EXPECT_EQ(screened.rows[44].arc, 2);
}

TEST(Screen, ErrorsLargerThanStatedAreNotMistakenForOutliers) {
    // Stated standard deviations are optimistic in practice; the variance factor takes that up.
    EnuTable table = clean_run(400);
    for (EnuEpoch& row : table.rows) {
        row.sigma_east_m = row.sigma_north_m = 0.003;
        row.sigma_up_m = 0.006;
    }
    const ScreenedTable screened = screen(table, config());
    EXPECT_GT(screened.variance_factor, 3.0);
    EXPECT_EQ(summarise(screened.rows).usable, 400);
}

TEST(Screen, FalseAlarmsAreAsRareAsStated) {
    std::int64_t rejected = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
        rejected +=
            summarise(screen(clean_run(1000, seed), config()).rows).reasons[Reason::innovation];
    EXPECT_LE(rejected, 1);  // 20,000 tests at a rate of 1e-6
}

TEST(Screen, TablesOfNothingAndOfOneEpoch) {
    EXPECT_EQ(screen(clean_run(0), config()).rows.size(), 0U);
    const ScreenedTable one = screen(clean_run(1), config());
    EXPECT_EQ(one.rows[0].reason, Reason::short_arc);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
