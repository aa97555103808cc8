#include <gtest/gtest.h>

#include "check_rules_support.h"
#include "witness/roster.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace test;

WitnessedSpeed heard(WitnessKind kind, double normalised_error = 0.2) {
    WitnessedSpeed witness;
    witness.kind = kind;
    witness.speed_m_s = 60.01;
    witness.standard_uncertainty_m_s = 0.005;
    witness.difference_m_s = -0.01;
    witness.normalised_error = normalised_error;
    witness.apart_m = 0.153;
    witness.apart_azimuth_deg = 160.0;
    witness.share = normalised_error <= 1.0 ? 0.9 : 0.0;
    return witness;
}

const Requirement& clause_of(const ProfileVerdict& verdict, const std::string& id) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == id) return requirement;
    throw std::runtime_error("no clause " + id);
}

std::string second_method(const std::string& accepts = {}) {
    return clause_text("margin") +
           "  - {id: second, text: t, source: s, certainty: quoted, decided_by: secondary_method" +
           accepts + "}\n";
}

TEST(AssessedWitness, OfPhasesIsSaidAsASecondComputation) {
    RuleScene scene(profile_text(clause_text("margin")));
    scene.best().witnesses = {heard(WitnessKind::phases)};
    const ProfileVerdict verdict = scene.verdict();
    ASSERT_EQ(verdict.witnesses.size(), 1U);
    EXPECT_EQ(
        verdict.witnesses[0],
        "a second computation, from the raw signals handed in, gives 216.036 km/h ± 0.036 "
        "km/h; the two agree (normalised error 0.20, at most 1); that the receiver wrote them "
        "is to be attested");
    // Whose processing the raw file came through nobody here knows.
    EXPECT_EQ(verdict.witnesses[0].find("independent"), std::string::npos);
    EXPECT_FALSE(verdict.unseen_drift_m_s);
    EXPECT_EQ(verdict.reason.find("By positions alone"), std::string::npos);
}

/// Whether a note of the verdict has these words.
bool notes_say(const ProfileVerdict& verdict, std::string_view words) {
    return std::ranges::any_of(verdict.notes, [&](const std::string& note) {
        return note.find(words) != std::string::npos;
    });
}

// Whichever kind it is: it is named with what to check, and those that agree are named where they
// would have shown as much.
TEST(AssessedWitness, ThatStandsAloneIsNamedWithTheOthers) {
    for (const WitnessKind kind : {WitnessKind::wheel, WitnessKind::gates, WitnessKind::speed_trap,
                                   WitnessKind::imu, WitnessKind::phases, WitnessKind::receiver}) {
        const WitnessKind other =
            kind == WitnessKind::phases ? WitnessKind::wheel : WitnessKind::phases;
        WitnessedSpeed wrong = heard(kind, 1.7);
        wrong.difference_m_s = -1.0;
        wrong.receiver = kind == WitnessKind::receiver ? "second" : "";
        const std::string name = kind == WitnessKind::receiver
                                     ? "The positions of receiver \"second\""
                                     : "The " + std::string(words_of(kind));
        RuleScene scene(profile_text(clause_text("margin")));
        FurtherWindow fastest;
        fastest.speed_m_s = 61.0;
        fastest.standard_uncertainty_m_s = 0.05;
        fastest.witnesses = {heard(other), wrong};
        scene.judged.windows.profiles[0].fastest = fastest;
        const ProfileVerdict verdict = scene.verdict();
        EXPECT_TRUE(notes_say(verdict, "The fastest window is not certified: 219.6"))
            << words_of(kind);
        EXPECT_TRUE(notes_say(verdict, name +
                                           " contradict the positions there and stand alone. "
                                           "The " +
                                           std::string(words_of(other)) +
                                           " agree with the positions"))
            << words_of(kind);
        EXPECT_FALSE(witness_entry(kind).remedy.empty());
        EXPECT_TRUE(notes_say(verdict, witness_entry(kind).remedy));
        EXPECT_FALSE(notes_say(verdict, "proves less"));
        // One that is too uncertain to have seen it speaks for nobody.
        scene.judged.windows.profiles[0].fastest->witnesses[0].standard_uncertainty_m_s = 1.0;
        EXPECT_TRUE(notes_say(scene.verdict(),
                              name +
                                  " contradict the positions there, and nothing else says which of "
                                  "them errs."));
    }
}

TEST(AssessedWitness, WindowsThatNoneContradictsAreNotedAsBefore) {
    RuleScene scene(profile_text(clause_text("margin")));
    FurtherWindow fastest;
    fastest.speed_m_s = 61.0;
    fastest.standard_uncertainty_m_s = 0.05;
    fastest.witnesses = {heard(WitnessKind::phases)};
    scene.judged.windows.profiles[0].fastest = fastest;
    EXPECT_TRUE(notes_say(scene.verdict(), "Another window is faster and proves less"));
    EXPECT_FALSE(notes_say(scene.verdict(), "contradict"));
    scene.best().witnesses = {heard(WitnessKind::phases), heard(WitnessKind::wheel, 1.7)};
    EXPECT_TRUE(notes_say(scene.verdict(), "The speeds of a wheel contradict the positions"));
}

