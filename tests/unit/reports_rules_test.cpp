#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/certificate/json_parts.h"
#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

Json profile_of(const sample::Run& run, std::size_t index = 0) {
    return report_json(run.inputs)["predicate"]["profiles"][index];
}

std::string page_of(const sample::Run& run) {
    return print_page(report_json(run.inputs));
}

ProfileWindows& windows_of(sample::Run& run) {
    return run.inputs.receivers[0].windows.profiles[0];
}

ProfileVerdict& verdict_of(sample::Run& run) {
    return run.inputs.verdict.profiles[0];
}

void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
}

/// The labels of a table of speeds.
std::vector<std::string> labels_of(const Json& table) {
    std::vector<std::string> labels;
    for (const Json& row : table["rows"])
        labels.push_back(row["label"]);
    return labels;
}

TEST(RuleWords, SayKindDimensionSourceCountAndEnds) {
    Profile rule;
    rule.duration_s = 3.0;
    rule.definition = SpeedDefinition::displacement;
    EXPECT_EQ(rule_words(rule), "Speed over 3 s, by the definition: Displacement over time.");
    rule.dimension = Dimension::vertical;
    rule.exact_duration = true;
    EXPECT_EQ(rule_words(rule),
              "Vertical speed over 3 s, by the definition: Displacement over time. A window's ends "
              "are measured epochs exactly that far apart.");
    rule = Profile();
    rule.duration_s = 10.0;
    rule.definition = SpeedDefinition::mean_n_plus_1;
    rule.speed_source = SpeedSource::velocity;
    rule.windows = 5;
    EXPECT_EQ(rule_words(rule),
              "Speed over 10 s, the mean of the 5 fastest windows that do not overlap, by the "
              "definition: Mean of the speeds, both ends included, from the velocities that the "
              "recording states.");
    rule = Profile();
    rule.window_kind = WindowKind::course;
    rule.distance_m = 500.0;
    rule.definition = SpeedDefinition::elapsed_time;
    rule.current = CurrentUse::subtracted;
    EXPECT_EQ(rule_words(rule),
              "Speed over a course of 500 m, by the definition: Surveyed length over the time "
              "between the lines. The current's component along the course is subtracted.");
    rule = Profile();
    rule.window_kind = WindowKind::distance;
    rule.distance_m = 1852.0;
    rule.definition = SpeedDefinition::path_length;
    rule.ends = WindowEnds::any;
    rule.opposite_runs_within_s = 3600.0;
    EXPECT_EQ(rule_words(rule),
              "Speed over 1852 m, the mean of two runs in opposite directions within 3600 s, by "
              "the definition: Path length over time. A window may begin and end at any instant.");
}

TEST(RuleUnit, IsThatOfTheResultFirst) {
    Profile rule;
    EXPECT_EQ(rule_unit(rule).name, "km/h");
    rule.accuracy_unit = "mph";
    EXPECT_EQ(rule_unit(rule).name, "mph");
    rule.rounding = DecimalRule{.mode = DecimalMode::nearest, .unit = "m/s", .decimals = 2};
    EXPECT_EQ(rule_unit(rule).name, "m/s");
    rule.result = DecimalRule{.mode = DecimalMode::truncate, .unit = "kn", .decimals = 2};
    EXPECT_EQ(rule_unit(rule).name, "kn");
}

