#include <gtest/gtest.h>

#include <cmath>

#include "check_rules_support.h"

// Outcome and reason where a window was refused, where several attempts were made, where choosing
// the window may have left a bias, and what drift a decision survives.

namespace runcert::RUNCERT_FILE {
namespace {

using test::clause_text, test::contains, test::profile_text, test::RuleScene;

constexpr double kmh = 1.0 / 3.6;
constexpr double required_speed_m_s = 203.9 * kmh;

/// The normal tail, not by the code under test.
double phi(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

/// Certified by so much above the required speed, with 0.005 m/s.
RuleScene above_target(double above_m_s) {
    RuleScene scene(profile_text(clause_text("margin")));
    scene.best().speed_m_s = required_speed_m_s + above_m_s;
    return scene;
}

IndicatedWindow refused(double speed_m_s) {
    IndicatedWindow window{
        .span = {}, .speed_m_s = speed_m_s, .refusals = {"a gap", "an epoch without a position"}};
    window.span.start.nanoseconds = 31'500'000'000;
    return window;
}

TEST(RefusedWindow, ThatReachesTheTargetMakesNotBeatenNotCertifiableAndIsNamed) {
    for (const double above : {0.0, 1e-6, 5.0}) {
        RuleScene scene = above_target(-5.0);
        scene.windows().indicated = refused(required_speed_m_s + above);
        const ProfileVerdict verdict = scene.verdict();
        EXPECT_EQ(verdict.outcome, Outcome::not_certifiable) << above;
        EXPECT_FALSE(verdict.decision->risk);
    }
    RuleScene scene = above_target(-5.0);
    scene.windows().indicated = refused(57.5);
    const std::string reason = scene.verdict().reason;
    for (const char* part :
         {"shows 207.000 km/h 31.5 s after the first epoch", "required 203.900 km/h",
          "(it holds a gap, an epoch without a position)", "185.900 km/h",
          "does not show that the record was not beaten"})
        EXPECT_TRUE(contains(reason, part)) << reason;
}

TEST(RefusedWindow, BelowTheTargetOrOfWhatIsCertifiedChangesNothing) {
    RuleScene scene = above_target(-5.0);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    scene.windows().indicated = refused(required_speed_m_s - 1e-6);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    scene.windows().indicated = refused(57.5);
    scene.windows().indicated->refusals.clear();  // the fastest is the certified one
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
}

TEST(RefusedWindow, ChangesNothingOfOtherOutcomes) {
    for (const auto& [above, outcome] :
         {std::pair{0.0, Outcome::not_proven}, {0.1, Outcome::beaten}}) {
        RuleScene scene = above_target(above);
        scene.windows().indicated = refused(required_speed_m_s + 5.0);
        EXPECT_EQ(scene.verdict().outcome, outcome);
    }
}

TEST(RefusedWindow, OfAMeanIsJudgedByTheMean) {
    RuleScene scene = above_target(-5.0);
    scene.windows().indicated = refused(required_speed_m_s + 3.0);
    scene.windows().indicated->mean_m_s = required_speed_m_s - 1.0;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    scene.windows().indicated->mean_m_s = required_speed_m_s + 1.0;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
}

TEST(AttemptsMade, ShareTheRiskOfOne) {
    for (const std::int64_t attempts : {1, 2, 7, 40, 1000}) {
        RuleScene scene = above_target(0.1);
        scene.attempt.attempts_made = attempts;
        const Decision decision = *scene.verdict().decision;
        const double level = 1.0 - 0.025 / static_cast<double>(attempts);
        EXPECT_EQ(decision.attempts_made, attempts);
        EXPECT_NEAR(decision.level, level, 1e-15);
        // Where the normal tail leaves the risk.
        EXPECT_NEAR(phi((decision.acceptance_limit_m_s - required_speed_m_s) / 0.005), level, 1e-9);
    }
    EXPECT_EQ(above_target(0.1).verdict().decision->attempts_made, 1);
}

TEST(AttemptsMade, OfManyTheBestNeedsMore) {
    // Phi(3) = 0.99865 is enough for one, at 0.975, and not for 40, at 0.999375.
    RuleScene scene = above_target(0.015);
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    scene.attempt.attempts_made = 40;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    EXPECT_TRUE(contains(scene.verdict().reason, "at least 99.9375 % required"))
        << scene.verdict().reason;
    EXPECT_EQ(scene.clause("margin").status, RequirementStatus::not_met);
    scene.best().speed_m_s = required_speed_m_s + 0.0165;  // 3.3 u, 0.99952
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
    // Reached, and the record is what the attempt says it is.
    EXPECT_EQ(scene.clause("margin").status, RequirementStatus::attest);
    scene.best().speed_m_s = required_speed_m_s - 0.015;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    scene.attempt.attempts_made = 1;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
}

TEST(BiasLimit, IsAddedToTheExpandedUncertaintyAndToTheGuardBand) {
    RuleScene scene = above_target(0.0298);  // 1.96 x 0.005 + 0.02 = 0.0298
    scene.best().bias_limit_m_s = 0.02;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.expanded_uncertainty_m_s, 0.03, 1e-12);
    EXPECT_EQ(verdict.decision->bias_limit_m_s, 0.02);
    EXPECT_NEAR(verdict.decision->acceptance_limit_m_s - required_speed_m_s,
                1.959964 * 0.005 + 0.02, 1e-8);
    EXPECT_NEAR(verdict.decision->probability, phi(1.96), 1e-9);
    EXPECT_NEAR(*verdict.decision->risk, phi(-1.96), 1e-9);
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    scene.best().speed_m_s = required_speed_m_s + 0.0297;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    scene.best().speed_m_s = required_speed_m_s - 0.0297;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_proven);
    scene.best().speed_m_s = required_speed_m_s - 0.0299;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_beaten);
    EXPECT_NEAR(*scene.verdict().decision->risk, phi(-1.98), 1e-9);
}

