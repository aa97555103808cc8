#include "people_study.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace runcert::RUNCERT_FILE {
namespace {

PeopleKind short_kind(PeopleVelocities velocities) {
    return {.name = "short", .shortest_s = 180.0, .longest_s = 180.0, .velocities = velocities};
}

Eigen::Vector2d measured(const EnuEpoch& row) {
    return {*row.east_m, *row.north_m};
}

TEST(PeopleMotion, VelocitiesAreThoseOfThePositions) {
    RandomGenerator random(4);
    const TruePath path = random_session(600.0, false, random);
    EXPECT_NEAR(path.length_s(), 600.0, 1e-9);
    double fastest = 0.0;
    for (double at_s = 1.0; at_s < 599.0; at_s += 0.37) {
        const Eigen::Vector2d by_position =
            (path.position(at_s + TruePath::step_s) - path.position(at_s - TruePath::step_s)) /
            (2.0 * TruePath::step_s);
        ASSERT_LT((by_position - path.velocity(at_s)).norm(), 0.02) << at_s;
        const Eigen::Vector2d change = path.velocity(at_s + 0.5) - path.velocity(at_s);
        ASSERT_LT(change.norm() / 0.5, 20.0) << at_s;
        fastest = std::max(fastest, path.velocity(at_s).norm());
    }
    EXPECT_GT(fastest, 5.0);
    EXPECT_GE(fastest, path.fastest_m_s(3.0, 1.0));
    EXPECT_GT(path.fastest_m_s(3.0, 1.0), path.fastest_m_s(10.0, 1.0));
}

TEST(PeopleMotion, ACrashTakesASecond) {
    RandomGenerator random(7);
    const TruePath path = random_session(300.0, true, random);
    double most_lost = 0.0;
    for (double at_s = 200.0; at_s < 298.0; at_s += 0.1)
        most_lost =
            std::max(most_lost, path.velocity(at_s).norm() - path.velocity(at_s + 1.0).norm());
    EXPECT_GT(most_lost, 4.0);
    EXPECT_EQ(path.velocity(299.0).norm(), 0.0);
}

TEST(PeopleRecording, ErrorsAreAsLargeAsTheDeviceHasThem) {
    double ratio = 0.0;
    constexpr int seeds = 40;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const PeopleRecording recording =
            record_people(short_kind(PeopleVelocities::none), PeopleFault::none, seed);
        double squares = 0.0;
        for (const EnuEpoch& row : recording.measured.rows)
            squares += (measured(row) - recording.path.position(row.time.seconds())).squaredNorm();
        const double variance =
            2.0 * std::pow(std::hypot(recording.device.slow_m, recording.device.white_m), 2);
        ratio += squares / variance / static_cast<double>(recording.measured.rows.size()) / seeds;
    }
    EXPECT_NEAR(ratio, 1.0, 0.2);
}

TEST(PeopleRecording, VelocitiesAreLate) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        const PeopleRecording recording =
            record_people(short_kind(PeopleVelocities::stated), PeopleFault::none, seed);
        for (const EnuEpoch& row : recording.measured.rows) {
            const double then_s = row.time.seconds() - recording.device.velocity_late_s;
            const Eigen::Vector2d velocity(*row.recorded_velocity_east_m_s,
                                           *row.recorded_velocity_north_m_s);
            const double sigma_m_s =
                std::hypot(recording.device.velocity_white_m_s, recording.device.velocity_slow_m_s);
            ASSERT_LT((velocity - recording.path.velocity(then_s)).norm(), 6.0 * sigma_m_s);
        }
    }
}

TEST(PeopleRecording, AColdStartBeginsBlindAndStatesItsErrors) {
    PeopleKind kind = short_kind(PeopleVelocities::none);
    kind.cold_start = true;
    const std::vector<EnuEpoch> rows = record_people(kind, PeopleFault::none, 3).measured.rows;
    EXPECT_EQ(rows.front().fix, FixType::none);
    EXPECT_FALSE(rows.front().east_m);
    const auto first = std::ranges::find(rows, FixType::single, &EnuEpoch::fix);
    ASSERT_NE(first, rows.end());
    EXPECT_GT(*first->sigma_east_m, 200.0);
    EXPECT_LT(*rows.back().sigma_east_m, 2.2);
}

