#include "reports/explain/explain.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "core/failure.h"
#include "reports/explain/words.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double mph = 1609.344 / 3600.0;

Clause clause(const std::string& computation, std::optional<double> limit = {},
              const std::string& unit = {}) {
    Computation decided_by{};
    EXPECT_TRUE(from_text(computation, decided_by));
    return {.id = computation + "-clause",
            .text = "The " + computation + " is as it must be.",
            .source = "headings of a published report",
            .certainty = Certainty::secondary,
            .decided_by = decided_by,
            .limit = limit,
            .unit = unit};
}

/// Every computation that the profile's schema has, each with a limit where it takes one.
Profile profile() {
    Profile profile;
    profile.id = "rule";
    profile.body = "Body";
    profile.title = "top speed";
    profile.duration_s = 3.0;
    profile.definition = SpeedDefinition::displacement;
    profile.accuracy_limit_mps = 0.8 / 3.6;
    profile.accuracy_unit = "km/h";
    profile.margin_kind = MarginKind::absolute;
    profile.margin = 1.0 * mph;
    profile.margin_unit = "mph";
    profile.opposite_runs_within_s = 7200.0;
    profile.clauses = {clause("window_complete"),
                       clause("accuracy"),
                       clause("margin"),
                       clause("georeferenced"),
                       clause("secondary_method"),
                       clause("attest"),
                       clause("flatness", 1.0, "m"),
                       clause("slope", 2.0, "%"),
                       clause("straightness", 5.0, "m"),
                       clause("turning", 10.0, "deg"),
                       clause("standing_start"),
                       clause("run_up", 500.0, "m"),
                       clause("wind_mean", 12.5, "m/s"),
                       clause("wind_gust", 15.0, "m/s"),
                       clause("current", 1.0, "kn"),
                       clause("sampling_rate", 5.0, "Hz"),
                       clause("sample_accuracy", 3.0, "m/s"),
                       clause("opposite_runs"),
                       clause("fastest_certifiable")};
    return profile;
}

