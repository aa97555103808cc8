#include <gtest/gtest.h>

#include "reports/words/attempt.h"
#include "reports/words/decision.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// 60.02 m/s and more are accepted, where 60 m/s are required.
ProfileVerdict decided(Outcome outcome, double risk) {
    ProfileVerdict verdict;
    verdict.outcome = outcome;
    verdict.required_speed_m_s = 60.0;
    verdict.decision = Decision{.probability = outcome == Outcome::beaten ? 1.0 - risk : risk,
                                .acceptance_limit_m_s = 60.0 + 0.171 / 3.6,
                                .risk = risk};
    return verdict;
}

TEST(WordsOfTheDecision, TheGuardBandIsWhatTheAcceptanceLimitAdds) {
    EXPECT_EQ(guard_band_text(decided(Outcome::beaten, 0.0), speed_unit("km/h")),
              "w = 0.18 km/h (acceptance limit less required speed).");
    ProfileVerdict verdict = decided(Outcome::beaten, 0.0);
    verdict.required_speed_m_s.reset();
    EXPECT_EQ(guard_band_text(verdict, speed_unit("km/h")), "");
    verdict = decided(Outcome::beaten, 0.0);
    verdict.decision.reset();
    EXPECT_EQ(guard_band_figure(verdict, speed_unit("km/h")), "");
}

TEST(WordsOfTheDecision, TheRiskIsOfFalseAcceptanceOrOfFalseRejection) {
    EXPECT_EQ(risk_text(decided(Outcome::beaten, 0.00301)),
              "of false acceptance: 0.3010 % (that the true speed is below the required speed).");
    EXPECT_EQ(risk_text(decided(Outcome::not_beaten, 0.42)),
              "of false rejection: 42.00 % (that the true speed reaches the required speed).");
    // Beside a conformance probability of 0.0003 % it is another figure, and says why.
    ProfileVerdict apart = decided(Outcome::not_beaten, 0.00228);
    apart.decision->probability = 3e-6;
    EXPECT_EQ(risk_text(apart),
              "of false rejection: 0.2280 % (that the true speed reaches the required speed). It "
              "counts errors that nothing found for the craft; the conformance probability counts "
              "them against it.");
    // Neither is an outcome that could be wrong.
    for (const Outcome outcome : {Outcome::not_proven, Outcome::not_certifiable})
        EXPECT_EQ(risk_text(decided(outcome, 0.42)), "");
    ProfileVerdict verdict = decided(Outcome::beaten, 0.0);
    verdict.decision->risk.reset();
    EXPECT_EQ(risk_text(verdict), "");
}

TEST(WordsOfTheDecision, ARuleThatIsSilentOfUncertaintyIsLiterallySimpleAcceptance) {
    const auto rule = [](const std::string& more, const std::string& margin = "") {
        return read_profile(
            "schema: profile/1.0\nid: r\nbody: b\ntitle: t\nwindow: {duration_s: 3, definition: "
            "displacement}\nmargin: {kind: absolute, value: 1, unit: km/h" +
                margin + "}\n" + more +
                "clauses:\n  - {id: c, text: t, source: s, certainty: quoted, decided_by: "
                "attest}\n",
            "r.yaml");
    };
    const std::string silent =
        "The rule does not say how uncertainty counts in the decision. Read literally, that is "
        "simple acceptance, with w = 0: this program asks for more.";
    EXPECT_EQ(silent_rule_text(rule("")), silent);
    EXPECT_EQ(silent_rule_text(rule("accuracy: {limit: 0.8, unit: km/h, coverage_factor: 2}\n")),
              "The rule's limit of the expanded uncertainty is no guard band. " + silent);
    EXPECT_EQ(silent_rule_text(rule("decision: {probability: 0.95}\n")), "");
    EXPECT_EQ(silent_rule_text(rule("", ", above: upper_limit")), "");
    EXPECT_NE(silent_rule_text(read_profile(builtin_profile("nalsa"), "nalsa")), "");
}

WindowSpan window_at(const std::string& gps) {
    WindowSpan window;
    window.start_gps = parse_gps_iso(gps);
    return window;
}

TEST(WordsOfAnAttempt, AnAgreementIsSaidWithItsDayAndWhetherItCameTooLate) {
    EXPECT_EQ(agreement_text(std::nullopt, std::nullopt),
              "No agreement on the decision rule is stated.");
    const DecisionRuleAgreement agreed{.date = "2026-03-14", .by = "board and team"};
    const std::string said = "The decision rule was agreed on 2026-03-14 by “board and team”.";
    EXPECT_EQ(agreement_text(agreed, std::nullopt), said);
    // Already 14 March where the date changes first.
    EXPECT_EQ(agreement_text(agreed, window_at("2026-03-13T10:00:01.000")), said);
    EXPECT_EQ(agreement_text(agreed, window_at("2026-03-13T09:59:59.000")),
              said + " That is after the window, and ISO/IEC 17025 (7.1.3) asks for it before.");
}

TEST(WordsOfAnAttempt, ACalibrationIsSaidWithWhatItIsOf) {
    Calibration calibration{
        .certificate = "K-4711", .laboratory = "a laboratory", .date = "2026-02-03"};
    EXPECT_EQ(calibration_text(calibration),
              "certificate “K-4711” of 2026-02-03 by “a laboratory”");
    calibration.expanded_uncertainty = 0.05;
    calibration.unit = "km/h";
    calibration.quantity = "speed";
    EXPECT_EQ(calibration_text(calibration),
              "certificate “K-4711” of 2026-02-03 by “a laboratory”; expanded uncertainty of speed "
              "0.05 km/h (k = 2)");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
