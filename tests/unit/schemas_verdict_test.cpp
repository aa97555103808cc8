#include <gtest/gtest.h>

#include <string>

#include "schemas/verdict/declared.h"
#include "store_test_support.h"

// Of how many attempts this is the best, what may remain of the bias of choosing the window, how
// much drift the decision survives, and what else was heard.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

Verdict verdict_of(const Decision& decision, const std::vector<std::string>& witnesses = {}) {
    Verdict verdict;
    verdict.header.stage = "check";
    verdict.header.program_version = "1.0.0";
    verdict.header.source_revision = "0";
    verdict.attempt = "a";
    verdict.receiver = "primary";
    ProfileVerdict profile;
    profile.profile = "nalsa";
    profile.rule.sha256 = std::string(64, 'a');
    profile.body = "b";
    profile.title = "t";
    profile.outcome = Outcome::beaten;
    profile.reason = "r";
    profile.definition = SpeedDefinition::displacement;
    profile.decision = decision;
    profile.witnesses = witnesses;
    profile.own_arithmetic.text = "It is not known.";
    verdict.profiles = {profile};
    return verdict;
}

Decision decision() {
    return {.probability = 0.9995,
            .level = 0.995,
            .required_speed_standard_uncertainty_m_s = 0.0125,
            .acceptance_limit_m_s = 56.5,
            .risk = 0.0005,
            .attempts_made = 5,
            .bias_limit_m_s = 0.0025,
            .drift_survived_m = 1.25,
            .drift_found_m_s = 0.375};
}

ProfileVerdict written_and_read(const Verdict& verdict) {
    return read_verdict(write_verdict(verdict), "f").profiles.at(0);
}

TEST(VerdictDecision, RoundTrips) {
    const Decision back = written_and_read(verdict_of(decision())).decision.value();
    EXPECT_EQ(back.probability, 0.9995);
    EXPECT_EQ(back.level, 0.995);
    EXPECT_EQ(back.required_speed_standard_uncertainty_m_s, 0.0125);
    EXPECT_EQ(back.acceptance_limit_m_s, 56.5);
    EXPECT_EQ(back.risk, 0.0005);
    EXPECT_EQ(back.attempts_made, 5);
    EXPECT_EQ(back.bias_limit_m_s, 0.0025);
    EXPECT_EQ(back.drift_survived_m, 1.25);
    EXPECT_EQ(back.drift_found_m_s, 0.375);
}

TEST(VerdictDecision, SaysNothingOfDriftWhereThereIsNothingToSay) {
    Decision without = decision();
    without.drift_survived_m = without.drift_found_m_s = std::nullopt;
    const std::string text = write_verdict(verdict_of(without));
    EXPECT_EQ(text.find("drift"), std::string::npos);
    const Decision back = read_verdict(text, "f").profiles.at(0).decision.value();
    EXPECT_FALSE(back.drift_survived_m || back.drift_found_m_s);
}

/// The level of the best of many is told from that of the best of one more.
TEST(VerdictDecision, IsRoundedToTheFieldTable) {
    Decision exact = decision();
    exact.level = 1.0 - 0.025 / 3.0;
    exact.bias_limit_m_s = exact.drift_survived_m.emplace(1.0 / 3.0);
    exact.drift_found_m_s = 2.0 / 3.0;
    const Decision back = written_and_read(verdict_of(exact)).decision.value();
    EXPECT_EQ(back.level, 0.991666667);
    EXPECT_EQ(back.bias_limit_m_s, 0.333333);
    EXPECT_EQ(back.drift_survived_m, 0.333333);
    EXPECT_EQ(back.drift_found_m_s, 0.666667);
}

TEST(VerdictDecision, ImpossibleFiguresAreRefused) {
    const std::string text = write_verdict(verdict_of(decision(), {"heard"}));
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"attempts_made: 5", "attempts_made: 0", "0 is below 1"},
        {"attempts_made: 5", "attempts_made: 2.5", "not a whole number"},
        {"bias_limit_m_s: 0.0025", "bias_limit_m_s: -0.5", "-0.5 is below 0 m / s"},
        {"drift_survived_m: 1.25", "drift_survived_m: -0.5", "-0.5 is below 0 m"},
        {"drift_found_m_s: 0.375", "drift_found_m_s: -0.5", "-0.5 is below 0 m / s"},
        {"drift_found_m_s: 0.375", "drift_found_m_s: none", "\"none\" is not a number"},
        {"    witnesses:\n      - heard\n", "    witnesses: heard\n", "not a list"},
        {"      - heard\n", "      - [heard]\n", "is a list, not text"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_verdict(replaced(text, c.from, c.to), "f"); });
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem;
    }
}

TEST(VerdictWitnesses, RoundTripAndAreListedWhereThereIsNone) {
    const std::vector<std::string> two{"velocities: \"agree\"", "second receiver"};
    EXPECT_EQ(written_and_read(verdict_of(decision(), two)).witnesses, two);
    const std::string none = write_verdict(verdict_of(decision()));
    EXPECT_NE(none.find("    witnesses: []\n"), std::string::npos);
    EXPECT_TRUE(read_verdict(none, "f").profiles.at(0).witnesses.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
