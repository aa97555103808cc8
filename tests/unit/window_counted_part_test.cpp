#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/failure.h"
#include "schemas/profile/profile.h"
#include "stages/window/counted_part.h"

// The part of a recording in which a rule's window may lie.

namespace runcert::RUNCERT_FILE {
namespace {

/// A jump at 5 Hz: level until 10 s, then falling at a = 8 m/s^2 up to 80 m/s, braking from
/// `opens_m` on to 5 m/s, and standing once it is down.
struct Jump {
    double top_m = 4200.0;
    double ground_m = 100.0;
    double opens_m = 1300.0;
    double stands_s = 30.0;
    bool velocities = true;
    ScreenedTable screened = {};
    TrajectoryTable trajectory = {};

    void record(double until_m = -1e9) {
        screened.facts.nominal_interval_s = trajectory.facts.nominal_interval_s = 0.2;
        double height_m = top_m;
        double fall_m_s = 0.0;
        double stood_s = 0.0;
        for (std::int64_t k = 0; stood_s <= stands_s && height_m >= until_m; ++k) {
            const double time_s = 0.2 * static_cast<double>(k);
            add(k, height_m, -fall_m_s);
            if (time_s >= 10.0)
                fall_m_s = height_m > opens_m ? std::min(80.0, fall_m_s + 1.6)
                                              : std::max(5.0, fall_m_s - 4.0);
            height_m -= 0.2 * fall_m_s;
            if (height_m > ground_m) continue;
            height_m = ground_m;
            fall_m_s = 0.0;
            stood_s += 0.2;
        }
    }

    void add(std::int64_t k, double height_m, double up_m_s) {
        ScreenedEpoch& row = screened.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 200'000'000};
        row.east_m = row.north_m = 0.0;
        row.up_m = height_m;
        row.sigma_up_m = 2.0;
        row.usable = true;
        if (velocities) row.recorded_velocity_up_m_s = up_m_s;
        TrajectoryEpoch& smoothed = trajectory.rows.emplace_back();
        smoothed.epoch = row.epoch;
        smoothed.time = row.time;
        smoothed.speed_m_s = 0.0;
        smoothed.velocity_up_m_s = up_m_s;
    }

