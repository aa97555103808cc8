#include "reports/explain/explain.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "approved.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/document/document_text.h"
#include "schemas/verdict/outcome.h"

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
    profile.accuracy_limit_m_s = 0.8 / 3.6;
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
                       clause("calibration"),
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
                       clause("acceleration", 5.0, "m/s2"),
                       clause("satellites", 5.0, "satellites"),
                       clause("least_speed", 5.0, "kn"),
                       clause("device_deduction"),
                       clause("speed_of"),
                       clause("sail_area"),
                       clause("counted_part"),
                       clause("start_height", 4277.0, "m"),
                       clause("validation_accuracy", 3.0, "m/s"),
                       clause("opposite_runs"),
                       clause("fastest_certifiable"),
                       clause("time_scale"),
                       clause("recording_date"),
                       clause("recorded_speeds"),
                       clause("measured_positions"),
                       clause("stated_solution")};
    return profile;
}

/// A speed of 60.002417 m/s against a record of 126.2 mph: 127.2 mph to reach.
Verdict verdict(Outcome outcome, RequirementStatus status = RequirementStatus::met) {
    ProfileVerdict entry;
    entry.profile = "rule";
    entry.rule.origin = RuleOrigin::built_in;
    entry.body = "Body";
    entry.title = "top speed";
    entry.outcome = outcome;
    entry.reason = "A sentence that says why";
    entry.definition = SpeedDefinition::displacement;
    entry.speed_m_s = 60.002417;
    entry.expanded_uncertainty_m_s = 0.005102;
    entry.required_speed_m_s = 127.2 * mph;
    entry.window = WindowSpan{.first_epoch = 403,
                              .last_epoch = 433,
                              .start = {40'200'000'000},
                              .duration = {3'000'000'000},
                              .start_gps = std::nullopt};
    entry.record = RecordToBeat{.speed = 126.2,
                                .unit = "mph",
                                .source = "published figure of 2009",
                                .speed_m_s = 126.2 * mph,
                                .expanded_uncertainty = 0.1};
    entry.decision = Decision{.probability = 0.97499,
                              .level = 0.975,
                              .required_speed_standard_uncertainty_m_s = 0.05 * mph,
                              .acceptance_limit_m_s = 56.9,
                              .risk = 0.02501};
    entry.shown = ShownFigures{.unit = "mph",
                               .speed = "134.22",
                               .expanded_uncertainty = "0.02",
                               .required_speed = "127.20"};
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
    entry.standing = standing_of(entry.requirements, 0);
    Verdict verdict;
    verdict.attempt = "run";
    verdict.profiles = {entry};
    return verdict;
}

std::string explain_text(const Verdict& of, const std::vector<Profile>& profiles,
                         const ExplainOptions& options = {}, std::size_t columns = 80) {
    return document_text(explained(Attempt{}, of, profiles, options), columns);
}

std::string one_explained(const Verdict& of, const std::string& name) {
    return explain_text(of, {profile()}, {.clause = name, .profile = {}});
}

void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in:\n" << text;
}

TEST(Explain, EveryClauseIsExplained) {
    test::ApprovedTexts texts("explain_clauses.txt");
    for (const Clause& clause : profile().clauses) {
        texts.add(clause.id + ", met", one_explained(verdict(Outcome::beaten), clause.id));
        texts.add(clause.id + ", to attest",
                  one_explained(verdict(Outcome::beaten, RequirementStatus::attest), clause.id));
    }
    texts.add("not met",
              one_explained(verdict(Outcome::not_certifiable, RequirementStatus::not_met),
                            "rule/slope-clause"));
    Verdict of = verdict(Outcome::beaten);
    for (const Certainty certainty : {Certainty::quoted, Certainty::unconfirmed}) {
        of.profiles[0].requirements[0].certainty = certainty;
        texts.add(fmt::format("certainty {}", to_text(certainty)),
                  one_explained(of, "window_complete-clause"));
    }
    texts.add("in short, not confirmed", explain_text(of, {profile()}));
}

TEST(Explain, EveryClauseHasItsComputation) {
    std::set<Computation> explained_here;
    for (const Clause& clause : profile().clauses)
        explained_here.insert(clause.decided_by);
    explained_here.insert(Computation::claims);  // no rule's: its own words are those of `attest`
#define RUNCERT_EXPLAINED(word) EXPECT_TRUE(explained_here.contains(Computation::word)) << #word;
    RUNCERT_EACH_COMPUTATION(RUNCERT_EXPLAINED)
#undef RUNCERT_EXPLAINED
}

TEST(Explain, AReplacedFigureStandsWithWhatHangsOnItAlone) {
    test::ApprovedTexts texts("explain_replaced.txt");
    Verdict of = verdict(Outcome::beaten);
    of.profiles[0].overrides = {
        {.figure = "clauses.flatness-clause.limit",
         .rule = 1.0,
         .used = 1.5,
         .unit = "m",
         .reason = "agreed with the measurer"},
        {.figure = "margin.value", .rule = 1.0, .used = 2.0, .unit = "mph", .reason = {}}};
    of.profiles[0].notes = {"The attempt replaces margin.value.", "The wind is not known."};
    for (const char* clause : {"flatness-clause", "margin-clause", "slope-clause", "outcome"})
        texts.add(clause, one_explained(of, clause));
}

TEST(Explain, EveryOutcomeIsTakenApart) {
    test::ApprovedTexts texts("explain_outcomes.txt");
    Verdict of = verdict(Outcome::not_proven);
    texts.add("not proven", one_explained(of, "decision"));
    EXPECT_EQ(one_explained(of, "decision"), one_explained(of, "outcome"));
    EXPECT_EQ(one_explained(of, "decision"), one_explained(of, "rule/outcome"));
    of = verdict(Outcome::beaten);
    of.profiles[0].decision->probability = 0.975;
    texts.add("beaten", one_explained(of, "outcome"));
    of = verdict(Outcome::not_beaten);
    of.profiles[0].decision->probability = 1e-9;
    texts.add("not beaten", one_explained(of, "outcome"));
    of = verdict(Outcome::not_certifiable);
    // The speed may be far above the one to reach: that says nothing, and no probability is given.
    texts.add("not certifiable, in short", explain_text(of, {profile()}));
    of.profiles[0].speed_m_s = of.profiles[0].expanded_uncertainty_m_s = std::nullopt;
    of.profiles[0].window.reset();
    of.profiles[0].decision.reset();
    of.profiles[0].shown.reset();
    texts.add("not certifiable, without a window", one_explained(of, "outcome"));
    of = verdict(Outcome::not_proven);
    of.profiles[0].decision.reset();
    of.profiles[0].record.reset();
    of.profiles[0].required_speed_m_s.reset();
    texts.add("without a record", one_explained(of, "outcome"));
}

TEST(Explain, AMeanOfSeveralWindowsIsSaidToBeOne) {
    test::ApprovedTexts texts("explain_means.txt");
    Profile rule = profile();
    const auto text = [&] {
        return explain_text(verdict(Outcome::beaten), {rule},
                            {.clause = "decision", .profile = {}});
    };
    texts.add("two runs", text());
    rule.opposite_runs_within_s.reset();
    texts.add("one window", text());
    rule.windows = 5;
    texts.add("five windows", text());
}

TEST(Explain, MarginsAndRoundingOfEveryKind) {
    test::ApprovedTexts texts("explain_margins.txt");
    Profile rule = profile();
    const auto text = [&] {
        return explain_text(verdict(Outcome::beaten), {rule},
                            {.clause = "decision", .profile = {}});
    };
    rule.margin_kind = MarginKind::relative;
    rule.margin = 0.002;
    rule.margin_above = MarginBase::upper_limit;
    rule.rounding = DecimalRule{.mode = DecimalMode::truncate, .unit = "km/h", .decimals = 2};
    texts.add("relative, above the upper limit, truncated", text());
    rule.margin_kind = MarginKind::elapsed_time;
    rule.margin = 0.01;
    texts.add("elapsed time", text());
}

TEST(Explain, WithoutAClauseEveryOneHasABlockOutcomeFirst) {
    test::expect_approved(
        "explain_in_short.txt",
        explain_text(verdict(Outcome::beaten, RequirementStatus::attest), {profile()}));
}

TEST(Explain, NoLineIsLongerThanAPage) {
    Verdict of = verdict(Outcome::not_proven, RequirementStatus::attest);
    of.profiles[0].requirements[6].evidence = std::string(250, 'x') + " \xC3\xA9 \x1b[31m red";
    of.profiles[0].notes = {std::string(300, 'n')};
    for (const std::size_t columns : {40U, 80U})
        for (const char* name : {"", "decision", "flatness-clause", "current-clause"}) {
            const std::string text =
                explain_text(of, {profile()}, {.clause = name, .profile = {}}, columns);
            EXPECT_EQ(text.find('\x1b'), std::string::npos);
            EXPECT_FALSE(std::regex_search(text, std::regex(R"(\.\.(?!\.)(\s|$))"))) << text;
            std::istringstream lines(text);
            for (std::string line; std::getline(lines, line);) {
                EXPECT_LE(characters_in(line), columns) << line;
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
    expect_in(text("slope-clause", ""), "\nrule/slope-clause: MET\n");
    expect_in(text("slope-clause", ""), "\nother/slope-clause: MET\n");
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

TEST(Explain, TheProfilesThatComeWithTheProgramHaveTitleAndBody) {
    std::vector<Profile> rules;
    for (const std::string& name : builtin_profiles())
        rules.push_back(read_profile(builtin_profile(name), name));
    const Document document = profiles_document(rules);
    const std::vector<TableRow>& rows = document.sections.at(0).blocks.at(0).rows;
    ASSERT_EQ(rows.size(), rules.size());
    for (std::size_t i = 0; i < rules.size(); ++i) {
        EXPECT_EQ(rows[i].cells, (std::vector<std::string>{rules[i].id, sentence(rules[i].title)}));
        EXPECT_EQ(rows[i].further.at(0), sentence(rules[i].body));
        expect_in(document_text(document, 80), "\n" + rules[i].id + " ");
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
