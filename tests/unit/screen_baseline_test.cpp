#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "core/random.h"
#include "stages/screen/baseline.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d;

ScreenConfig config() {
    return screen_config(
        read_attempt("schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
                     "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
                     "attempt"));
}

TestPlan plan_for(std::int64_t epochs) {
    const ScreenConfig c = config();
    return {c.family_false_alarm_rate, epochs * tests_of_an_epoch({}, c.burst_epochs_max), c.power,
            c.burst_epochs_max};
}

/// Speeds up from a start speed along a circle of 400 m radius.
struct Craft {
    double start_m_s = 10.0;
    double acceleration_m_s2 = 0.5;
    double radius_m = 400.0;

    double speed(double t) const { return start_m_s + acceleration_m_s2 * t; }
    double distance(double t) const { return start_m_s * t + 0.5 * acceleration_m_s2 * t * t; }
    Vector2d along(double t) const {
        const double angle = distance(t) / radius_m;
        return {std::sin(angle), std::cos(angle)};
    }
    Vector2d right(double t) const { return {along(t).y(), -along(t).x()}; }
    Vector2d position(double t) const {
        const double angle = distance(t) / radius_m;
        return radius_m * Vector2d(1.0 - std::cos(angle), std::sin(angle));
    }
};

struct Recorder {
    std::string id;
    double ahead_m = 0.0;
    double right_m = 0.0;
    std::int64_t first_ms = 0;  ///< of the first epoch, after the craft's time 0
    std::int64_t interval_ms = 100;
    std::int64_t last_ms = 40'000;
    double clock_late_s = 0.0;  ///< stamps are behind the truth by this
    double noise_m = 0.010;
};

const GpsTime time_zero = GpsTime::from_week(2200, 100'000'000'000'000);

/// A table as screening leaves it where it marks nothing.
ScreenedTable recorded(const Craft& craft, const Recorder& one, RandomGenerator& random) {
    ScreenedTable table;
    table.facts.receiver = one.id;
    table.facts.first_epoch = time_zero.plus_nanoseconds(one.first_ms * 1'000'000);
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 1e-3 * static_cast<double>(one.interval_ms);
    for (std::int64_t ms = one.first_ms; ms <= one.last_ms; ms += one.interval_ms) {
        const double t = 1e-3 * static_cast<double>(ms) + one.clock_late_s;
        const Vector2d position =
            craft.position(t) + one.ahead_m * craft.along(t) + one.right_m * craft.right(t);
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = std::ssize(table.rows);
        row.time.nanoseconds = (ms - one.first_ms) * 1'000'000;
        row.east_m = position.x() + one.noise_m * random.normal();
        row.north_m = position.y() + one.noise_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = one.noise_m;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    table.rows.front().break_before = ArcBreak::start;
    return table;
}

Motion motion_of(const Craft& craft, const Recorder& one, const ScreenedTable& table) {
    Motion motion;
    for (const ScreenedEpoch& row : table.rows) {
        const double t = 1e-3 * static_cast<double>(one.first_ms) + row.time.seconds();
        EpochMotion& at = motion.emplace_back().emplace();
        at.velocity = craft.speed(t) * craft.along(t);
        at.acceleration = craft.acceleration_m_s2 * craft.along(t) +
                          craft.speed(t) * craft.speed(t) / craft.radius_m * craft.right(t);
        at.velocity_covariance = 4e-4 * Matrix2d::Identity();
        at.acceleration_covariance = 0.01 * Matrix2d::Identity();
    }
    return motion;
}

/// The second receiver 2 m ahead of the first, and 0.5 m to the right.
struct TwoReceivers {
    Craft craft{};
    Recorder first{.id = "primary"};
    Recorder second{.id = "secondary", .ahead_m = 2.0, .right_m = 0.5};
    ScreenedTable a, b;
    bool marked = false;

    /// Longer, at much the same speed.
    void last_until(std::int64_t ms) {
        craft = {.start_m_s = 20.0, .acceleration_m_s2 = 0.05};
        first.last_ms = second.last_ms = ms;
    }
    void record(std::uint64_t seed) {
        RandomGenerator random(seed);
        a = recorded(craft, first, random);
        b = recorded(craft, second, random);
    }
    void compare() {
        marked = compare_receivers(a, b, motion_of(craft, first, a), plan_for(std::ssize(a.rows)),
                                   config());
    }
    const BaselineComparison& found() const { return a.basis.baseline.value(); }
};

std::vector<std::int64_t> rejected(const ScreenedTable& table) {
    std::vector<std::int64_t> epochs;
    for (const ScreenedEpoch& row : table.rows)
        if (row.reason == Reason::baseline) epochs.push_back(row.epoch);
    return epochs;
}

std::vector<std::int64_t> breaks(const ScreenedTable& table) {
    std::vector<std::int64_t> epochs;
    for (const ScreenedEpoch& row : table.rows)
        if (row.break_before && row.break_before != ArcBreak::start) epochs.push_back(row.epoch);
    return epochs;
}

using Epochs = std::vector<std::int64_t>;

TEST(Baseline, NothingIsMarkedInCleanRecordings) {
    // 0.1 expected at a family-wise rate of 0.001.
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        TwoReceivers pair;
        pair.record(seed);
        pair.compare();
        alarms += pair.marked ? 1 : 0;
        ASSERT_EQ(pair.found().compared, 401);
        // The median of n lengths has a standard deviation of 1.25 sigma / sqrt(n).
        EXPECT_NEAR(pair.found().length_m, std::hypot(2.0, 0.5), 5.0 * 1.25 * 0.0141 / 20.0);
        EXPECT_NEAR(pair.found().sd_m, 0.0141, 0.004);
    }
    EXPECT_EQ(alarms, 0);
}

