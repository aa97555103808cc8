#include <gtest/gtest.h>

#include <algorithm>

#include "reports/words/answer.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::size_t columns = 80;

/// A rule by which 58.70 km/h were measured, where 55.67 are required, and nine answers are due.
ProfileVerdict exceeding(const std::string& name = "fisly") {
    ProfileVerdict verdict;
    verdict.profile = name;
    verdict.outcome = Outcome::beaten;
    verdict.rule.origin = RuleOrigin::built_in;
    verdict.reason = "By positions alone, the measured speed exceeds the required speed.";
    verdict.speed_m_s = 58.7 / 3.6;
    verdict.expanded_uncertainty_m_s = 0.19 / 3.6;
    verdict.required_speed_m_s = 55.67 / 3.6;
    verdict.record = RecordToBeat{.speed = 55.0, .unit = "km/h", .source = "a list"};
    verdict.shown = ShownFigures{.unit = "km/h",
                                 .speed = "58.70",
                                 .expanded_uncertainty = "0.19",
                                 .required_speed = "55.67",
                                 .acceptance_limit = "55.86"};
    verdict.standing = {.attestations = 9};
    return verdict;
}

ProfileVerdict refused(const std::string& name, const std::string& reason) {
    ProfileVerdict verdict;
    verdict.profile = name;
    verdict.reason = reason;
    verdict.requirements = {Requirement{.clause = "accuracy"}};
    verdict.rule.origin = RuleOrigin::built_in;
    return verdict;
}

Verdict of(std::vector<ProfileVerdict> rules) {
    Verdict verdict;
    verdict.profiles = std::move(rules);
    return verdict;
}

std::string last_lines(const Verdict& verdict) {
    return answer_text(
        {answer_result(verdict), answer_next(verdict, "out/run", "out/run/report.pdf")}, columns);
}

TEST(Answer, OfARecordThatIsExceededSaysWhatIsDue) {
    EXPECT_EQ(last_lines(of({exceeding()})),
              "RESULT  fisly: 58.70 ± 0.19 km/h, required 55.67: exceeds the record. Not yet\n"
              "        beaten: 9 answers are due.\n"
              "NEXT    read out/run/report.pdf; what is due and from whom: runcert attest\n"
              "        out/run\n");
    ProfileVerdict one = exceeding();
    one.standing = {.attestations = 1};
    EXPECT_TRUE(result_text(one).ends_with("Not yet beaten: 1 answer is due."));
    one.rule.origin = RuleOrigin::own;
    EXPECT_TRUE(result_text(one).starts_with(
        "58.70 ± 0.19 km/h, required 55.67: exceeds the record under altered rules. Not yet"));
    one.standing = {.attestations = 1, .signatures = 2};
    EXPECT_TRUE(result_text(one).ends_with("Not yet beaten: 1 answer and 2 signatures are due."));
}

TEST(Answer, OfACraftSlowerThanItsAntennaIsTheCraft) {
    ProfileVerdict verdict = exceeding();
    Requirement whose;
    whose.decided_by = Computation::speed_of;
    whose.figures = {Figure{.name = "speed of the craft's reference point",
                            .value = 55.2,
                            .unit = "km/h",
                            .expanded_uncertainty = 0.04,
                            .relation = LimitRelation::at_least,
                            .limit = 55.67,
                            .shown = "55.20 km/h ± 0.04 km/h"}};
    verdict.requirements = {whose};
    EXPECT_EQ(result_text(verdict),
              "The craft was too slow: 55.20 km/h ± 0.04 km/h, required 55.67. Its antenna did "
              "58.70 ± 0.19. The rule does not say whose speed counts: the body must.");
    // Within the uncertainty it is not known to be.
    verdict.requirements.front().figures.front().value = 55.65;
    EXPECT_TRUE(result_text(verdict).starts_with("58.70 ± 0.19 km/h"));
}

