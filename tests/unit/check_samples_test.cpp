#include <gtest/gtest.h>

#include "check_rules_support.h"

// What a rule asks of every sample of its windows, and of the device that recorded them.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace test;

/// A rule of recorded speeds with this clause. Its window, and another one that makes the figure
/// with it, have epochs at 10 Hz with 60 m/s from 9 satellites.
struct SampleScene : RuleScene {
    explicit SampleScene(const std::string& computation, const std::string& more = {})
        : RuleScene(profile_text(clause_text("window_complete") + clause_text(computation, more),
                                 {}, "{kind: absolute, value: 1, unit: km/h}",
                                 "{duration_s: 3, definition: mean_n, source: velocity}")) {
        for (ScreenedEpoch& row : rows())
            record(row);
        judged.further_epochs[profiles[0].id] = {rows()};
    }

    static void record(ScreenedEpoch& row) {
        row.recorded_velocity_east_m_s = 0.0;
        row.recorded_velocity_north_m_s = 60.0;
        row.satellites = std::int16_t{9};
    }
    std::vector<ScreenedEpoch>& other() { return judged.further_epochs[profiles[0].id][0]; }
};

TEST(SampleClauses, TheSpeedChangesByAtMostTheLimit) {
    SampleScene scene("acceleration", ", limit: 5, unit: m/s2");
    EXPECT_EQ(scene.clause("acceleration").status, RequirementStatus::met);
    scene.rows()[7].recorded_velocity_north_m_s = 60.4;  // 4 m/s2 up to it, and back
    Requirement clause = scene.clause("acceleration");
    EXPECT_EQ(clause.status, RequirementStatus::met);
    ASSERT_EQ(clause.figures.size(), 1U);
    EXPECT_NEAR(clause.figures[0].value, 4.0, 1e-6);
    EXPECT_TRUE(contains(clause.evidence, "at most 5 m/s2")) << clause.evidence;
    scene.rows()[7].recorded_velocity_north_m_s = 60.6;
    scene.rows()[8].recorded_velocity_north_m_s = 60.3;
    clause = scene.clause("acceleration");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, fmt::format("epoch {}", scene.rows()[7].epoch)))
        << clause.evidence;
    EXPECT_TRUE(contains(clause.evidence, "is for an official")) << clause.evidence;
    scene.rows()[7].recorded_velocity_north_m_s = std::nullopt;
    EXPECT_EQ(scene.clause("acceleration").status, RequirementStatus::attest);
}

TEST(SampleClauses, AChangeBeyondWhatTheStatedAccuracyMakesIsNotMet) {
    SampleScene scene("acceleration", ", limit: 5, unit: m/s2");
    for (ScreenedEpoch& row : scene.rows())
        row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s = 0.5;
    // Chance makes 4.3 sqrt(2) 0.5 m/s / 0.1 s = 30 m/s2 of 62 samples.
    scene.rows()[7].recorded_velocity_north_m_s = 63.0;
    Requirement clause = scene.clause("acceleration");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, "30 m/s2, at most 5 m/s2")) << clause.evidence;
    EXPECT_TRUE(contains(clause.evidence, "and chance 30 m/s2 by what the samples state"))
        << clause.evidence;
    scene.rows()[7].recorded_velocity_north_m_s = 73.6;
    clause = scene.clause("acceleration");
    EXPECT_EQ(clause.status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(clause.evidence, "136 m/s2, at most 5 m/s2")) << clause.evidence;
    EXPECT_FALSE(contains(clause.evidence, "is for an official")) << clause.evidence;
    // A craft of the class can make 20 m/s2, and so can a nod of the head.
    scene.judged.tests.limits.acceleration_max_m_s2 = 110.0;
    EXPECT_EQ(scene.clause("acceleration").status, RequirementStatus::attest);
    scene.judged.tests.limits.acceleration_max_m_s2 = 20.0;
    // A larger change of samples that state nothing does not hide it.
    scene.rows()[20].recorded_velocity_north_m_s = 90.0;
    scene.rows()[20].sigma_recorded_velocity_north_m_s = std::nullopt;
    EXPECT_EQ(scene.clause("acceleration").status, RequirementStatus::not_met);
}

TEST(SampleClauses, HoldForEveryWindowThatMakesTheFigure) {
    SampleScene scene("acceleration", ", limit: 5, unit: m/s2");
    scene.other()[20].recorded_velocity_north_m_s = 61.0;
    EXPECT_EQ(scene.clause("acceleration").status, RequirementStatus::attest);
    SampleScene seen("satellites", ", limit: 5, unit: satellites");
    seen.other()[20].satellites = std::int16_t{4};
    EXPECT_EQ(seen.clause("satellites").status, RequirementStatus::not_met);
}

TEST(SampleClauses, EverySampleIsFromEnoughSatellites) {
    SampleScene scene("satellites", ", limit: 5, unit: satellites");
    scene.rows()[3].satellites = std::int16_t{5};
    Requirement clause = scene.clause("satellites");
    EXPECT_EQ(clause.status, RequirementStatus::met);
    EXPECT_EQ(clause.figures.at(0).value, 5.0);
    EXPECT_TRUE(contains(clause.evidence, "5 satellites, at least 5 satellites"))
        << clause.evidence;
    scene.rows()[3].satellites = std::nullopt;
    clause = scene.clause("satellites");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, "does not say at epoch 254")) << clause.evidence;
}