TEST(Baseline, AnOutlierIsMarkedInBoth) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        TwoReceivers pair;
        pair.record(seed);
        *pair.b.rows[155].east_m += 0.3;
        pair.compare();
        EXPECT_TRUE(pair.marked);
        EXPECT_EQ(rejected(pair.a), Epochs{156}) << seed;
        EXPECT_EQ(rejected(pair.b), Epochs{156}) << seed;
        EXPECT_EQ(pair.found().rejected, 1);
        EXPECT_EQ(pair.found().receiver, "secondary");
        EXPECT_EQ(pair.b.basis.baseline->receiver, "primary");
        for (const ScreenedEpoch* row : {&pair.a.rows[155], &pair.b.rows[155]}) {
            EXPECT_FALSE(row->usable);
            EXPECT_EQ(row->hypothesis, Hypothesis::baseline);
            EXPECT_GT(*row->statistic, *row->threshold);
            EXPECT_EQ(row->arc, 1);
        }
        // The error that each has if it is the wrong one.
        const EstimatedError& b = pair.b.rows[155].estimated;
        ASSERT_TRUE(b.east_m && b.sigma_east_m);
        if (std::abs(*b.east_m - 0.3) < 3.0 * *b.sigma_east_m &&
            std::abs(*b.north_m) < 3.0 * *b.sigma_north_m)
            ++found;
        EXPECT_NEAR(*b.sigma_east_m, 0.0155, 0.004);
        EXPECT_EQ(*pair.a.rows[155].estimated.east_m, -*b.east_m);
        EXPECT_EQ(*pair.a.rows[155].estimated.north_m, -*b.north_m);
    }
    EXPECT_GE(found, 19);
}

TEST(Baseline, ABurstHasAnErrorForEachEpoch) {
    TwoReceivers pair;
    pair.record(3);
    for (std::size_t k = 200; k < 205; ++k)
        *pair.a.rows[k].north_m -= 0.2 + 0.02 * static_cast<double>(k - 200);
    pair.compare();
    EXPECT_EQ(rejected(pair.a), (Epochs{201, 202, 203, 204, 205}));
    EXPECT_EQ(rejected(pair.b), (Epochs{201, 202, 203, 204, 205}));
    for (std::size_t k = 200; k < 205; ++k)
        EXPECT_NEAR(pair.a.rows[k].estimated.north_m.value(),
                    -0.2 - 0.02 * static_cast<double>(k - 200), 0.06);
    EXPECT_TRUE(breaks(pair.a).empty());
}

TEST(Baseline, AStepEndsTheArcOfBoth) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        TwoReceivers pair;
        pair.record(seed);
        for (std::size_t k = 180; k < pair.a.rows.size(); ++k)
            *pair.a.rows[k].north_m += 0.3;
        pair.compare();
        EXPECT_EQ(breaks(pair.a), Epochs{181}) << seed;
        EXPECT_EQ(breaks(pair.b), Epochs{181}) << seed;
        EXPECT_TRUE(rejected(pair.a).empty());
        EXPECT_EQ(pair.a.rows[180].break_before, ArcBreak::step);
        EXPECT_EQ(pair.a.rows[180].hypothesis, Hypothesis::baseline);
        EXPECT_TRUE(pair.a.rows[180].usable);
        EXPECT_NEAR(pair.a.rows[180].estimated.north_m.value(), 0.3, 0.06);
        EXPECT_NEAR(pair.a.rows[180].estimated.east_m.value(), 0.0, 0.06);
    }
}