    std::optional<WindowPart> part(const PartStatements& stated = {},
                                   const std::string& profile = "fai-speed-skydiving-2026") const {
        return counted_part(screened, trajectory, read_profile(builtin_profile(profile), profile),
                            stated, std::nullopt);
    }
};

TEST(CountedPart, AJumpCountsFromExitTo2256MBelow) {
    Jump jump;
    jump.record();
    const auto part = jump.part();
    ASSERT_TRUE(part && part->from && part->to);
    // After 10 s of level flight 1.6 m/s are gained each 0.2 s: 10 m/s with the seventh.
    EXPECT_NEAR(part->from->time_s, 11.4, 1e-9);
    EXPECT_EQ(part->to->event, WindowEvent::below_start);
    EXPECT_LE(*part->from->height_m - *part->to->height_m, 2256.0);
    EXPECT_GT(*part->from->height_m - *part->to->height_m, 2256.0 - 0.2 * 80.0);
    EXPECT_NEAR(*part->ground_height_m, 100.0, 1e-6);
    EXPECT_EQ(part->ground, GroundSource::recording);
    EXPECT_TRUE(part->missing.empty());
}

TEST(CountedPart, TheBreakOffComesFirstWhereTheExitIsLow) {
    Jump jump;
    jump.record();
    const auto part = jump.part({.ground_height_m = 600.0, .part = {}});
    ASSERT_TRUE(part && part->to);
    EXPECT_EQ(part->ground, GroundSource::attempt);
    EXPECT_EQ(part->to->event, WindowEvent::above_ground);
    EXPECT_GE(*part->to->height_m, 2307.0);
    EXPECT_LT(*part->to->height_m, 2307.0 + 0.2 * 80.0);
}

TEST(CountedPart, WithoutRecordedVelocitiesTheSmoothedOnesTellTheExit) {
    Jump jump{.velocities = false};
    jump.record();
    EXPECT_NEAR(jump.part()->from->time_s, 11.4, 1e-9);
}

TEST(CountedPart, AnEpochThatScreeningLeftOutIsNotTheHighestPoint) {
    Jump jump;
    jump.record();
    jump.screened.rows[200].up_m = 9000.0;
    jump.screened.rows[200].usable = false;
    EXPECT_NEAR(jump.part()->from->time_s, 11.4, 1e-9);
}

TEST(CountedPart, ARecordingOfTheClimbToo) {
    Jump jump;
    for (std::int64_t k = -500; k < 0; ++k)
        jump.add(k + 500, 100.0 + 8.2 * static_cast<double>(k + 500), 41.0);
    Jump fall;
    fall.record();
    for (const ScreenedEpoch& row : fall.screened.rows)
        jump.add(row.epoch + 499, *row.up_m, *row.recorded_velocity_up_m_s);
    EXPECT_NEAR(jump.part()->from->time_s, 111.4, 1e-9);
}

TEST(CountedPart, SaysThatNothingTellsTheGround) {
    Jump jump;
    jump.record(1000.0);
    const auto part = jump.part();
    ASSERT_TRUE(part && part->to);
    EXPECT_EQ(part->to->event, WindowEvent::below_start);
    ASSERT_EQ(part->missing.size(), 1U);
    EXPECT_NE(part->missing[0].find("ground_height_m"), std::string::npos);
}

TEST(CountedPart, WhereABalloonStoodIsNotTheGround) {
    Jump jump;
    jump.record(1000.0);
    EXPECT_FALSE(jump.part()->ground_height_m);  // 10 s at 4,200 m
    jump = Jump();
    for (std::int64_t k = 0; k < 100; ++k)
        jump.add(k, 300.0, 0.0);
    Jump fall;
    fall.record(320.0);
    for (const ScreenedEpoch& row : fall.screened.rows)
        jump.add(row.epoch + 99, *row.up_m, *row.recorded_velocity_up_m_s);
    EXPECT_NEAR(*jump.part()->ground_height_m, 300.0, 1e-6);  // before it rose
}

TEST(CountedPart, SaysThatTheRecordingEndsBefore) {
    Jump jump;
    jump.record(2500.0);
    const auto part = jump.part({.ground_height_m = 100.0, .part = {}});
    ASSERT_TRUE(part && part->from);
    EXPECT_FALSE(part->to);
    ASSERT_EQ(part->missing.size(), 2U);
    EXPECT_NE(part->missing[0].find("the recording ends before"), std::string::npos);
    EXPECT_TRUE(lies_in(part, jump.screened.rows.back().time));
}

TEST(CountedPart, WithoutAnExitNothingCounts) {
    Jump jump;
    for (std::int64_t k = 0; k < 100; ++k)
        jump.add(k, 500.0, 0.0);
    const auto part = jump.part();
    ASSERT_TRUE(part);
    EXPECT_FALSE(part->from);
    EXPECT_NE(part->missing.at(0).find("no exit was found"), std::string::npos);
    EXPECT_FALSE(lies_in(part, ElapsedTime{0}));
    Jump flat;
    flat.record();
    for (ScreenedEpoch& row : flat.screened.rows)
        row.up_m.reset();
    EXPECT_NE(flat.part()->missing.at(0).find("no heights"), std::string::npos);
}

TEST(CountedPart, ValidatesTheLast1006M) {
    Jump jump;
    jump.record();
    const auto clean = jump.part();
    ASSERT_TRUE(clean->validated && clean->validated->worst_m_s);
    EXPECT_NEAR(*clean->validated->worst_m_s, std::numbers::sqrt2 * 2.0 / 3.0, 1e-9);
    // 1,006 m at 80 m/s, whole samples.
    EXPECT_NEAR(static_cast<double>(clean->validated->epochs), 1006.0 / 16.0 + 1.0, 1.0);
    for (ScreenedEpoch& row : jump.screened.rows)
        if (row.time.seconds() < clean->validated->from_s) row.sigma_up_m = 50.0;
    EXPECT_NEAR(*jump.part()->validated->worst_m_s, std::numbers::sqrt2 * 2.0 / 3.0, 1e-9);
    const auto inside = std::ranges::find_if(jump.screened.rows, [&](const ScreenedEpoch& row) {
        return row.time.seconds() > clean->validated->from_s + 1.0;
    });
    inside->sigma_up_m = 7.0;
    inside->usable = false;
    EXPECT_NEAR(*jump.part()->validated->worst_m_s, std::numbers::sqrt2 * 7.0 / 3.0, 1e-9);
    EXPECT_EQ(jump.part()->validated->worst_epoch, inside->epoch);
    inside->sigma_up_m.reset();
    EXPECT_FALSE(jump.part()->validated->worst_m_s);
}

std::string own_rule(const std::string& within) {
    return "schema: profile/1.0\nid: own\nbody: b\ntitle: t\nwindow: {duration_s: 3, definition: "
           "displacement, within: " +
           within +
           "}\nmargin: {kind: absolute, value: 0, unit: km/h}\nclauses:\n  - {id: part, text: t, "
           "source: s, certainty: unconfirmed, decided_by: counted_part}\n";
}

WindowPart own_part(const Jump& jump, const std::string& within, const PartStatements& stated = {},
                    const std::optional<SurveyedCourse>& gates = {}) {
    return *counted_part(jump.screened, jump.trajectory, read_profile(own_rule(within), "own.yaml"),
                         stated, gates);
}

TEST(CountedPart, OfHeights) {
    Jump jump;
    jump.record();
    const WindowPart part = own_part(
        jump,
        "{from: {event: at_height, height_m: 3000}, to: [{event: at_height, height_m: 2000}]}");
    EXPECT_GE(*part.from->height_m, 3000.0);
    EXPECT_LT(*part.from->height_m, 3016.0);
    EXPECT_GE(*part.to->height_m, 2000.0);
    EXPECT_LT(*part.to->height_m, 2016.0);
}

TEST(CountedPart, AsTheAttemptStates) {
    Jump jump;
    jump.record();
    const GpsTime first = GpsTime::from_week(2400, 0);
    jump.screened.facts.first_epoch = first;
    const auto after = [&](double seconds) {
        return GpsTime::from_nanoseconds(first.nanoseconds() + std::llround(seconds * 1e9));
    };
    const std::string within = "{from: {event: stated}, to: [{event: stated}]}";
    const WindowPart part =
        own_part(jump, within,
                 {.ground_height_m = {},
                  .part = StatedPart{.from = after(20.1), .to = after(30.1), .source = "judge"}});
    EXPECT_NEAR(part.from->time_s, 20.2, 1e-9);
    EXPECT_NEAR(part.to->time_s, 30.0, 1e-9);
    EXPECT_THROW(own_part(jump, within), Failure);
    const WindowPart beyond = own_part(
        jump, within,
        {.ground_height_m = {},
         .part = StatedPart{.from = after(9000.0), .to = after(9010.0), .source = "judge"}});
    EXPECT_FALSE(beyond.from);
    jump.screened.facts.first_epoch = std::nullopt;
    const WindowPart relative =
        own_part(jump, within,
                 {.ground_height_m = {},
                  .part = StatedPart{.from = after(20.0), .to = after(30.0), .source = "judge"}});
    EXPECT_NE(relative.missing.at(0).find("start_gps"), std::string::npos);
}

TEST(CountedPart, BetweenTheLinesOfACourse) {
    Jump track;
    for (std::int64_t k = 0; k < 100; ++k) {
        track.add(k, 0.0, 0.0);
        track.screened.rows.back().east_m = 2.0 * static_cast<double>(k);
    }
    const SurveyedCourse course{.start = {.left = {50.5, 10.0}, .right = {50.5, -10.0}},
                                .finish = {.left = {100.5, 10.0}, .right = {100.5, -10.0}},
                                .length_m = 50.0,
                                .length_standard_uncertainty_m = 0.0};
    const WindowPart part =
        own_part(track, "{from: {event: course_start}, to: [{event: course_finish}]}", {}, course);
    EXPECT_NEAR(part.from->time_s, 26 * 0.2, 1e-9);
    EXPECT_NEAR(part.to->time_s, 50 * 0.2, 1e-9);
    EXPECT_THROW(own_part(track, "{from: {event: course_start}, to: [{event: course_finish}]}"),
                 Failure);
}

TEST(CountedPart, ARuleWhoseEventsCannotBeFoundIsRefused) {
    for (const char* within :
         {"{from: {event: exit}, to: []}", "{from: {event: exit}, to: [{event: below_start}]}",
          "{from: {event: exit, height_m: 5}, to: [{event: stated}]}",
          "{from: {event: below_start, height_m: 5}, to: [{event: stated}]}",
          "{from: {event: landing}, to: [{event: stated}]}",
          "{from: {event: stated, speed_m_s: 5}, to: [{event: stated}]}"}) {
        try {
            read_profile(own_rule(within), "own.yaml");
            ADD_FAILURE() << within;
        } catch (const Failure& failure) {
            EXPECT_NE(failure.where().find("own.yaml:5"), std::string::npos) << failure.where();
        }
    }
    // What asks for a part needs one.
    EXPECT_THROW(read_profile("schema: profile/1.0\nid: own\nbody: b\ntitle: t\nwindow: "
                              "{duration_s: 3, definition: displacement}\nmargin: {kind: absolute, "
                              "value: 0, unit: km/h}\nclauses:\n  - {id: part, text: t, source: s, "
                              "certainty: unconfirmed, decided_by: counted_part}\n",
                              "own.yaml"),
                 Failure);
}

TEST(CountedPart, WindowsBeginAndEndInIt) {
    WindowPart part;
    part.from = FoundEvent{.event = WindowEvent::exit, .time_s = 1.0, .epoch = 6, .height_m = {}};
    part.to = FoundEvent{.event = WindowEvent::exit, .time_s = 2.0, .epoch = 11, .height_m = {}};
    SampleSeries series;
    for (std::int64_t k = 0; k < 16; ++k)
        series.times.push_back({k * 200'000'000});
    restrict_to(part, std::vector(series.times), series);
    for (std::size_t k = 0; k < 16; ++k)
        EXPECT_EQ(series.bounds[k], k >= 5 && k <= 10) << k;
    SampleSeries whole = series;
    restrict_to(std::nullopt, std::vector(whole.times), whole);
    EXPECT_EQ(whole.bounds, series.bounds);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