TEST(Decision, IsInTheReportInFiguresAndWords) {
    const sample::Run run = sample::make_run();
    const Json nalsa = profile_of(run);
    EXPECT_EQ(nalsa["decision"]["probability"], 0.9999876);
    EXPECT_EQ(nalsa["decision"]["acceptance_limit_m_s"], 56.8201);
    expect_in(nalsa["decision_rule"], "At least 95 % counts as beaten, at most 5 % as not beaten");
    expect_in(
        nalsa["decision"]["decision_words"],
        "Conformance probability: 99.9987 % (at least 95 % required). It includes the standard "
        "uncertainty of the record itself, 0.025 km/h of the required speed.");
    expect_in(nalsa["decision"]["decision_words"],
              "Guard band w = 0.044 km/h (acceptance limit less required speed). Risk of false "
              "acceptance: 0.0013 % (that the true speed is below the required speed).");
    EXPECT_EQ(nalsa["decision"]["guard_band_m_s"], 0.011949);
    EXPECT_EQ(nalsa["decision_rule_agreed"], "No agreement on the decision rule is stated.");
    EXPECT_EQ(nalsa["record"]["record_words"],
              "202.9 km/h ± 0.05 km/h (k = 2): published figure of 2009");
    EXPECT_EQ(nalsa["headline"]["headline_required_speed"], "204.51");
    const auto labels = labels_of(nalsa["speed_table"]);
    EXPECT_NE(std::ranges::find(labels, "Acceptance limit"), labels.end());
    const std::string page = page_of(run);
    expect_in(page, "<p class=\"speed\">216.00 ± 0.019 km/h");
    expect_in(page, "Required speed: 204.51 km/h");
    expect_in(page,
              "Speed rounded down; uncertainty, required speed and acceptance limit rounded up.");
    expect_in(page, "99.9987 %");
    expect_in(page, "202.9 km/h ± 0.05 km/h (k = 2): published figure of 2009");
}

TEST(Decision, WhoAgreedOnItsRuleStandsBesideIt) {
    sample::Run run = sample::make_run();
    run.inputs.attempt.decision_rule_agreed =
        DecisionRuleAgreement{.date = "2022-03-01", .by = "the board & the team"};
    expect_in(page_of(run),
              "<bdi>The decision rule was agreed on 2022-03-01 by the board &amp; the team.</bdi>");
}

TEST(Decision, ThatIsNegativeHasARiskOfFalseRejection) {
    sample::Run run = sample::make_run();
    verdict_of(run).outcome = Outcome::not_proven;
    verdict_of(run).decision->risk = 0.42;
    expect_in(page_of(run), "Risk of false rejection: 42.00 % (that the true speed reaches the");
}

TEST(Decision, OfASpeedThatCannotBeCertifiedItSaysThatItDoesNotCount) {
    sample::Run run = sample::make_run();
    EXPECT_EQ(page_of(run).find("no comparison counts"), std::string::npos);
    verdict_of(run).outcome = Outcome::not_certifiable;
    expect_in(page_of(run), "The speed cannot be certified, so that no comparison counts. Conf");
}

// 0.9999876 * 100 cut off; a level is never shown as reached by less.
TEST(Decision, AProbabilityIsRoundedToTheSideOfDoubt) {
    EXPECT_EQ(probability_text(0.9749999), "97.49 %");
    EXPECT_EQ(probability_text(0.975), "97.50 %");
    EXPECT_EQ(probability_text(0.0250001), "2.51 %");
    EXPECT_EQ(probability_text(1.0), "more than 99.9999 %");
    EXPECT_EQ(probability_text(0.0), "less than 0.0001 %");
}

TEST(Decision, WithoutARecordTheRuleIsSaidAllTheSame) {
    sample::Run run = sample::make_run();
    verdict_of(run).decision.reset();
    verdict_of(run).required_speed_m_s.reset();
    verdict_of(run).record.reset();
    const Json nalsa = profile_of(run);
    expect_in(nalsa["decision_rule"],
              "At least 97.5 % counts as beaten, at most 2.5 % as not beaten");
    EXPECT_FALSE(nalsa.contains("decision"));
    EXPECT_FALSE(nalsa.contains("record"));
}

TEST(Reservations, NotesStandWithTheVerdict) {
    const std::string page = page_of(sample::make_run());
    EXPECT_LT(page.find("The wind was not measured"), page.find("<h2>The attempt"));
    sample::Run silent = sample::make_run();
    for (ProfileVerdict& verdict : silent.inputs.verdict.profiles)
        verdict.notes.clear();
    EXPECT_EQ(page_of(silent).find("<ul class=\"notes\""), std::string::npos);
}

