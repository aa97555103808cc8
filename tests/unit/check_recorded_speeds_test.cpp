#include <gtest/gtest.h>

#include "check_rules_support.h"

// Whether recorded speeds are those of the positions beside them.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace test;

WitnessedSpeed by_positions(double speed_m_s, double standard_uncertainty_m_s,
                            double normalised_error) {
    WitnessedSpeed witness;
    witness.kind = WitnessKind::positions;
    witness.speed_m_s = speed_m_s;
    witness.standard_uncertainty_m_s = standard_uncertainty_m_s;
    witness.difference_m_s = 60.0 - speed_m_s;
    witness.normalised_error = normalised_error;
    return witness;
}

/// A rule of recorded speeds; its window shows 60 m/s.
struct SpeedScene : RuleScene {
    explicit SpeedScene(const WitnessedSpeed& positions)
        : RuleScene(profile_text(clause_text("margin"), {},
                                 "{kind: absolute, value: 1, unit: km/h}",
                                 "{duration_s: 3, definition: mean_n, source: velocity}")) {
        best().witnesses = {positions};
        judged.tests.velocity = VelocityComparison{
            .origin = VelocityOrigin::independent, .compared = 400, .contradicted_share = 0.01};
    }
    Requirement asked() {
        const ProfileVerdict all = verdict();
        for (const Requirement& requirement : all.requirements)
            if (requirement.clause == "speeds-of-these-positions") return requirement;
        throw std::runtime_error("not asked");
    }
};

TEST(RecordedSpeeds, AreAskedForOnlyByARuleOfThem) {
    RuleScene scene(profile_text(clause_text("margin")));
    for (const Requirement& requirement : scene.verdict().requirements)
        EXPECT_NE(requirement.decided_by, Computation::recorded_speeds);
}

TEST(RecordedSpeeds, AreMetByPositionsThatCouldHaveContradictedThem) {
    SpeedScene scene(by_positions(60.01, 0.005, 0.2));
    EXPECT_EQ(scene.asked().status, RequirementStatus::met) << scene.asked().evidence;
}

TEST(RecordedSpeeds, AreToBeAttestedWherePositionsAgreeWithAnything) {
    SpeedScene scene(by_positions(60.01, 2.0, 0.2));
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.asked().evidence, "too uncertain to confirm"));
    // Changes of speed over a stretch that holds the window tell that they are of its moments.
    scene.judged.tests.velocity->delays = {{.first_epoch = 1, .last_epoch = 400, .delay_s = 0.0}};
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest) << "nothing showed their scale";
    scene.judged.tests.velocity->ratio = 1.002;
    scene.judged.tests.velocity->sigma_ratio = 0.0005;
    EXPECT_EQ(scene.asked().status, RequirementStatus::met) << scene.asked().evidence;
    EXPECT_TRUE(contains(scene.asked().evidence, "0 s behind the positions"));
    scene.judged.tests.velocity->delays[0].first_epoch = 270;
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
    scene.judged.tests.velocity->delays[0] = {
        .first_epoch = 1, .last_epoch = 400, .delay_s = 43.0, .beyond = true};
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
}

/// Positions of ± 3.5 km/h met it beside speeds of ± 1.3 km/h that were 1 % too high.
TEST(RecordedSpeeds, OfAWindowAreMetOnlyWhereOnePerCentWouldShow) {
    SpeedScene scene(by_positions(60.0, 0.5, 0.2));
    scene.best().standard_uncertainty_m_s = 0.17;
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest) << scene.asked().evidence;
    scene.best().witnesses[0].standard_uncertainty_m_s = 0.2;
    EXPECT_EQ(scene.asked().status, RequirementStatus::met) << scene.asked().evidence;
    scene.best().witnesses[0].position_standard_uncertainty_m_s = 0.15;  // 2.84 x 0.25 m/s
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest) << scene.asked().evidence;
}