TEST(Answer, OfWhatCannotBeCertifiedIsTheReasonAndItsClause) {
    const Verdict verdict =
        of({refused("nalsa",
                    "Not met: accuracy: expanded uncertainty 7.6 km/h (k = 2), limit 0.8 km/h; it "
                    "includes all. " +
                        std::string(300, 'x') + ". The end.")});
    EXPECT_EQ(last_lines(verdict),
              "RESULT  nalsa: Not certifiable. Expanded uncertainty 7.6 km/h (k = 2), limit 0.8\n"
              "        km/h; it includes all.\n"
              "NEXT    read out/run/report.pdf; why, and what helps: runcert explain out/run\n"
              "        nalsa/accuracy\n");
    EXPECT_TRUE(
        answer_next(of({refused("nalsa", "There is no window.")}), "a run", "a run/report.html")
            .says.ends_with("runcert explain 'a run' decision --profile nalsa"));
    // A clause of the attempt's own rule is one word of a shell, whatever its name.
    ProfileVerdict own = refused("own", "Not met: a'; touch owned: no: by far.");
    own.requirements = {Requirement{.clause = "a'; touch owned"}};
    EXPECT_TRUE(answer_next(of({own}), "run", "p")
                    .says.ends_with(R"(runcert explain run 'own/a'\''; touch owned')"));
    EXPECT_EQ(refusal_text(own), "no: by far.");
}

TEST(Answer, OfOtherOutcomesIsNoClaim) {
    ProfileVerdict verdict = exceeding();
    verdict.outcome = Outcome::not_beaten;
    EXPECT_EQ(result_text(verdict),
              "58.70 ± 0.19 km/h, required 55.67: below the required speed. Record not beaten.");
    verdict.outcome = Outcome::not_proven;
    EXPECT_TRUE(result_text(verdict).ends_with("the required speed is within the uncertainty."));
    verdict.record.reset();
    EXPECT_TRUE(result_text(verdict).ends_with("The attempt names no record."));
}

TEST(Answer, OfSeveralRulesIsATableWithCommonReasonsOnce) {
    std::vector<ProfileVerdict> rules{exceeding()};
    for (const char* name : {"a", "b", "c"})
        rules.push_back(refused(name, "No window is whole."));
    EXPECT_EQ(answer_text(answer_details(of(rules)), columns),
              "rule    fisly  58.70 ± 0.19 km/h, required 55.67  exceeds the record\n"
              "rule    a      no speed                           not certifiable\n"
              "rule    b      no speed                           not certifiable\n"
              "rule    c      no speed                           not certifiable\n"
              "why     a, b and c: No window is whole.\n");
    EXPECT_EQ(
        answer_result(of(rules)).says,
        "4 rules: exceeds the record (fisly); not certifiable (a, b and c). Not yet beaten: 9 "
        "answers are due.");
    rules.erase(rules.begin());
    EXPECT_EQ(answer_result(of(rules)).says, "all 3 rules: not certifiable. No window is whole.");
    EXPECT_EQ(answer_details(of(rules)).back().label, "rule") << "the result has the reason";
    rules.pop_back();
    EXPECT_EQ(answer_result(of(rules)).says, "both rules: not certifiable. No window is whole.");
    rules.back().reason = "It was not the day.";
    EXPECT_EQ(answer_result(of(rules)).says, "both rules: not certifiable.");
}

TEST(Answer, FitsInTheLinesThatThereAre) {
    std::vector<ProfileVerdict> rules;
    for (int i = 0; i < 40; ++i)
        rules.push_back(refused("rule-" + std::to_string(i), "Reason " + std::to_string(i) + "."));
    for (const std::size_t most : {3U, 9U, 24U}) {
        const std::string text = answer_text(answer_details(of(rules)), columns, most, "out/run");
        EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(text, '\n')), most);
        EXPECT_TRUE(text.ends_with("...     more: runcert explain out/run\n"));
    }
    const std::string all = answer_text(answer_details(of(rules)), columns, 80, "out/run");
    EXPECT_TRUE(all.ends_with("why     rule-39: Reason 39.\n"));
}

TEST(Answer, SaysFirstThatNoCraftWasMeasured) {
    ProfileVerdict verdict = exceeding();
    verdict.notes = {
        "The recording of receiver \"primary\" says that it was simulated: this is an "
        "example of a report, and no craft was measured.",
        "Question for the body: How is it rounded?", "The IMU confirms it."};
    verdict.unseen_drift_m_s = 0.5;
    std::vector<std::string> labels;
    for (const AnswerLine& line : answer_details(of({verdict})))
        labels.push_back(line.label);
    EXPECT_EQ(labels, (std::vector<std::string>{"speed", "note", "witness", "note"}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