TEST(PeopleRecording, OneToFivePercentOfTheSamplesAreLost) {
    PeopleKind kind = short_kind(PeopleVelocities::none);
    kind.drops = true;
    kind.shortest_s = kind.longest_s = 1800.0;
    double lost = 0.0;
    double longest_s = 0.0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const std::vector<EnuEpoch> rows =
            record_people(kind, PeopleFault::none, seed).measured.rows;
        lost += (1801.0 - static_cast<double>(rows.size())) / 1801.0 / 20.0;
        for (std::size_t k = 1; k < rows.size(); ++k)
            longest_s = std::max(longest_s, rows[k].time.seconds() - rows[k - 1].time.seconds());
    }
    EXPECT_GT(lost, 0.01);
    EXPECT_LT(lost, 0.05);
    EXPECT_GE(longest_s, 3.0);
    EXPECT_LT(longest_s, 4.01);
}

TEST(PeopleRecording, FaultsAreAllThatFaultyRecordingsDifferBy) {
    const PeopleKind kind = short_kind(PeopleVelocities::none);
    for (const PeopleFault fault :
         {PeopleFault::step, PeopleFault::spike, PeopleFault::ramp, PeopleFault::multipath}) {
        const PeopleRecording clean = record_people(kind, PeopleFault::none, 11);
        const PeopleRecording faulty = record_people(kind, fault, 11);
        EXPECT_TRUE(faulty.fault.starts_with(to_text(fault))) << faulty.fault;
        EXPECT_EQ(measured(clean.measured.rows.front()), measured(faulty.measured.rows.front()));
        double moved_m = 0.0;
        for (std::size_t k = 0; k < clean.measured.rows.size(); ++k)
            moved_m = std::max(
                moved_m,
                (measured(clean.measured.rows[k]) - measured(faulty.measured.rows[k])).norm());
        EXPECT_GT(moved_m, 0.15) << faulty.fault;
        const double end_m =
            (measured(clean.measured.rows.back()) - measured(faulty.measured.rows.back())).norm();
        const bool lasting = fault == PeopleFault::step || fault == PeopleFault::ramp;
        EXPECT_EQ(end_m > 1e-9, lasting) << faulty.fault;
    }
}

TEST(PeopleStudy, IntervalsHoldTheTruthOfTheirWindows) {
    const std::vector<PeopleResult> results =
        study_people(short_kind(PeopleVelocities::stated), {.runs = 10});
    ASSERT_EQ(results.size(), 10 * people_rules().size());
    std::size_t certified = 0;
    std::size_t held = 0;
    for (const PeopleResult& one : results) {
        EXPECT_FALSE(one.failed) << one.reason;
        EXPECT_FALSE(one.falsely_beaten()) << one.seed;
        if (!one.certified()) continue;
        ++certified;
        if (one.held()) ++held;
        EXPECT_LE(*one.truth, one.record + 1e-9) << one.seed;
        EXPECT_GT(*one.truth, 0.5 * one.record) << one.seed;
        EXPECT_TRUE(one.contributions.contains("b")) << one.seed;
    }
    EXPECT_GE(certified, 16U);
    EXPECT_GE(held + 1, certified);
}

TEST(PeopleStudy, TheSameWithAnyNumberOfThreads) {
    EXPECT_EQ(people_csv(study_people_faults({.runs = 4, .threads = 1})),
              people_csv(study_people_faults({.runs = 4, .threads = 3})));
}

TEST(PeopleStudy, ARecordThatIsNotBeatenIsFalselyBeaten) {
    PeopleResult result{.profile = "a",
                        .record = 10.0,
                        .outcome = Outcome::beaten,
                        .outcome_above = Outcome::not_proven,
                        .speed = 11.0,
                        .truth = 9.9,
                        .expanded = 0.5};
    EXPECT_TRUE(result.falsely_beaten());
    EXPECT_FALSE(result.falsely_beaten_above());
    EXPECT_FALSE(result.held());
    result.truth = 10.6;
    EXPECT_FALSE(result.falsely_beaten());
    EXPECT_TRUE(result.held());
    result.outcome = Outcome::not_proven;
    result.truth = 9.9;
    EXPECT_FALSE(result.falsely_beaten());
}

TEST(PeopleTables, CountWhatIsRefusedByItsReason) {
    PeopleResult refused{.kind = "k", .profile = "p", .epochs = 10};
    refused.reason = "Not met: no 3 s of 120.5 are whole";
    PeopleResult held = refused;
    held.outcome = Outcome::not_proven;
    held.speed = 10.0;
    held.truth = 10.1;
    held.expanded = 1.0;
    const std::string table = people_table({refused, held});
    EXPECT_NE(table.find("0.500     1.000     3.60"), std::string::npos) << table;
    EXPECT_NE(table.find("1 Not met: no # s of # are whole"), std::string::npos) << table;
    const std::string csv = people_csv({held});
    EXPECT_NE(csv.find(",10.000000,10.100000,-0.100000,1.000000,1,"), std::string::npos) << csv;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
