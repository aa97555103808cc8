#include <gtest/gtest.h>

#include <algorithm>

#include "check_rules_support.h"

// The required speed over the record by each rule's margin, and the current where it is subtracted.

namespace runcert::RUNCERT_FILE {
namespace {

using test::clause_text, test::contains, test::profile_text, test::RuleScene, test::steady;

std::string with_margin(const std::string& margin, const std::string& more = {}) {
    return profile_text(clause_text("margin"), more, margin);
}

void set_record(RuleScene& scene, double speed, const char* unit, double expanded_uncertainty) {
    scene.attempt.record = Record{
        .speed = speed, .unit = unit, .source = "s", .expanded_uncertainty = expanded_uncertainty};
}

TEST(Margin, IsTakenOverTheRecordOfTheProfile) {
    RuleScene scene(with_margin("{kind: absolute, value: 1, unit: km/h}"));
    EXPECT_NEAR(*scene.verdict().required_speed_m_s, 203.9 / 3.6, 1e-12);
    scene.attempt.records["rule"] = {
        .speed = 130.0, .unit = "mph", .source = "own", .expanded_uncertainty = 0.0};
    const ProfileVerdict own = scene.verdict();
    EXPECT_NEAR(*own.required_speed_m_s, 130.0 * 0.44704 + 1.0 / 3.6, 1e-12);
    EXPECT_EQ(own.record->unit, "mph");
    // In the rule's unit: 58.1152 m/s and 0.2778 m/s.
    EXPECT_TRUE(contains(own.reason, " km/h, required 210.215 km/h")) << own.reason;
    EXPECT_EQ(scene.all().record->unit, "km/h");
    scene.attempt.records.clear();
    scene.attempt.records["another"] = {.speed = 10.0, .unit = "mph", .source = "o"};
    EXPECT_NEAR(*scene.verdict().required_speed_m_s, 203.9 / 3.6, 1e-12);
}

TEST(Margin, OfARecordWithItsOwnUncertainty) {
    RuleScene scene(with_margin("{kind: relative, value: 0.02}"));
    set_record(scene, 200.0, "km/h", 1.8);
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.required_speed_m_s, 204.0 / 3.6, 1e-12);
    // Half of 1.8 km/h, times 1.02.
    EXPECT_NEAR(verdict.decision->required_speed_standard_uncertainty_m_s, 1.02 * 0.25, 1e-12);
    // 60 m/s is 216 km/h: (216 - 204) / 3.6 / sqrt(0.255^2 + 0.005^2) = 13 standard deviations.
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    set_record(scene, 211.5, "km/h", 1.8);  // 215.73: 0.075 / 0.255 = 0.29 of them
    EXPECT_NEAR(scene.verdict().decision->probability, 0.61564, 2e-4);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    EXPECT_NEAR(*scene.verdict().record->expanded_uncertainty, 1.8, 1e-15);
}

TEST(Margin, AboveTheUpperLimitHasTheRecordsUncertaintyInIt) {
    RuleScene scene(with_margin("{kind: relative, value: 0.02, above: upper_limit}",
                                "rounding: {mode: truncate, unit: km/h, decimals: 2}\n"));
    set_record(scene, 200.0, "km/h", 1.8);
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.required_speed_m_s, 205.83 / 3.6, 1e-9);  // 201.8 x 1.02 = 205.836
    EXPECT_EQ(verdict.decision->required_speed_standard_uncertainty_m_s, 0.0);
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
}

const char* const course_window = "{kind: course, distance_m: 500, definition: elapsed_time}";

TEST(Margin, OfElapsedTimeOverACourse) {
    RuleScene scene(profile_text(clause_text("margin"), {},
                                 "{kind: elapsed_time, value: 0.01, unit: s}", course_window));
    set_record(scene, 50.0, "m/s", 0.0);  // 10 s over 500 m
    EXPECT_NEAR(*scene.verdict().required_speed_m_s, 500.0 / 9.99, 1e-12);
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
}