/// A speed of 60.002417 m/s against a record of 126.2 mph: 127.2 mph to reach.
Verdict verdict(Outcome outcome, RequirementStatus status = RequirementStatus::met) {
    ProfileVerdict entry;
    entry.profile = "rule";
    entry.body = "Body";
    entry.title = "top speed";
    entry.outcome = outcome;
    entry.reason = "A sentence that says why";
    entry.definition = SpeedDefinition::displacement;
    entry.speed_mps = 60.002417;
    entry.expanded_uncertainty_mps = 0.005102;
    entry.target_mps = 127.2 * mph;
    entry.window = WindowSpan{.first_epoch = 403,
                              .last_epoch = 433,
                              .start = {40'200'000'000},
                              .duration = {3'000'000'000},
                              .start_gps = std::nullopt};
    entry.record = RecordToBeat{.speed = 126.2,
                                .unit = "mph",
                                .source = "published figure of 2009",
                                .speed_mps = 126.2 * mph,
                                .expanded_uncertainty = 0.1};
    entry.decision = Decision{.probability = 0.97499,
                              .level = 0.975,
                              .target_standard_uncertainty_mps = 0.05 * mph,
                              .acceptance_limit_mps = 56.9};
    entry.shown = ShownFigures{
        .unit = "mph", .speed = "134.22", .expanded_uncertainty = "0.02", .target = "127.20"};
    for (const Clause& rule : profile().clauses)
        entry.requirements.push_back({.clause = rule.id,
                                      .status = status,
                                      .evidence = "the evidence",
                                      .text = rule.text,
                                      .source = rule.source,
                                      .certainty = rule.certainty,
                                      .decided_by = rule.decided_by,
                                      .figures = {{.name = "what was compared",
                                                   .value = 1.2345,
                                                   .unit = "m",
                                                   .expanded_uncertainty = 0.0781,
                                                   .note = "from both ends"}}});
    Verdict verdict;
    verdict.attempt = "run";
    verdict.profiles = {entry};
    return verdict;
}

/// On one line, however long.
std::string unwrapped(const std::string& text) {
    return std::regex_replace(text, std::regex("\n +"), " ");
}

std::string explained(const Verdict& of, const std::string& name) {
    return unwrapped(explain_text(of, {profile()}, {.clause = name, .profile = {}}));
}

void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in:\n" << text;
}

struct Explained {
    const char* computation;
    const char* how;
    const char* limit;    ///< empty where there is none
    const char* compare;  ///< of the sentence that compares
};

class EveryComputation : public testing::TestWithParam<Explained> {};

TEST_P(EveryComputation, IsSaidHowItIsMadeAndCompared) {
    const Explained& expected = GetParam();
    const std::string text =
        explained(verdict(Outcome::beaten), fmt::format("{}-clause", expected.computation));
    EXPECT_TRUE(text.starts_with(fmt::format("MET  rule/{}-clause ", expected.computation)))
        << text;
    expect_in(text,
              fmt::format("The rule          The {} is as it must be.", expected.computation));
    expect_in(text,
              "Its source        Headings of a published report. The rule itself could not be");
    expect_in(text, expected.how);
    expect_in(text, expected.compare);
    expect_in(text, "What was compared: 1.234 m +/- 0.079 m (k = 2); from both ends.");
    expect_in(text, "Outcome           Met. The evidence.");
    if (std::string(expected.limit).empty())
        EXPECT_EQ(text.find("  Limit  "), std::string::npos);
    else
        expect_in(text, fmt::format("Limit             {} ", expected.limit));
}

const char* const at_most = "met where it is at most the limit with all of its expanded";
const char* const at_least = "met where it is at least the limit with all of its expanded";

INSTANTIATE_TEST_SUITE_P(
    Computations, EveryComputation,
    testing::Values(
        Explained{"window_complete", "Every stretch of 3 s, beginning and ending at measured", "",
                  "Met where one is left"},
        Explained{"accuracy", "is 2 times the combined standard uncertainty", "0.8 km/h",
                  "Met where it is at most the limit."},
        Explained{"margin",
                  "The speed to reach is 1 mph above the record; the speed to reach is "
                  "not rounded.",
                  "", "Met where that is at least 97.5 %"},
        Explained{"georeferenced", "whose scale on the ground nobody states", "",
                  "Met where they are on the Earth"},
        Explained{"secondary_method", "which gives the normalised error", "",
                  "Met where it is at most 1;"},
        Explained{"attest", "A person. No figure in the recording could tell it", "",
                  "nothing was computed"},
        Explained{"flatness", "lowest smoothed height of the run", "1 m", at_most},
        Explained{"slope", "height gained or lost between the ends of the window", "2 %", at_most},
        Explained{"straightness", "from the straight line through its ends", "5 m", at_most},
        Explained{"turning", "direction of travel at the window's beginning", "10 deg", at_most},
        Explained{"standing_start", "below 0.2 m/s", "", "Met where it stood;"},
        Explained{"run_up", "length of the smoothed path from the beginning of the run", "500 m",
                  at_least},
        Explained{"wind_mean", "mean over the window of the wind", "12.5 m/s", at_most},
        Explained{"wind_gust", "largest speed of the wind", "15 m/s", at_most},
        Explained{"current", "largest speed of the current that the attempt gives", "1 kn",
                  at_most},
        Explained{"sampling_rate", "longest time between neighbouring epochs", "5 Hz", at_least},
        Explained{"sample_accuracy",
                  "accuracy of a speed from two positions as accurate as this one", "3 m/s",
                  at_most},
        Explained{"opposite_runs", "fastest windows of two runs in opposite directions", "",
                  "Met where both lie within 7200 s."},
        Explained{"fastest_certifiable", "fastest window as recorded is looked for", "",
                  "Met where it is the certified one"}),
    [](const auto& each) { return std::string(each.param.computation); });

TEST_P(EveryComputation, SaysWhatToDoWhereAPersonMustAttest) {
    const std::string name = fmt::format("{}-clause", GetParam().computation);
    const std::string text = explained(verdict(Outcome::beaten, RequirementStatus::attest), name);
    EXPECT_TRUE(text.starts_with("TO ATTEST  rule/" + name)) << text;
    expect_in(text, "Outcome           Left to a person. The evidence.");
    expect_in(text, "To do  ");
    EXPECT_EQ(explained(verdict(Outcome::beaten), name).find("To do  "), std::string::npos);
}

TEST(Explain, AClauseThatIsNotMetSaysSoFirst) {
    const std::string text = explained(
        verdict(Outcome::not_certifiable, RequirementStatus::not_met), "rule/slope-clause");
    EXPECT_TRUE(text.starts_with("NOT MET  rule/slope-clause ")) << text;
    expect_in(text, "Outcome           Not met. The evidence.");
}

TEST(Explain, HowSureAClauseIsStandsWithItsSource) {
    Verdict of = verdict(Outcome::beaten);
    of.profiles[0].requirements[0].certainty = Certainty::quoted;
    expect_in(explained(of, "window_complete-clause"), "These are the rule's own words");
    of.profiles[0].requirements[0].certainty = Certainty::unconfirmed;
    expect_in(explained(of, "window_complete-clause"), "ask the body.");
    expect_in(unwrapped(explain_text(of, {profile()})),
              "is as it must be. (Not confirmed that the rule says so.)");
}

TEST(Explain, AReplacedFigureStandsWithWhatHangsOnIt) {
    Verdict of = verdict(Outcome::beaten);
    of.profiles[0].overrides = {
        {.figure = "clauses.flatness-clause.limit",
         .rule = 1.0,
         .used = 1.5,
         .unit = "m",
         .reason = "agreed with the measurer"},
        {.figure = "margin.value", .rule = 1.0, .used = 2.0, .unit = "mph", .reason = {}}};
    const std::string limit =
        "clauses.flatness-clause.limit is 1.5 m in place of the rule's 1 m. Reason: agreed with "
        "the measurer.";
    const std::string margin =
        "margin.value is 2 mph in place of the rule's 1 mph. The attempt gives no reason.";
    expect_in(explained(of, "flatness-clause"), limit);
    EXPECT_EQ(explained(of, "flatness-clause").find(margin), std::string::npos);
    expect_in(explained(of, "margin-clause"), margin);
    EXPECT_EQ(explained(of, "slope-clause").find("Replaced"), std::string::npos);
    expect_in(explained(of, "outcome"), limit);
    expect_in(explained(of, "outcome"), margin);
    of.profiles[0].notes = {"The attempt replaces margin.value.", "The wind is not known."};
    EXPECT_EQ(explained(of, "outcome").find("The attempt replaces"), std::string::npos);
    expect_in(explained(of, "outcome"), "Note              The wind is not known.");
}

TEST(Explain, TheDecisionIsTakenApart) {
    const std::string text = explained(verdict(Outcome::not_proven), "decision");
    EXPECT_TRUE(text.starts_with("NOT PROVEN  rule: top speed, Body ")) << text;
    expect_in(text, "3.000 s from 40.200 s after the first epoch.");
    expect_in(text,
              "126.2 mph, by: Published figure of 2009. Its own expanded uncertainty is 0.1 "
              "mph (k = 2).");
    expect_in(text, "The rule asks for 1 mph above the record; the speed to reach is not rounded.");
    // 1 mph is 1.609344 km/h.
    expect_in(text, "Speed to reach    127.200 mph (204.709 km/h).");
    expect_in(text, "134.222 mph (216.009 km/h). To be read as 134.22 mph, rounded down.");
    expect_in(text, "0.012 mph (0.019 km/h) expanded (k = 2)");
    expect_in(text, "standard uncertainty of 0.050 mph (0.081 km/h), from the record's own");
    expect_in(text, "Probability       97.49 % that the true speed");
    expect_in(text, "97.5 % or more counts as beaten, 2.5 % or less as not beaten");
    expect_in(text, "the least speed that would count as beaten");
    expect_in(text, "Not proven, because the probability of 97.49 % is below the 97.5 % asked");
    EXPECT_EQ(text, explained(verdict(Outcome::not_proven), "outcome"));
    EXPECT_EQ(text, explained(verdict(Outcome::not_proven), "rule/outcome"));
}

TEST(Explain, AMeanOfSeveralWindowsIsSaidToBeOne) {
    Profile rule = profile();
    const auto text = [&] {
        return unwrapped(
            explain_text(verdict(Outcome::beaten), {rule}, {.clause = "decision", .profile = {}}));
    };
    expect_in(text(), "the mean of two runs over 3 s. The faster: 3.000 s from 40.200 s");
    rule.opposite_runs_within_s.reset();
    expect_in(text(), "The rule asks for 3 s. The window: 3.000 s from 40.200 s");
    rule.windows = 5;
    expect_in(text(), "the mean of 5 windows of 3 s. The fastest: 3.000 s from 40.200 s");
}

TEST(Explain, EveryOutcomeHasItsSentence) {
    Verdict of = verdict(Outcome::beaten);
    of.profiles[0].decision->probability = 0.975;
    expect_in(explained(of, "outcome"),
              "Beaten, because the probability is 97.50 %, at least the "
              "97.5 % asked.");
    of = verdict(Outcome::not_beaten);
    of.profiles[0].decision->probability = 1e-9;
    expect_in(explained(of, "outcome"),
              "Not beaten, because the probability is less than 0.0001 %, at most 2.5 %");
    of = verdict(Outcome::not_certifiable);
    of.profiles[0].speed_mps = of.profiles[0].expanded_uncertainty_mps = std::nullopt;
    of.profiles[0].window.reset();
    of.profiles[0].decision.reset();
    of.profiles[0].shown.reset();
    expect_in(explained(of, "outcome"), "None of 3 s could be certified.");
    expect_in(explained(of, "outcome"), "no comparison with a record counts: A sentence that says");
    of = verdict(Outcome::not_proven);
    of.profiles[0].decision.reset();
    of.profiles[0].record.reset();
    of.profiles[0].target_mps.reset();
    expect_in(explained(of, "outcome"), "Record            The attempt names none.");
    expect_in(explained(of, "outcome"), "Why               A sentence that says why.");
}

// The speed may be far above the one to reach: that says nothing.
TEST(Explain, InShortNoProbabilityIsGivenOfASpeedThatCannotBeCertified) {
    expect_in(explain_text(verdict(Outcome::beaten), {profile()}), "Probability ");
    EXPECT_EQ(explain_text(verdict(Outcome::not_certifiable), {profile()}).find("Probability "),
              std::string::npos);
}

TEST(Explain, MarginsAndRoundingOfEveryKind) {
    Profile rule = profile();
    const auto text = [&] {
        return unwrapped(
            explain_text(verdict(Outcome::beaten), {rule}, {.clause = "decision", .profile = {}}));
    };
    rule.margin_kind = MarginKind::relative;
    rule.margin = 0.002;
    rule.margin_above_upper_limit = true;
    rule.rounding = DecimalRule{.mode = "truncate", .unit = "km/h", .decimals = 2};
    expect_in(text(),
              "0.2 % above the record's upper limit, its value plus its own expanded "
              "uncertainty; the speed to reach is cut off to 2 decimals of km/h");
    rule.margin_kind = MarginKind::elapsed_time;
    rule.margin = 0.01;
    expect_in(text(), "shorter than that of the record's upper limit");
    expect_in(text(), "by 0.01 s");
}

TEST(Explain, WithoutAClauseEveryOneHasABlockOutcomeFirst) {
    const std::string text =
        explain_text(verdict(Outcome::beaten, RequirementStatus::attest), {profile()});
    EXPECT_TRUE(text.starts_with("BEATEN  rule: top speed, Body\n")) << text;
    expect_in(text, "134.22 mph +/- 0.02 mph (k = 2); to reach 127.20 mph");
    expect_in(text, "19 clauses: 0 met, 0 not met, 19 for a person to attest");
    std::size_t last = 0;
    for (const Clause& rule : profile().clauses) {
        const std::size_t at = text.find(fmt::format("\n  TO ATTEST  {}\n", rule.id));
        ASSERT_NE(at, std::string::npos) << rule.id;
        EXPECT_GT(at, last);
        last = at;
    }
    expect_in(unwrapped(text), "runcert explain RUN_DIR rule/window_complete-clause");
}

TEST(Explain, NoLineIsLongerThanAPage) {
    Verdict of = verdict(Outcome::not_proven, RequirementStatus::attest);
    of.profiles[0].requirements[6].evidence = std::string(250, 'x') + " \xC3\xA9 \x1b[31m red";
    of.profiles[0].notes = {std::string(300, 'n')};
    for (const char* name : {"", "decision", "flatness-clause", "current-clause"}) {
        const std::string text = explain_text(of, {profile()}, {.clause = name, .profile = {}});
        EXPECT_EQ(text.find('\x1b'), std::string::npos);
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_LE(line.size(), 101U) << line;  // one letter has two bytes
            EXPECT_FALSE(line.ends_with(' ')) << line;
        }
    }
}