TEST(SampleClauses, SlowSamplesAreForAnOfficialBesideTheSpeedWithoutThem) {
    SampleScene scene("least_speed", ", limit: 5, unit: kn");
    EXPECT_EQ(scene.clause("least_speed").status, RequirementStatus::met);
    // 6 of the 60 samples after the first make 2 m/s, below 5 kn: 12 of 3252 parts of the distance.
    for (std::size_t i = 10; i < 16; ++i)
        scene.rows()[i].recorded_velocity_north_m_s = 2.0;
    const Requirement clause = scene.clause("least_speed");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, "3.88769 kn, at least 5 kn")) << clause.evidence;
    // 216 km/h less 12 / 3252 of it.
    EXPECT_TRUE(contains(clause.evidence, "the speed is 215.202 km/h")) << clause.evidence;
}

TEST(SampleClauses, TheDeductionIsPrintedAndTheMeasuredSpeedStays) {
    SampleScene scene("device_deduction");
    Requirement clause = scene.clause("device_deduction");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, "states no deduction")) << clause.evidence;
    const ProfileVerdict before = scene.verdict();
    scene.attempt.receivers[0].device_deduction = DeviceDeduction{.speed = 3.6, .unit = "km/h"};
    clause = scene.clause("device_deduction");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence,
                         "a deduction of 3.6 km/h for the device; it leaves "
                         "212.400 km/h of the measured speed, which reaches the "
                         "required 203.900 km/h"))
        << clause.evidence;
    EXPECT_NEAR(clause.figures.at(1).value, 212.4, 1e-6);
    EXPECT_EQ(scene.verdict().speed_m_s, before.speed_m_s);
    EXPECT_EQ(scene.verdict().outcome, before.outcome);
    scene.attempt.receivers[0].device_deduction = DeviceDeduction{.speed = 10.0, .unit = "kn"};
    EXPECT_TRUE(contains(scene.clause("device_deduction").evidence, "which does not reach"));
}

TEST(SampleClauses, TheSailAreaIsPrintedAndItsDivisionAttested) {
    SampleScene scene("sail_area");
    EXPECT_TRUE(contains(scene.clause("sail_area").evidence, "states no sail area"));
    scene.attempt.craft.sail_area_m2 = 7.75;
    const Requirement clause = scene.clause("sail_area");
    EXPECT_EQ(clause.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause.evidence, "a sail area of 7.75 m²")) << clause.evidence;
    EXPECT_EQ(clause.figures.at(0).value, 7.75);
}

TEST(SampleClauses, WithoutAWindowAreForAnOfficial) {
    for (const auto& [computation, more] : {std::pair{"acceleration", ", limit: 5, unit: m/s2"},
                                            {"satellites", ", limit: 5, unit: satellites"},
                                            {"least_speed", ", limit: 5, unit: kn"}}) {
        SampleScene scene(computation, more);
        scene.rows().clear();
        EXPECT_EQ(scene.clause(computation).status, RequirementStatus::attest) << computation;
    }
}

TEST(Questions, AreNotesForTheBodyAndNoRequirement) {
    RuleScene scene(profile_text(
        clause_text("window_complete"),
        "questions:\n  - {id: rounding, text: \"How is it rounded?\", source: none}\n"));
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(
        std::ranges::count(verdict.notes, "Question for the body: How is it rounded? (rounding)"),
        1);
    for (const Requirement& requirement : verdict.requirements)
        EXPECT_NE(requirement.clause, "rounding");
    RuleScene without(profile_text(clause_text("window_complete")));
    EXPECT_EQ(verdict.standing.attestations, without.verdict().standing.attestations);
}

TEST(Sources, OfTheBodysTextsGoWithTheRequirement) {
    RuleScene scene(profile_text(
        "  - {id: one, text: what one asks, source: rules, edition: \"2019\", where: \"3.2\", "
        "certainty: quoted, decided_by: attest}\n"
        "  - {id: two, text: what two asks, source: rules, looked_at: 2026-01-02, "
        "certainty: secondary, decided_by: attest}\n"
        "  - {id: ours, text: what we ask, source: this program's own requirement, where: "
        "\"METHOD.md, Times\", certainty: quoted, decided_by: attest}\n",
        "looked_at: 2026-11-27\n"));
    EXPECT_EQ(scene.clause("one").edition, "2019");
    EXPECT_EQ(scene.clause("one").where, "3.2");
    EXPECT_EQ(scene.clause("one").looked_at, "2026-11-27");
    EXPECT_EQ(scene.clause("two").looked_at, "2026-01-02");
    // The program has no editions: runs of every version of it are verified alike.
    EXPECT_EQ(scene.clause("ours").where, "");
    EXPECT_EQ(scene.clause("ours").looked_at, "");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