TEST(Margin, WithoutARecordIsForAPersonAndWithoutASpeedIsNotMet) {
    RuleScene scene(with_margin("{kind: absolute, value: 1, unit: km/h}"));
    scene.attempt.record.reset();
    EXPECT_EQ(scene.clause("margin").status, RequirementStatus::attest);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    set_record(scene, 100.0, "km/h", 0.0);
    scene.windows().best.reset();
    EXPECT_EQ(scene.clause("margin").status, RequirementStatus::not_met);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
}

TEST(Margin, NeedsTheProbabilityThatTheProfileAsksFor) {
    RuleScene scene(
        with_margin("{kind: absolute, value: 0, unit: m/s}", "decision: {probability: 0.9}\n"));
    set_record(scene, 59.9935, "m/s", 0.0);  // 1.3 standard deviations: 0.9032
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    set_record(scene, 59.9937, "m/s", 0.0);  // 1.26: 0.8962
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    set_record(scene, 60.0065, "m/s", 0.0);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
}

// The current, where the rule subtracts it.

TEST(SubtractedCurrent, IsTakenOffWithItsUncertainty) {
    RuleScene scene(with_margin("{kind: absolute, value: 0, unit: kn}", "current: subtracted\n"));
    set_current(scene, 0.5, 60.0, 0.06);  // towards 60 degrees; the window goes north
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.current_subtracted_m_s, 0.25, 1e-12);
    EXPECT_NEAR(*verdict.speed_m_s, 59.75, 1e-12);
    EXPECT_NEAR(*verdict.expanded_uncertainty_m_s, 2.0 * std::hypot(0.005, 0.03), 1e-12);
    EXPECT_TRUE(std::ranges::any_of(verdict.notes, [](const std::string& note) {
        return contains(note,
                        "The current along the course, +0.90 km/h, is subtracted from 216.00 "
                        "km/h over the ground.");
    }));
    set_current(scene, 0.5, 180.0, 0.06);  // against it
    EXPECT_NEAR(*scene.verdict().speed_m_s, 60.5, 1e-12);
}

TEST(SubtractedCurrent, WidensTheTailAsItDoesTheInterval) {
    RuleScene scene(with_margin("{kind: absolute, value: 0, unit: kn}", "current: subtracted\n"));
    scene.best().evidence = SpeedEvidence{.position_standard_uncertainty_m_s = 0.005,
                                          .fault_probability = 1e-6,
                                          .chosen_fault_probability = 1e-6,
                                          .fault_m_s = 0.01};
    set_current(scene, 0.5, 60.0, 0.06);
    const ProfileVerdict verdict = scene.verdict();
    const double one_in_ten_thousand = 3.719;
    EXPECT_NEAR(*verdict.speed_m_s - verdict.decision->tail_speed_m_s.value(),
                one_in_ten_thousand * std::hypot(0.005, 0.03), 1e-4);
}

TEST(SubtractedCurrent, ThatIsNotKnownIsNotCertifiable) {
    RuleScene scene(with_margin("{kind: absolute, value: 0, unit: kn}", "current: subtracted\n"));
    const auto refused = [&] {
        const ProfileVerdict verdict = scene.verdict();
        EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
        EXPECT_FALSE(verdict.speed_m_s || verdict.decision || verdict.shown);
        EXPECT_TRUE(contains(verdict.reason,
                             "The rule subtracts the current, which is not known "
                             "for the window: give current: in the attempt"))
            << verdict.reason;
    };
    refused();
    set_current(scene, 0.5, 0.0, 0.06);
    scene.current = steady(0.5, 0.0, 0.0, 20.0);
    refused();
    set_current(scene, 0.5, 0.0, 0.06);
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    // A rule that ignores it is not touched by it.
    scene.current.reset();
    scene.use(with_margin("{kind: absolute, value: 0, unit: kn}"));
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    EXPECT_FALSE(scene.verdict().current_subtracted_m_s.has_value());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