TEST(Explain, AClauseOfTwoProfilesIsExplainedForBoth) {
    Verdict of = verdict(Outcome::beaten);
    of.profiles.push_back(of.profiles[0]);
    of.profiles[1].profile = "other";
    std::vector<Profile> rules{profile(), profile()};
    rules[1].id = "other";
    const auto text = [&](const std::string& name, const std::string& only) {
        return explain_text(of, rules, {.clause = name, .profile = only});
    };
    expect_in(text("slope-clause", ""), "MET  rule/slope-clause\n");
    expect_in(text("slope-clause", ""), "MET  other/slope-clause\n");
    EXPECT_EQ(text("other/slope-clause", "").find("rule/slope-clause"), std::string::npos);
    EXPECT_EQ(text("slope-clause", "other"), text("other/slope-clause", ""));
    EXPECT_EQ(text("", "other").find("rule: top speed"), std::string::npos);
}

TEST(Explain, WhatIsNotThereIsRefusedWithWhatIs) {
    const auto refusal = [](const ExplainOptions& options) {
        try {
            (void)explain_text(verdict(Outcome::beaten), {profile()}, options);
        } catch (const Failure& failure) {
            return failure.problem() + " " + failure.remedy();
        }
        return std::string("nothing was refused");
    };
    const std::string text = refusal({.clause = "flatnes-clause", .profile = {}});
    expect_in(text, "no clause \"flatnes-clause\"");
    expect_in(text, "Did you mean flatness-clause?");
    expect_in(text, "outcome, decision, rule/window_complete-clause");
    expect_in(refusal({.clause = {}, .profile = "fisly"}), "Use one of: rule");
    EXPECT_THROW((void)explain_text(verdict(Outcome::beaten), {}), Failure);
}