TEST(BiasLimit, OfAMeanOfWindowsIsTheMeanOfTheirs) {
    RuleScene scene(profile_text(clause_text("margin"), "",
                                 "{kind: absolute, value: 1, unit: km/h}",
                                 "{duration_s: 3, definition: displacement, count: 2}"));
    scene.best().bias_limit_m_s = 0.02;
    FurtherWindow other{
        .span = scene.best().span, .arc = 1, .speed_m_s = 59.0, .standard_uncertainty_m_s = 0.015};
    other.bias_limit_m_s = 0.04;
    scene.windows().further = {other};
    EXPECT_EQ(scene.verdict().decision->bias_limit_m_s, 0.03);
    EXPECT_NEAR(*scene.verdict().expanded_uncertainty_m_s, 2.0 * 0.01 + 0.03, 1e-12);
}

TEST(Drift, ThatADecisionSurvivesIsSaid) {
    RuleScene scene = above_target(0.14);
    for (ScreenedEpoch& row : scene.rows())
        row.detectable.ramp_m_s = 0.05;
    scene.rows()[12].detectable.ramp_m_s = 0.07;  // where it is hardest to find
    scene.best().detection_power = 0.8;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.decision->drift_survived_m, 0.42, 1e-9);  // 0.14 m/s x 3 s
    EXPECT_EQ(*verdict.decision->drift_found_m_s, 0.07);
    EXPECT_TRUE(contains(verdict.reason,
                         "To undo this, the positions would have to drift by 0.42 m in 3 s; "
                         "screening finds a drift of 0.21 m there with a probability of 80 %."))
        << verdict.reason;
    scene.best().bias_limit_m_s = 0.04;
    EXPECT_NEAR(*scene.verdict().decision->drift_survived_m, 0.3, 1e-9);
}

// A wheel calibrated by drifting positions was said to bound their error.
TEST(Drift, IsBoundedByWitnessesThatConfirm) {
    RuleScene scene = above_target(0.14);
    for (ScreenedEpoch& row : scene.rows())
        row.detectable.ramp_m_s = 0.05;
    scene.best().detection_power = 0.8;
    WitnessedSpeed wheel{.kind = WitnessKind::wheel, .standard_uncertainty_m_s = 0.02};
    wheel.speed_m_s = scene.best().speed_m_s;
    wheel.fault_posterior = wheel.chance_error = 0.0;
    for (const bool confirms : {true, false}) {
        wheel.confirms = confirms;
        scene.best().witnesses = {wheel};
        const std::string reason = scene.verdict().reason;
        EXPECT_EQ(contains(reason, "beside the speeds of a wheel their error is at most 0.12 m"),
                  confirms)
            << reason;
        EXPECT_EQ(contains(reason, "screening finds a drift of 0.15 m"), !confirms) << reason;
    }
}