/// Velocities times 1.01 beside positions of 2 m met the clause because their delay was known.
TEST(RecordedSpeeds, OfAKnownDelayAreMetOnlyWhereTheirScaleWasSeen) {
    SpeedScene scene(by_positions(60.01, 2.0, 0.2));
    VelocityComparison& velocity = *scene.judged.tests.velocity;
    velocity.delays = {{.first_epoch = 1, .last_epoch = 400, .delay_s = 0.0}};
    velocity.ratio = 1.01;
    velocity.sigma_ratio = 0.0005;
    const Requirement apart = scene.asked();
    EXPECT_EQ(apart.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(apart.evidence, "the speeds are 1.0100 ± 0.0061 times")) << apart.evidence;
    velocity.ratio = 0.99;
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
    // Positions that would not show 1 % in the whole recording either confirm nothing.
    velocity.ratio = 1.0;
    velocity.sigma_ratio = 0.0019;
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
    velocity.sigma_ratio = 0.0017;
    EXPECT_EQ(scene.asked().status, RequirementStatus::met) << scene.asked().evidence;
    velocity.ratio = 1.0068;
    EXPECT_EQ(scene.asked().status, RequirementStatus::met);
    velocity.ratio = 1.0070;
    EXPECT_EQ(scene.asked().status, RequirementStatus::attest);
}

/// "1703 ± 3321 km/h, normalised error 0.48" is not agreement.
TEST(RecordedSpeeds, AreNotMetByPositionsThatSayNothing) {
    SpeedScene scene(by_positions(1703.0 / 3.6, 0.5 * 3321.0 / 3.6, 0.48));
    scene.judged.tests.velocity->delays = {{.first_epoch = 1, .last_epoch = 400, .delay_s = 0.0}};
    EXPECT_EQ(scene.asked().status, RequirementStatus::not_met);
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(verdict.reason, "speeds-of-these-positions")) << verdict.reason;
    EXPECT_TRUE(contains(verdict.reason, "too uncertain to confirm, or to contradict"))
        << verdict.reason;
    // A third of the speed is hidden by no uncertainty that is let through.
    SpeedScene third(by_positions(60.0, 14.0, 0.4));
    EXPECT_EQ(third.asked().status, RequirementStatus::attest);
    SpeedScene more(by_positions(60.0, 16.0, 0.4));
    EXPECT_EQ(more.asked().status, RequirementStatus::not_met);
}

TEST(RecordedSpeeds, AreNotMetWherePositionsContradictThem) {
    SpeedScene scene(by_positions(20.0, 0.1, 40.0));
    EXPECT_EQ(scene.asked().status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(scene.verdict().reason, "one of the two is wrong"));
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
}

TEST(RecordedSpeeds, ThatContradictTooManyEpochsAreNoSource) {
    SpeedScene scene(by_positions(60.01, 0.005, 0.2));
    VelocityComparison& velocity = *scene.judged.tests.velocity;
    velocity.contradicted_share = 0.96;
    velocity.unfit = true;
    velocity.delays = {{.first_epoch = 1,
                        .last_epoch = 400,
                        .delay_s = 43.0,
                        .difference_m_s = 0.3,
                        .difference_within_m_s = 6.27,
                        .beyond = true}};
    scene.judged.windows.profiles.at(0).indicated = IndicatedWindow{.speed_m_s = 61.0};
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    for (const char* part :
         {"over epochs 1 to 400 they are 43 s behind the positions (the speeds differ by 6.27 "
          "m/s, at that delay by 0.30 m/s)",
          "contradict the positions at 96 % of the epochs, more than 5 % "
          "(screen.velocity_share_max)",
          "the recorded velocities show 219.600 km/h"})
        EXPECT_TRUE(contains(verdict.reason, part)) << verdict.reason;
}

TEST(RecordedSpeeds, ThatContradictTooManyEpochsConfirmNoPositions) {
    RuleScene scene(profile_text(clause_text("margin")));
    WitnessedSpeed velocities = by_positions(60.01, 0.005, 0.2);
    velocities.kind = WitnessKind::velocities;
    scene.best().witnesses = {velocities};
    scene.judged.tests.velocity = VelocityComparison{.compared = 400, .contradicted_share = 0.06};
    EXPECT_EQ(scene.verdict().witnesses.size(), 1U);
    scene.judged.tests.velocity->unfit = true;
    EXPECT_TRUE(scene.verdict().witnesses.empty());
    // But what they contradict they still contradict.
    scene.best().witnesses[0].normalised_error = 1.5;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