TEST(AssessedWitness, ThatContradictsForbidsACertificateAndSaysByHowMuch) {
    for (const WitnessKind kind :
         {WitnessKind::phases, WitnessKind::velocities, WitnessKind::wheel, WitnessKind::gates}) {
        RuleScene scene(profile_text(clause_text("margin")));
        scene.best().witnesses = {heard(WitnessKind::velocities), heard(kind, 1.7)};
        const ProfileVerdict verdict = scene.verdict();
        EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
        EXPECT_TRUE(contains(verdict.reason, "The " + std::string(words_of(kind)) + " give"))
            << verdict.reason;
        EXPECT_TRUE(contains(verdict.reason,
                             "displacements differ by 0.153 m, towards 160 degrees from north"))
            << verdict.reason;
        EXPECT_EQ(verdict.witnesses.size(), 1U);
    }
}

// Each for itself may agree with the positions, and both together not.
TEST(AssessedWitness, WitnessesThatContradictOneAnotherForbidACertificate) {
    RuleScene scene(profile_text(clause_text("margin")));
    scene.best().witnesses = {heard(WitnessKind::velocities, 0.9), heard(WitnessKind::wheel, 0.9)};
    scene.best().witnesses[1].difference_m_s = 0.01;
    scene.best().evidence.emplace().disagreement = 0.99;
    EXPECT_NE(scene.verdict().outcome, Outcome::not_certifiable);
    scene.best().evidence->disagreement = 1.25;
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(verdict.reason, "The witnesses contradict one another")) << verdict.reason;
    EXPECT_TRUE(contains(verdict.reason, "+0.036 km/h")) << verdict.reason;
    EXPECT_TRUE(contains(verdict.reason, "-0.036 km/h")) << verdict.reason;
}

TEST(PositionsAlone, SayWhatDriftCouldNotHaveBeenSeen) {
    RuleScene scene(profile_text(clause_text("margin")));
    EXPECT_FALSE(scene.verdict().unseen_drift_m_s);  // nothing was computed
    UndetectedError ramp;
    ramp.hypothesis = Hypothesis::ramp;
    ramp.size = 0.4567;
    ramp.unit = "m / s";
    ramp.speed_m_s = 0.9;
    UndetectedError step = ramp;
    step.hypothesis = Hypothesis::step;
    step.size = 0.1;
    scene.best().reliability = {step, ramp};
    scene.best().detection_power = 0.8;
    EXPECT_EQ(scene.verdict().unseen_drift_m_s.value(), 0.4567);
    scene.best().witnesses = {heard(WitnessKind::velocities)};
    EXPECT_FALSE(scene.verdict().unseen_drift_m_s);
}

// A witness of the same receiver is a second method only where the rule says so.
TEST(SecondMethod, OfTheSameReceiverIsMetWhereTheRuleAcceptsIt) {
    RuleScene scene(profile_text(second_method()));
    EXPECT_EQ(clause_of(scene.verdict(), "second").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause_of(scene.verdict(), "second").evidence, "one receiver"));
    scene.best().witnesses = {heard(WitnessKind::phases)};
    const ProfileVerdict shown = scene.verdict();
    EXPECT_EQ(clause_of(shown, "second").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(clause_of(shown, "second").evidence, "gives 216.036 km/h"));
    EXPECT_TRUE(contains(clause_of(shown, "second").evidence, "the rule does not say"));
    ASSERT_EQ(clause_of(shown, "second").figures.size(), 1U);
    EXPECT_EQ(clause_of(shown, "second").figures[0].value, 0.2);

    RuleScene accepting(profile_text(second_method(", accepts: [phases]")));
    EXPECT_EQ(clause_of(accepting.verdict(), "second").status, RequirementStatus::attest);
    accepting.best().witnesses = {heard(WitnessKind::velocities)};
    EXPECT_EQ(clause_of(accepting.verdict(), "second").status, RequirementStatus::attest);
    accepting.best().witnesses = {heard(WitnessKind::phases)};
    EXPECT_EQ(clause_of(accepting.verdict(), "second").status, RequirementStatus::met);
    accepting.best().witnesses = {heard(WitnessKind::phases, 1.2)};
    EXPECT_EQ(clause_of(accepting.verdict(), "second").status, RequirementStatus::attest);
}

TEST(SecondMethod, AcceptsNothingElsewhere) {
    const auto refusal = [](const std::string& clauses) -> std::string {
        try {
            read_profile(profile_text(clauses), "p");
        } catch (const Failure& failure) {
            return failure.what();
        }
        return "read";
    };
    EXPECT_TRUE(contains(
        refusal("  - {id: a, text: t, source: s, certainty: quoted, decided_by: attest, accepts: "
                "[phases]}\n"),
        "only secondary_method accepts witnesses"));
    EXPECT_TRUE(contains(refusal(second_method(", accepts: [gates]")), "gates"));
}

TEST(WitnessNotes, StandAmongTheStatements) {
    RuleScene scene(profile_text(clause_text("margin")));
    scene.judged.windows.witness_notes = {"The timing gates say nothing of the window."};
    const Verdict verdict =
        check({.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged});
    EXPECT_NE(std::ranges::find(verdict.statements, "The timing gates say nothing of the window."),
              verdict.statements.end());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