// Screening finds 0.21 m with a probability of 80 %. By its normal statistic (threshold 4.75 for a
// test size of 2.03e-6) half of the drifts of 4.75 / (4.75 + 0.84) of that are found, 0.178 m.
TEST(Drift, ThatScreeningWouldMissIsSaidToBeSo) {
    const auto reason = [](double above_m_s, double found_m_s) {
        RuleScene scene = above_target(above_m_s);
        for (ScreenedEpoch& row : scene.rows())
            row.detectable.ramp_m_s = found_m_s;
        scene.best().detection_power = 0.8;
        scene.judged.tests.test_size = 2.03e-6;
        const ProfileVerdict verdict = scene.verdict();
        EXPECT_EQ(verdict.outcome, Outcome::beaten);
        return verdict.reason;
    };
    for (const double above_m_s : {0.04, 0.059})
        EXPECT_TRUE(contains(reason(above_m_s, 0.07),
                             fmt::format(" A drift of {:.2f} m over 3 s would reverse this "
                                         "outcome; screening would miss most drifts that small.",
                                         3.0 * above_m_s)))
            << reason(above_m_s, 0.07);
    EXPECT_TRUE(contains(reason(0.06, 0.07),
                         "A drift of 0.18 m over 3 s would reverse this outcome; screening finds "
                         "drifts that small with a probability below 80 %."))
        << reason(0.06, 0.07);
    for (const double above_m_s : {0.07001, 0.14}) {
        const std::string said = reason(above_m_s, 0.07);
        EXPECT_TRUE(contains(said, "To undo this, the positions would have to drift by")) << said;
        EXPECT_TRUE(contains(said, "screening finds a drift of 0.21 m there with a probability of"))
            << said;
        EXPECT_FALSE(contains(said, "would reverse this outcome")) << said;
    }
}

TEST(NextTime, SaysWhatVelocitiesWouldBring) {
    const auto notes = [](double above_m_s, std::optional<double> expected_m_s) {
        RuleScene scene = above_target(above_m_s);
        scene.best().expected_beside_velocities_m_s = expected_m_s;
        std::string all;
        for (const std::string& note : scene.verdict().notes)
            all += note + "\n";
        return all;
    };
    EXPECT_TRUE(contains(notes(0.005, 0.003), "about ± 0.011 km/h in the next run"))
        << notes(0.005, 0.003);
    // It would help too little, nothing is known of it, or nothing is to be helped.
    EXPECT_FALSE(contains(notes(0.005, 0.009), "next run"));
    EXPECT_FALSE(contains(notes(0.005, std::nullopt), "next run"));
    EXPECT_FALSE(contains(notes(0.1, 0.003), "next run"));
    EXPECT_FALSE(contains(notes(-0.1, 0.003), "next run"));
}

TEST(Drift, IsMeasuredByAWitness) {
    RuleScene scene = above_target(0.14);
    WitnessedSpeed witness;
    witness.kind = WitnessKind::velocities;
    witness.speed_m_s = 60.0;
    witness.difference_m_s = -0.02;
    witness.standard_uncertainty_m_s = 0.03;
    scene.best().witnesses = {witness};
    const std::string reason = scene.verdict().reason;
    EXPECT_TRUE(contains(reason,
                         "drift by 0.42 m in 3 s; beside the recorded velocities their error is at "
                         "most 0.24 m (k = 2)."))
        << reason;
}

TEST(Drift, IsLeftOutWhereScreeningDoesNotSayWhatItFinds) {
    const ProfileVerdict verdict = above_target(0.14).verdict();
    EXPECT_FALSE(verdict.decision->drift_found_m_s);
    EXPECT_TRUE(contains(verdict.reason, "by 0.42 m in 3 s.")) << verdict.reason;
}

TEST(Drift, IsNotSurvivedByWhatIsNotAboveTheTarget) {
    for (const double above : {-0.1, 0.0, 0.0199}) {
        RuleScene scene = above_target(above);
        scene.best().bias_limit_m_s = 0.02;
        EXPECT_FALSE(scene.verdict().decision->drift_survived_m) << above;
        EXPECT_FALSE(contains(scene.verdict().reason, "drift")) << above;
    }
}

TEST(Reason, SaysPositionsAloneOfEveryOutcomeWithoutAWitness) {
    for (const double above : {-0.1, 0.0, 0.1})
        EXPECT_EQ(above_target(above).verdict().reason.find("By positions alone, the "), 0U);
    RuleScene velocity = above_target(0.1);
    velocity.use(profile_text(clause_text("margin"), "", "{kind: absolute, value: 1, unit: km/h}",
                              "{duration_s: 3, definition: mean_n, source: velocity}"));
    EXPECT_FALSE(contains(velocity.verdict().reason, "positions alone"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