TEST(Baseline, WhatOneReceiverMarkedItselfIsNotCompared) {
    TwoReceivers pair;
    pair.record(4);
    *pair.b.rows[150].east_m += 30.0;
    pair.b.rows[150].usable = false;
    pair.b.rows[150].reason = Reason::outlier;
    // A step that it found: the baseline is another from there on, in no need of a second mark.
    for (std::size_t k = 250; k < pair.b.rows.size(); ++k) {
        *pair.b.rows[k].east_m += 0.4;
        pair.b.rows[k].arc = 2;
    }
    pair.b.rows[250].break_before = ArcBreak::step;
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 400);
    EXPECT_TRUE(pair.a.rows[150].usable);
}

TEST(Baseline, ReceiversOfDifferentRatesAreComparedAtCommonEpochs) {
    TwoReceivers pair;
    pair.second.interval_ms = 500;
    pair.record(5);
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 81);

    // A step of the slow one, between its epochs 40 (19.5 s) and 41 (20.0 s).
    pair.record(5);
    for (std::size_t k = 40; k < pair.b.rows.size(); ++k)
        *pair.b.rows[k].north_m += 0.3;
    pair.compare();
    EXPECT_EQ(breaks(pair.b), Epochs{41});
    EXPECT_EQ(breaks(pair.a), Epochs{201});
    // Where between them it lies, the epochs of the fast one alone cannot tell.
    EXPECT_EQ(rejected(pair.a), (Epochs{197, 198, 199, 200}));
    EXPECT_TRUE(rejected(pair.b).empty());
}

TEST(Baseline, RatesWithoutACommonEpochAreNotCompared) {
    TwoReceivers pair;
    pair.second.first_ms = 30;
    pair.record(6);
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 0);
    EXPECT_EQ(pair.found().rejected, 0);
}

TEST(Baseline, EpochsAreMatchedByGpsTime) {
    for (const std::int64_t first_ms : {-12'300, 7'400}) {
        TwoReceivers pair;
        pair.second.first_ms = first_ms;
        pair.record(7);
        // The same instant, whatever each counts from.
        const std::int64_t at_ms = 21'000;
        *pair.a.rows[static_cast<std::size_t>(at_ms / 100)].north_m += 0.3;
        pair.compare();
        EXPECT_EQ(rejected(pair.a), Epochs{at_ms / 100 + 1});
        EXPECT_EQ(rejected(pair.b), Epochs{(at_ms - first_ms) / 100 + 1});
        EXPECT_EQ(pair.found().compared, first_ms < 0 ? 401 : 327);
        EXPECT_NEAR(pair.found().length_m, std::hypot(2.0, 0.5), 0.01);
    }
}

TEST(Baseline, RelativeTimesAreNotCompared) {
    TwoReceivers pair;
    pair.record(8);
    pair.b.facts.first_epoch.reset();
    *pair.b.rows[150].east_m += 0.3;
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 0);
}

TEST(Baseline, AConstantDifferenceOfTheClocksShowsInTheLengthAlone) {
    // At 10 to 30 m/s, 20 ms are 0.2 to 0.6 m along the track.
    TwoReceivers pair;
    pair.second.clock_late_s = 0.020;
    pair.record(9);
    pair.compare();
    EXPECT_FALSE(pair.marked);
    // Speed goes up linearly: median 20 m/s, of deviations 5 m/s; antennas mostly ahead.
    EXPECT_NEAR(pair.found().length_m, std::hypot(2.0 + 20.0 * 0.020, 0.5), 0.02);
    EXPECT_NEAR(pair.found().sd_m, 5.0 * 0.020 / 0.6745, 0.02);
}

TEST(Baseline, AClockThatJumpsAtSpeedIsAStep) {
    TwoReceivers pair;
    pair.record(10);
    const ScreenedTable before = pair.b;
    pair.second.clock_late_s = 0.020;
    pair.record(10);
    for (std::size_t k = 0; k < 200; ++k)
        pair.b.rows[k] = before.rows[k];
    pair.compare();
    EXPECT_EQ(breaks(pair.a), Epochs{201});
    EXPECT_EQ(breaks(pair.b), Epochs{201});
}

