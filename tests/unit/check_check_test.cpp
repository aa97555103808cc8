#include "stages/check/check.h"

#include <gtest/gtest.h>

#include "core/failure.h"
#include "core/text.h"
#include "core/uncertainty.h"
#include "stages/check/decision.h"

namespace runcert {
namespace {

constexpr double kmh = 1.0 / 3.6;

Profile builtin(const char* name) {
    return read_profile(builtin_profile(name), name);
}

TEST(Target, NalsaIsOneMileAnHourAboveTheRecord) {
    EXPECT_NEAR(target_speed(builtin("nalsa"), 126.2 * 1609.344 / 3600.0),
                127.2 * 1609.344 / 3600.0, 1e-12);
}

TEST(Target, FislyIsTwoPerMilAboveTheRecordTruncated) {
    // Published: after 222.43 km/h the next target was 222.87 (222.87486, truncated).
    EXPECT_EQ(format_fixed(target_speed(builtin("fisly"), 222.43 * kmh) / kmh, 6), "222.870000");
    // 250 km/h gives 250.50 exactly: not cut to 250.49 by the rounding of binary fractions.
    EXPECT_EQ(format_fixed(target_speed(builtin("fisly"), 250.0 * kmh) / kmh, 6), "250.500000");
}

struct DecisionCase {
    double speed, uncertainty, target;
    const char* outcome;
};

TEST(Decision, AroundEveryBoundary) {
    for (const DecisionCase& one : {DecisionCase{60.0, 0.1, 59.9, "beaten"},  // reaches exactly
                                    {60.0, 0.1, 59.95, "not_proven"},
                                    {60.0, 0.1, 60.0, "not_proven"},
                                    {60.0, 0.1, 60.000001, "not_beaten"},
                                    {60.0, 0.0, 60.0, "beaten"},
                                    {60.0, 0.1, 61.0, "not_beaten"},
                                    {60.0, 5.0, 56.0, "not_proven"}})
        EXPECT_EQ(decide(one.speed, one.uncertainty, one.target), one.outcome)
            << one.speed << " " << one.uncertainty << " " << one.target;
}

TEST(CoverageFactor, IsStudentsForFewDegreesOfFreedom) {
    EXPECT_EQ(equivalent_coverage_factor(2.0, std::nullopt), 2.0);
    // [GUM] table G.2: for k = 2 (95.45 %) 4.53 with 2 degrees of freedom, 2.87 with 4, 2.28 with
    // 10, 2.13 with 20, 2.05 with 50; for k = 3 (99.73 %) 3.96 with 10.
    for (const auto& [degrees, factor] :
         {std::pair{2.0, 4.53}, {4.0, 2.87}, {10.0, 2.28}, {20.0, 2.13}, {50.0, 2.05}})
        EXPECT_NEAR(equivalent_coverage_factor(2.0, degrees), factor, 0.00501) << degrees;
    EXPECT_NEAR(equivalent_coverage_factor(3.0, 10.0), 3.96, 0.00501);
    EXPECT_NEAR(equivalent_coverage_factor(2.0, 1e9), 2.0, 1e-6);
}

/// An attempt under nalsa with a window of given speed and uncertainty.
struct Scene {
    Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n"
        "record: {speed: 202.9, unit: km/h, source: published}\n",
        "attempt");
    std::vector<Profile> profiles{builtin("nalsa")};
    ReceiverEvidence judged;
    ReceiverEvidence secondary;

    Scene(double speed_mps, double standard_uncertainty_mps) {
        judged.receiver = "primary";
        judged.accuracy_source = "recording";
        set_window(judged, speed_mps, standard_uncertainty_mps);
        secondary.receiver = "secondary";
    }
    void set_window(ReceiverEvidence& receiver, double speed_mps, double uncertainty) const {
        ProfileWindows entry{.profile = "nalsa",
                             .duration_s = 3.0,
                             .definition = "displacement",
                             .candidates = 5,
                             .best = CertifiableWindow{},
                             .indicated = std::nullopt};
        entry.best->speed_mps = speed_mps;
        entry.best->standard_uncertainty_mps = uncertainty;
        entry.best->span.duration.nanoseconds = 3'000'000'000;
        receiver.windows.profiles = {entry};
    }
    ProfileVerdict verdict(bool with_secondary = false) const {
        return check({.attempt = attempt,
                      .profiles = profiles,
                      .judged = judged,
                      .secondary = with_secondary ? &secondary : nullptr})
            .profiles.at(0);
    }
};

std::string status_of(const ProfileVerdict& verdict, const std::string& clause) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == clause) return requirement.status;
    return "no such clause";
}

TEST(Check, ARecordBeaten) {
    const ProfileVerdict verdict = Scene(60.0, 0.005).verdict();
    EXPECT_EQ(verdict.outcome, "beaten");
    EXPECT_EQ(status_of(verdict, "average-over-3-s"), "met");
    EXPECT_EQ(status_of(verdict, "accuracy"), "met");
    EXPECT_EQ(status_of(verdict, "margin"), "met");
    EXPECT_EQ(status_of(verdict, "positions-on-the-earth"), "met");
    EXPECT_EQ(status_of(verdict, "secondary-method"), "attest");
    EXPECT_EQ(status_of(verdict, "own-start"), "attest");
    EXPECT_NEAR(*verdict.expanded_uncertainty_mps, 0.010, 1e-12);
}