TEST(Reservations, ReplacedFiguresStandBesideTheRules) {
    const sample::Run run = sample::make_run();
    const Json overrides = profile_of(run)["overrides"];
    ASSERT_EQ(overrides.size(), 2U);
    EXPECT_EQ(overrides[0]["rule_text"], "1 mph");
    EXPECT_EQ(overrides[0]["used_text"], "1.25 mph");
    EXPECT_EQ(overrides[1]["reason"], "none given");
    const std::string page = page_of(run);
    expect_in(page,
              "<td>1 mph</td><td><strong>1.25 mph</strong></td>"
              "<td><bdi>agreed with the &lt;board&gt;</bdi></td>");
    expect_in(page, "<td>0.975</td><td><strong>0.95</strong></td>");
    sample::Run as_it_is = sample::make_run();
    for (ProfileVerdict& verdict : as_it_is.inputs.verdict.profiles)
        verdict.overrides.clear();
    EXPECT_EQ(page_of(as_it_is).find("the attempt replaced"), std::string::npos);
}

TEST(Reservations, WhatCouldNotBeConfirmedIsListed) {
    const sample::Run run = sample::make_run();
    EXPECT_FALSE(profile_of(run, 0).contains("unconfirmed"));
    ASSERT_EQ(profile_of(run, 1)["unconfirmed"].size(), 1U);
    EXPECT_EQ(profile_of(run, 1)["unconfirmed"][0],
              "accuracy: A limit of the measurement's uncertainty; none was found in what could be "
              "consulted. Source: not found.");
    expect_in(page_of(run), "What could not be confirmed of rule “fisly”");
    EXPECT_EQ(page_of(run).find("What could not be confirmed of rule “nalsa”"), std::string::npos);
}

TEST(Course, FiguresOfRequirementsStandUnderTheirEvidence) {
    const sample::Run run = sample::make_run();
    const Json profile = profile_of(run);
    for (const Json& requirement : profile["requirements"])
        EXPECT_NE(requirement["figures"].empty(), requirement["clause"] == "accuracy" ||
                                                      requirement["clause"] == "secondary-method");
    expect_in(page_of(run),
              "limit 0.8 km/h.<span class=\"figure\">expanded uncertainty: 0.018367 km/h; "
              "of the budget</span><span class=\"figure\">limit: 0.8 km/h</span>");
}

TEST(Course, QuantitiesHaveTheirUncertainty) {
    const sample::Run run = sample::make_run();
    const Json course = profile_of(run)["course"];
    EXPECT_EQ(course[0]["value"], 0.421234);
    EXPECT_EQ(course[0]["expanded_uncertainty"], 0.0783);
    EXPECT_EQ(course[0]["quantity_text"], "0.421 m ± 0.079 m (k = 2)");
    EXPECT_EQ(course[1]["quantity_text"], "45 deg");
    EXPECT_FALSE(course[1].contains("expanded_uncertainty"));
    expect_in(page_of(run),
              "<td>0.421 m ± 0.079 m (k = 2)</td><td>highest less lowest smoothed height</td>");
}

TEST(Course, RunsAreListedAndTheOneWithTheWindowMarked) {
    const sample::Run run = sample::make_run();
    const Json runs = profile_of(run)["runs"];
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_EQ(runs[0]["holds_window"], false);
    EXPECT_EQ(runs[1]["holds_window"], true);
    EXPECT_EQ(runs[1]["start_time_s"], 18.7);
    EXPECT_EQ(runs[1]["end_utc"], "2022-03-18T08:51:49.300Z");  // 45 s after the first epoch
    EXPECT_EQ(runs[1]["top_speed_m_s"], 60.012345);
    EXPECT_EQ(runs[1]["run_heading"], "45.0°");
    EXPECT_EQ(runs[1]["run_words"], "begins after a turn, ends at a standstill");
    expect_in(page_of(run),
              "<tr class=\"holds\"><td data-label=\"Run\">2</td><td data-label=\"Begins at\">"
              "18.700 s</td>");
}