TEST(Baseline, StandingEpochsAreComparedByTheLength) {
    TwoReceivers pair;
    pair.craft = {.start_m_s = 0.0, .acceleration_m_s2 = 0.0, .radius_m = 400.0};
    pair.record(11);
    *pair.b.rows[150].north_m += 0.3;  // along the antennas, who stand north of one another
    pair.compare();
    EXPECT_EQ(rejected(pair.a), Epochs{151});
    EXPECT_NEAR(pair.b.rows[150].estimated.north_m.value(), 0.3, 0.06);
    // Across them the length hardly changes: a craft that was turned looks the same.
    pair.record(11);
    *pair.b.rows[150].east_m += 0.05;
    pair.compare();
    EXPECT_FALSE(pair.marked);
}

TEST(Baseline, PositionsFromDifferentOriginsAreBroughtTogether) {
    TwoReceivers pair;
    pair.record(12);
    const Geodetic origin{.latitude = Angle::from_degrees(-31.6),
                          .longitude = Angle::from_degrees(136.0),
                          .height_m = 110.0};
    const LocalFrame frame(origin);
    const Geodetic other = frame.geodetic_from_enu(Enu{{1500.0, -700.0, 3.0}});
    const LocalFrame other_frame(other);
    pair.a.origin = FrameOrigin{.position = origin, .source = "first_epoch"};
    pair.b.origin = FrameOrigin{.position = other, .source = "first_epoch"};
    for (ScreenedEpoch& row : pair.b.rows) {
        const Eigen::Vector3d moved =
            other_frame
                .enu_from_geodetic(frame.geodetic_from_enu(Enu{{*row.east_m, *row.north_m, 0.0}}))
                .m;
        row.east_m = moved.x();
        row.north_m = moved.y();
    }
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 401);
    EXPECT_NEAR(pair.found().length_m, std::hypot(2.0, 0.5), 0.01);
    pair.b.origin.reset();
    pair.compare();
    EXPECT_EQ(pair.found().compared, 0);
}

TEST(Baseline, ACraftThatTurnsHardOnTheSpotRaisesNoAlarm) {
    // A circle of 10 m at 3 m/s, begun and ended at once: the track turns by 0.2 rad over 2 m.
    TwoReceivers pair;
    pair.craft = {.start_m_s = 3.0, .acceleration_m_s2 = 0.0, .radius_m = 10.0};
    pair.record(13);
    pair.compare();
    EXPECT_FALSE(pair.marked);
    EXPECT_EQ(pair.found().compared, 401);
}

/// The same recordings before screening.
EnuTable unscreened(const ScreenedTable& table) {
    EnuTable enu;
    enu.facts = table.facts;
    for (const ScreenedEpoch& row : table.rows)
        enu.rows.push_back(row);
    return enu;
}

TEST(ScreenReceivers, OneReceiverIsScreenedByItself) {
    TwoReceivers pair;
    pair.record(14);
    const std::vector<EnuTable> tables{unscreened(pair.a)};
    const std::vector<ScreenedTable> screened = screen_receivers(tables, config());
    ASSERT_EQ(screened.size(), 1U);
    EXPECT_EQ(write_screened(screened[0]), write_screened(screen(tables[0], config())));
    EXPECT_FALSE(screened[0].basis.baseline.has_value());
}

TEST(ScreenReceivers, TwoAreComparedAfterEachWasScreened) {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        TwoReceivers pair;
        pair.record(seed);
        const std::vector<EnuTable> tables{unscreened(pair.a), unscreened(pair.b)};
        const std::vector<ScreenedTable> screened = screen_receivers(tables, config());
        ASSERT_EQ(screened.size(), 2U);
        EXPECT_EQ(screened[0].basis.baseline->compared, 401);
        EXPECT_EQ(screened[1].basis.baseline->receiver, "primary");
        alarms += summarise(screened[0].rows).usable + summarise(screened[1].rows).usable != 802;
    }
    EXPECT_EQ(alarms, 0);
}