TEST(Check, FewDegreesOfFreedomWidenTheExpandedUncertainty) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best->effective_degrees_of_freedom = 4.0;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(verdict.coverage_factor, 2.87, 0.005);  // [GUM] table G.2
    EXPECT_NEAR(*verdict.expanded_uncertainty_mps, verdict.coverage_factor * 0.005, 1e-15);
    // 0.2222 m/s over 2.87 is 0.0774: within the limit for many degrees of freedom, not for four.
    scene.judged.windows.profiles[0].best->standard_uncertainty_mps = 0.08;
    EXPECT_EQ(status_of(scene.verdict(), "accuracy"), "not_met");
    scene.judged.windows.profiles[0].best->effective_degrees_of_freedom.reset();
    EXPECT_EQ(status_of(scene.verdict(), "accuracy"), "met");
}

TEST(Check, ARobustEstimateThatDisagreesIsNotCertifiable) {
    Scene scene(60.0, 0.005);
    RobustSpeed robust{.speed_mps = 60.1,
                       .difference_mps = 0.1,
                       .limit_mps = 0.012,
                       .agrees = false,
                       .downweighted = 3};
    scene.judged.windows.profiles[0].best->robust = robust;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, "not_certifiable");
    for (const char* part : {"robust", "+0.360 km/h", "0.043 km/h", "screening"})
        EXPECT_NE(verdict.reason.find(part), std::string::npos) << verdict.reason;
    robust.agrees = true;
    scene.judged.windows.profiles[0].best->robust = robust;
    EXPECT_EQ(scene.verdict().outcome, "beaten");
}

TEST(Check, TheStatementsStandInTheVerdict) {
    const Scene scene(60.0, 0.005);
    const Verdict verdict =
        check({.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged});
    ASSERT_GE(verdict.statements.size(), 2U);
    EXPECT_NE(verdict.statements.front().find("budget"), std::string::npos);
}

TEST(Check, AnAccuracyBeyondTheLimitIsNotCertifiable) {
    // 0.8 km/h is 0.2222 m/s: twice 0.112 m/s is beyond, twice 0.111 m/s is within.
    EXPECT_EQ(Scene(60.0, 0.112).verdict().outcome, "not_certifiable");
    EXPECT_EQ(status_of(Scene(60.0, 0.112).verdict(), "accuracy"), "not_met");
    EXPECT_EQ(Scene(60.0, 0.111).verdict().outcome, "beaten");
}

TEST(Check, NotBeatenAndNotProven) {
    const double target = 202.9 * kmh + 1609.344 / 3600.0;
    EXPECT_EQ(Scene(target - 0.001, 0.005).verdict().outcome, "not_beaten");
    EXPECT_EQ(Scene(target + 0.005, 0.005).verdict().outcome, "not_proven");
    EXPECT_EQ(status_of(Scene(target + 0.005, 0.005).verdict(), "margin"), "not_met");
    EXPECT_EQ(Scene(target + 0.011, 0.005).verdict().outcome, "beaten");
}

TEST(Check, WithoutARecordNothingIsBeaten) {
    Scene scene(60.0, 0.005);
    scene.attempt.record.reset();
    EXPECT_EQ(scene.verdict().outcome, "not_proven");
}

TEST(Check, WithoutAWindowNothingIsCertifiable) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].best.reset();
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, "not_certifiable");
    EXPECT_FALSE(verdict.speed_mps.has_value());
    EXPECT_EQ(status_of(verdict, "average-over-3-s"), "not_met");
}

TEST(Check, LocalPlaneCoordinatesAreForAPersonToAnswerFor) {
    Scene scene(60.0, 0.005);
    scene.judged.facts.georeferenced = false;
    EXPECT_EQ(status_of(scene.verdict(), "positions-on-the-earth"), "attest");
    const Verdict verdict =
        check({.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged});
    EXPECT_FALSE(verdict.georeferenced);
}

TEST(Check, TwoReceiversMustAgree) {
    Scene scene(60.0, 0.005);
    scene.set_window(scene.secondary, 60.013, 0.005);  // E_n = 0.013 / 0.01414 = 0.92
    EXPECT_EQ(status_of(scene.verdict(true), "secondary-method"), "met");
    EXPECT_EQ(scene.verdict(true).outcome, "beaten");
    scene.set_window(scene.secondary, 60.015, 0.005);  // 1.06
    EXPECT_EQ(status_of(scene.verdict(true), "secondary-method"), "not_met");
    EXPECT_EQ(scene.verdict(true).outcome, "not_certifiable");
}

TEST(Check, WindowsOfAnotherRuleAreRefused) {
    Scene scene(60.0, 0.005);
    scene.judged.windows.profiles[0].duration_s = 2.0;
    EXPECT_THROW(scene.verdict(), Failure);
}

}  // namespace
}  // namespace runcert