TEST(Windows, OverACourseNoneOfTheFourDefinitionsIsTheRules) {
    sample::Run run = sample::make_run();
    Profile& rule = run.inputs.profiles[0];
    rule.window_kind = WindowKind::course;
    rule.distance_m = 500.0;
    rule.definition = SpeedDefinition::elapsed_time;
    windows_of(run).best->length_m = 500.25;
    const Json nalsa = profile_of(run);
    EXPECT_EQ(nalsa["rule_kind"], "course");
    EXPECT_EQ(nalsa["rule_distance_m"], 500.0);
    EXPECT_FALSE(nalsa.contains("rule_duration_s"));
    for (const Json& definition : nalsa["window"]["definitions"])
        EXPECT_EQ(definition["counts"], false);
    EXPECT_EQ(labels_of(nalsa["window"]["definition_table"])[0], "Over the course – the rule's");
    expect_in(nalsa["window"]["definition_note"], "None of the four definitions is the rule's");
    expect_in(page_of(run), "<th scope=\"row\">Length that the speed is of</th><td>500.250 m</td>");
}

TEST(Windows, OfRecordedVelocitiesNoneOfTheFourDefinitionsIsTheRules) {
    sample::Run run = sample::make_run();
    run.inputs.profiles[0].speed_source = SpeedSource::velocity;
    run.inputs.profiles[0].definition = SpeedDefinition::mean_n;
    const Json window = profile_of(run)["window"];
    EXPECT_EQ(labels_of(window["definition_table"])[0],
              "Recorded velocities, mean of the speeds after the first – the rule's");
    expect_in(window["definition_note"], "velocities that the recording states");
    run.inputs.profiles[0].speed_source = SpeedSource::position;
    EXPECT_EQ(profile_of(run)["window"]["definitions"][3]["counts"], true);
}

TEST(Windows, ThoseThatMakeTheFigureTogetherAreListedWithTheirMean) {
    sample::Run run = sample::make_run();
    run.inputs.profiles[0].windows = 2;
    ProfileWindows& windows = windows_of(run);
    windows.rule.count = 2;
    WindowSpan other = windows.best->span;
    other.start.nanoseconds -= 5'000'000'000;
    windows.further = {
        {.span = other, .arc = 1, .speed_m_s = 59.0, .standard_uncertainty_m_s = 0.004}};
    verdict_of(run).speed_m_s = 59.5012085;
    const Json nalsa = profile_of(run);
    EXPECT_EQ(nalsa["rule_windows"], 2);
    EXPECT_EQ(nalsa["window"]["further"][0]["start_time_s"], 35.2);
    EXPECT_EQ(labels_of(nalsa["window"]["further_table"]),
              (std::vector<std::string>{"3.000 s from 40.200 s", "3.000 s from 35.200 s",
                                        "Mean of the 2"}));
    // (216.0087 + 212.4) / 2
    EXPECT_EQ(nalsa["window"]["further_table"]["rows"][2]["cells"][0], "214.204");
    expect_in(nalsa["window"]["uncertainty"]["budget_subject"], "fastest window alone");
    // Of the speed that the verdict gives, not of the fastest window alone.
    expect_in(nalsa["window"]["uncertainty"]["certified_words"], verdict_of(run).shown->speed);
    expect_in(page_of(run), "Windows that make the figure");
}

TEST(Windows, WhatIsMissingIsSaid) {
    sample::Run run = sample::make_run({.certified = false});
    windows_of(run).missing = "the recording has no heights that could be estimated";
    expect_in(page_of(run),
              "What is missing: the recording has no heights that could be estimated.");
    EXPECT_FALSE(profile_of(run, 1).contains("missing_words"));
}

TEST(Windows, AVerticalRuleSaysSo) {
    sample::Run run = sample::make_run();
    run.inputs.profiles[0].dimension = Dimension::vertical;
    const Json predicate = report_json(run.inputs)["predicate"];
    EXPECT_EQ(predicate["profiles"][0]["rule_dimension"], "vertical");
    EXPECT_FALSE(predicate["profiles"][1].contains("rule_dimension"));
    expect_in(predicate["figures"][0]["caption"], "counts another than the horizontal speed");
    EXPECT_EQ(predicate["figures"][1]["caption"].get<std::string>().find("another than"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