TEST(ScreenReceivers, TheArcsAreFinishedAfterTheComparison) {
    // At 1 Hz a craft may well have moved by 0.4 m more; that its other antenna did not tells.
    TwoReceivers pair;
    pair.first.interval_ms = pair.second.interval_ms = 1000;
    pair.first.last_ms = pair.second.last_ms = 120'000;
    pair.craft = {.start_m_s = 10.0, .acceleration_m_s2 = 0.0, .radius_m = 400.0};
    pair.record(15);
    for (std::size_t k = 60; k < pair.b.rows.size(); ++k)
        *pair.b.rows[k].east_m += 0.4;
    const std::vector<EnuTable> tables{unscreened(pair.a), unscreened(pair.b)};
    EXPECT_EQ(summarise(screen(tables[1], config()).rows).arcs, 1);
    for (const ScreenedTable& table : screen_receivers(tables, config())) {
        EXPECT_EQ(summarise(table.rows).arcs, 2);
        EXPECT_EQ(table.rows[60].arc, 2);
        EXPECT_EQ(table.rows[60].break_before, ArcBreak::step);
        EXPECT_EQ(table.rows[60].hypothesis, Hypothesis::baseline);
        EXPECT_EQ(table.rows[59].arc, 1);
    }
}

double seconds_after_zero(const ScreenedTable& table) {
    return static_cast<double>(table.facts.first_epoch->nanoseconds_since(time_zero)) * 1e-9;
}

/// Makes the positions drift north for ten seconds from 15 s on, and keep the offset.
void drift_north(ScreenedTable& table, double rate_m_s) {
    for (ScreenedEpoch& row : table.rows) {
        const double since_s = seconds_after_zero(table) + row.time.seconds() - 15.0;
        *row.north_m += rate_m_s * std::clamp(since_s, 0.0, 10.0);
    }
}

/// Usable epochs that the other receiver contradicts, all of them within the drift; the direction
/// of the first.
std::pair<int, Vector2d> contradicted_within_the_drift(const ScreenedTable& table) {
    int count = 0;
    Vector2d apart = Vector2d::Zero();
    for (const ScreenedEpoch& row : table.rows) {
        if (row.reason != Reason::baseline) continue;
        const double time_s = seconds_after_zero(table) + row.time.seconds();
        EXPECT_GE(time_s, 14.0);
        EXPECT_LE(time_s, 26.0);
        if (count++ == 0 && row.estimated.east_m)
            apart = {*row.estimated.east_m, *row.estimated.north_m};
    }
    return {count, apart};
}

// A drift leaves every epoch as near to its neighbours as before: displacements over seconds show
// it, whether or not the two have an epoch in common.
TEST(ScreenReceivers, ASlowDriftOfOneIsMarkedInBoth) {
    for (const std::int64_t first_ms : {0, 30}) {
        TwoReceivers pair;
        pair.last_until(120'000);
        pair.second.first_ms = first_ms;
        pair.record(16);
        drift_north(pair.b, 0.15);
        const std::vector<EnuTable> tables{unscreened(pair.a), unscreened(pair.b)};
        for (const EnuTable& table : tables)
            EXPECT_EQ(summarise(screen(table, config()).rows).reasons[Reason::none],
                      std::ssize(table.rows))
                << "one alone does not show it";
        const std::vector<ScreenedTable> screened = screen_receivers(tables, config());
        const auto [first, against_first] = contradicted_within_the_drift(screened[0]);
        const auto [second, against_second] = contradicted_within_the_drift(screened[1]);
        EXPECT_GT(first, 20);
        EXPECT_GT(second, 20);
        EXPECT_LT(against_first.y(), -0.1);
        EXPECT_GT(against_second.y(), 0.1);
        for (const ScreenedTable& table : screened) {
            const auto& found = table.basis.displacements;
            ASSERT_EQ(found.size(), 1U);
            EXPECT_EQ(found[0].kind, WitnessKind::receiver);
            EXPECT_EQ(found[0].receiver,
                      &table == screened.data() ? pair.second.id : pair.first.id);
            EXPECT_GT(found[0].rejected, 0);
        }
    }
}

TEST(ScreenReceivers, DisplacementsRaiseNoAlarmInCleanRecordings) {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        TwoReceivers pair;
        pair.second.first_ms = 30;  // the vector between the antennas is not tested
        pair.record(seed);
        const std::vector<EnuTable> tables{unscreened(pair.a), unscreened(pair.b)};
        for (const ScreenedTable& table : screen_receivers(tables, config()))
            alarms += std::ranges::count(table.rows, Reason::baseline, &ScreenedEpoch::reason) > 0;
    }
    EXPECT_EQ(alarms, 0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