TEST(ExplainWords, AProbabilityNeverShowsAsOneThatItDoesNotReach) {
    EXPECT_EQ(probability_text(0.975), "97.50 %");
    EXPECT_EQ(probability_text(0.9749999), "97.49 %");
    EXPECT_EQ(probability_text(0.025), "2.50 %");
    EXPECT_EQ(probability_text(0.0250001), "2.51 %");
    EXPECT_EQ(probability_text(0.99995), "99.9950 %");
    EXPECT_EQ(probability_text(1.0), "more than 99.9999 %");
    EXPECT_EQ(probability_text(0.0), "less than 0.0001 %");
    EXPECT_EQ(level_text(1.0 - 0.975), "2.5 %");
}

TEST(ExplainWords, AFigureHasTheDecimalsOfItsUncertainty) {
    EXPECT_EQ(
        figure_words({.name = "a", .value = 12.3456, .unit = "deg", .expanded_uncertainty = 0.301}),
        "a: 12.35 deg +/- 0.31 deg (k = 2)");
    EXPECT_EQ(figure_words({.name = "a", .value = 31.0, .unit = {}}), "a: 31");
    EXPECT_EQ(figure_words({.name = "a", .value = 12345.67, .unit = "m"}), "a: 12345.7 m");
    EXPECT_EQ(figure_words({.name = "a",
                            .value = 0.123456,
                            .unit = "%",
                            .expanded_uncertainty = 0.0,
                            .note = "why"}),
              "a: 0.123456 %; why");
}

TEST(Explain, TheProfilesThatComeWithTheProgramHaveTitleAndBody) {
    std::vector<Profile> rules;
    for (const std::string& name : builtin_profiles())
        rules.push_back(read_profile(builtin_profile(name), name));
    const std::string text = profiles_text(rules);
    for (const Profile& rule : rules) {
        expect_in(text, rule.id + "\n");
        expect_in(unwrapped(text), sentence(rule.title) + " " + sentence(rule.body));
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
