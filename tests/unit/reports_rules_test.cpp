#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

Json profile_of(const sample::Run& run, std::size_t index = 0) {
    return report_json(run.inputs)["predicate"]["verdict"]["profiles"][index];
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

const Place requirements_of_nalsa{.section = "requirements", .rule = "nalsa"};
const Place window_of_nalsa{.section = "window", .rule = "nalsa"};

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
    EXPECT_EQ(rule_unit_name(rule), "km/h");
    rule.accuracy_unit = "mph";
    EXPECT_EQ(rule_unit_name(rule), "mph");
    rule.rounding = DecimalRule{.mode = DecimalMode::nearest, .unit = "m/s", .decimals = 2};
    EXPECT_EQ(rule_unit_name(rule), "m/s");
    rule.result = DecimalRule{.mode = DecimalMode::truncate, .unit = "kn", .decimals = 2};
    EXPECT_EQ(rule_unit_name(rule), "kn");
}

TEST(Decision, IsInTheReportInFiguresAndWords) {
    const sample::Run run = sample::make_run();
    const Json report = report_json(run.inputs);
    const Json& nalsa = report["predicate"]["verdict"]["profiles"][0];
    EXPECT_EQ(nalsa["decision"]["probability"], 0.9999876);
    EXPECT_EQ(nalsa["decision"]["acceptance_limit_m_s"], 56.8201);
    EXPECT_EQ(nalsa["record"]["speed"], 202.9);
    EXPECT_EQ(nalsa["record"]["expanded_uncertainty"], 0.05);
    const auto said = [&](const char* name) { return fact_at(report, {"requirements"}, name); };
    expect_in(said("Decision rule"), "At least 95 % counts as beaten, at most 5 % as not beaten");
    EXPECT_EQ(said("Conformance probability"), "99.9987 % (at least 95 % required)");
    expect_in(said("Uncertainty"), "The required speed has a standard uncertainty of 0.025 km/h");
    EXPECT_EQ(said("Guard band"), "w = 0.05 km/h (acceptance limit less required speed).");
    EXPECT_EQ(said("Risk"),
              "Of false acceptance: 0.0013 % (that the true speed is below the required speed).");
    EXPECT_EQ(said("Agreement"), "No agreement on the decision rule is stated.");
    EXPECT_EQ(cell_at(report, window_of_nalsa, "Required speed", "km/h"), "204.51");
    EXPECT_EQ(cell_at(report, window_of_nalsa, "Acceptance limit", "km/h"), "204.56");
    const std::string page =
        print_page(report_json(sample::with_one_rule(sample::make_run()).inputs));
    expect_in(page,
              "<p class=\"headline\">216.00 km/h ± 0.019 km/h <small>(k = 2, 95 %)</small></p>");
    expect_in(page, "<dt><bdi>Required speed</bdi></dt><dd><bdi>204.51 km/h</bdi></dd>");
    expect_in(page,
              "Figures: speed rounded down; uncertainty, required speed and acceptance limit "
              "rounded up.");
    expect_in(page, "99.9987 % (at least 95 % required)");
    expect_in(page, "202.9 km/h ± 0.05 km/h (k = 2): “published figure of 2009”");
}

TEST(Decision, WhoAgreedOnItsRuleStandsBesideIt) {
    sample::Run run = sample::make_run();
    run.inputs.attempt.decision_rule_agreed =
        DecisionRuleAgreement{.date = "2022-03-01", .by = "the board & the team"};
    expect_in(page_of(run),
              "The decision rule was agreed on 2022-03-01 by “the board &amp; the team”.</bdi>");
}

TEST(Decision, ThatIsNegativeHasARiskOfFalseRejection) {
    sample::Run run = sample::make_run();
    verdict_of(run).outcome = Outcome::not_beaten;
    verdict_of(run).decision->risk = 0.42;
    expect_in(page_of(run), "Of false rejection: 42.00 % (that the true speed reaches the");
    // What is not proven claims nothing that could be wrong.
    verdict_of(run).outcome = Outcome::not_proven;
    EXPECT_EQ(page_of(run).find("Of false rejection"), std::string::npos);
}

TEST(Decision, OfASpeedThatCannotBeCertifiedItSaysThatItDoesNotCount) {
    sample::Run run = sample::make_run();
    EXPECT_EQ(page_of(run).find("it does not count"), std::string::npos);
    verdict_of(run).outcome = Outcome::not_certifiable;
    expect_in(page_of(run), "it does not count, since the speed cannot be certified");
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
    expect_in(fact_at(report_json(run.inputs), requirements_of_nalsa, "Decision rule"),
              "At least 97.5 % counts as beaten, at most 2.5 % as not beaten");
    EXPECT_FALSE(nalsa.contains("decision"));
    EXPECT_FALSE(nalsa.contains("record"));
}

TEST(Reservations, NotesStandWithTheRequirements) {
    sample::Run run = sample::make_run();
    const std::string note = "The wind was not measured by this recording.";
    // What both rules are told stands once, before the first of them.
    expect_in(sentences_at(report_json(run.inputs), {.section = "requirements"}), note);
    expect_in(section_html(page_of(run), "requirements"), "<li><bdi>" + note + "</bdi></li>");
    for (ProfileVerdict& verdict : run.inputs.verdict.profiles)
        verdict.notes.clear();
    for (const Json& block : blocks_at(report_json(run.inputs), requirements_of_nalsa))
        EXPECT_FALSE(block["kind"] == "items" && !block.contains("text")) << block;
    EXPECT_EQ(page_of(run).find("The wind was not measured"), std::string::npos);
}

TEST(Reservations, ReplacedFiguresStandBesideTheRules) {
    const sample::Run run = sample::make_run();
    const Place replaced{"requirements", "Figures of the rule that the attempt replaced", "nalsa"};
    const Json report = report_json(run.inputs);
    EXPECT_EQ(profile_of(run)["overrides"].size(), 2U);
    EXPECT_EQ(row_at(report, replaced, "margin.value")["cells"],
              Json({"margin.value", "1 mph", "1.25 mph", "agreed with the <board>"}));
    EXPECT_EQ(row_at(report, replaced, "decision.probability")["cells"],
              Json({"decision.probability", "0.975", "0.95", "none given"}));
    EXPECT_EQ(row_at(report, replaced, "margin.value")["mark"], "changed");
    const std::string page = section_html(page_of(run), "requirements");
    expect_in(page, "<tbody class=\"mark-changed\">");
    expect_in(page,
              "<bdi>1.25 mph</bdi></td><td data-label=\"Reason\"><bdi>agreed with the "
              "&lt;board&gt;</bdi></td>");
    // They are deviations too, which every certificate lists.
    expect_in(sentences_at(report, {"method", "Deviations from method and rules"}),
              "Rule nalsa, margin.value: 1.25 in place of 1 mph. Reason: agreed with the <board>.");
    sample::Run as_it_is = sample::make_run();
    for (ProfileVerdict& verdict : as_it_is.inputs.verdict.profiles)
        verdict.overrides.clear();
    EXPECT_EQ(page_of(as_it_is).find("the attempt replaced"), std::string::npos);
}

TEST(Reservations, WhatCouldNotBeConfirmedIsListed) {
    const char* title = "What could not be confirmed of the rule";
    sample::Run run = sample::with_one_rule(sample::make_run());
    EXPECT_EQ(sentences_at(report_json(run.inputs), {"requirements", title}), "");
    Requirement& first = verdict_of(run).requirements.front();
    first.certainty = Certainty::unconfirmed;
    EXPECT_EQ(sentences_at(report_json(run.inputs), {"requirements", title}),
              fmt::format("{}: {} Source: {}\n", first.clause, first.text, sentence(first.source)));
    // Of several rules it stands with the requirement.
    expect_in(slot_at(report_json(sample::make_run().inputs), "clauses").dump(), "ot confirmed: ");
}

TEST(Course, FiguresOfRequirementsStandUnderTheirEvidence) {
    const sample::Run run = sample::make_run();
    const Json profile = profile_of(run);
    for (const Json& requirement : profile["requirements"]) {
        EXPECT_NE(requirement["figures"].empty(), requirement["clause"] == "accuracy" ||
                                                      requirement["clause"] == "secondary-method");
    }
    Json further;
    const sample::Run alone = sample::with_one_rule(sample::make_run());
    const Json clauses = slot_at(report_json(alone.inputs), "clauses");
    for (const Json& row : clauses["rows"])
        if (row["clause"] == "accuracy") further = row["further"];
    ASSERT_EQ(further.size(), 3U);
    EXPECT_EQ(further[0], "expanded uncertainty: 0.018367 km/h; of the budget");
    EXPECT_EQ(further[1], "limit: 0.8 km/h");
    expect_in(further[2], "NALSA 2009, quoted in Deakin, Holden & Daddo 2022");
    expect_in(page_of(alone),
              "<span><bdi>expanded uncertainty: 0.018367 km/h; of the budget</bdi></span> "
              "<span><bdi>limit: 0.8 km/h</bdi></span>");
}

TEST(Course, QuantitiesHaveTheirUncertainty) {
    const sample::Run run = sample::make_run();
    const Json course = profile_of(run)["course"];
    EXPECT_EQ(course[0]["value"], 0.421234);
    EXPECT_EQ(course[0]["expanded_uncertainty"], 0.0783);
    EXPECT_FALSE(course[1].contains("expanded_uncertainty"));
    const Json report = report_json(run.inputs);
    const Place place{"run", "Course and craft"};
    EXPECT_EQ(row_at(report, place, "height difference of the run")["cells"],
              Json({"height difference of the run", "0.421 m ± 0.079 m (k = 2)",
                    "highest less lowest smoothed height"}));
    EXPECT_EQ(row_at(report, place, "heading")["cells"][1], "45 deg");
    expect_in(page_of(run), "<bdi>0.421 m ± 0.079 m (k = 2)</bdi>");
}

TEST(Course, RunsAreListedAndTheOneWithTheWindowMarked) {
    const sample::Run run = sample::make_run();
    const Json runs = profile_of(run)["runs"];
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_EQ(runs[1]["start_time_s"], 18.7);
    EXPECT_EQ(runs[1]["top_speed_m_s"], 60.012345);
    const Json report = report_json(run.inputs);
    const Place place{"run", "Runs of the craft"};
    EXPECT_EQ(row_at(report, place, "1").value("mark", ""), "");
    const Json second = row_at(report, place, "2");
    EXPECT_EQ(second["mark"], "chosen");
    EXPECT_EQ(second["cells"],
              Json({"2", "18.700 s", "26.300 s", "1501.2 m", "216.04 km/h", "45.0°",
                    "begins after a turn, ends at a standstill; holds the window of “nalsa” and "
                    "“fisly”"}));
    expect_in(
        page_of(run),
        "<tbody class=\"mark-chosen\">\n<tr><th scope=\"row\" class=\"number\"><bdi>2</bdi></th>"
        "<td class=\"number\" data-label=\"Begins at\"><bdi>18.700 s</bdi></td>");
}

TEST(Windows, OverACourseNoneOfTheFourDefinitionsIsTheRules) {
    sample::Run run = sample::make_run();
    Profile& rule = run.inputs.profiles[0];
    rule.window_kind = WindowKind::course;
    rule.distance_m = 500.0;
    rule.definition = SpeedDefinition::elapsed_time;
    windows_of(run).best->length_m = 500.25;
    const Json report = report_json(run.inputs);
    const Place definitions{"window", "By definition of speed", "nalsa"};
    const Json rows = blocks_at(report, definitions).at(0)["rows"];
    EXPECT_EQ(rows[0]["cells"][0], "Over the course – the rule's");
    for (const Json& row : rows)
        EXPECT_EQ(row.value("mark", ""), &row == &rows[0] ? "chosen" : "") << row;
    expect_in(sentences_at(report, window_of_nalsa), "None of the four definitions is the rule's");
    EXPECT_EQ(fact_at(report, window_of_nalsa, "Length that the speed is of"), "500.250 m");
    expect_in(fact_at(report, requirements_of_nalsa, "Rule"), "Speed over a course of 500 m");
}

TEST(Windows, OfRecordedVelocitiesNoneOfTheFourDefinitionsIsTheRules) {
    sample::Run run = sample::make_run();
    run.inputs.profiles[0].speed_source = SpeedSource::velocity;
    run.inputs.profiles[0].definition = SpeedDefinition::mean_n;
    const Place definitions{"window", "By definition of speed", "nalsa"};
    const auto chosen = [&] {
        std::vector<std::string> names;
        const Json table = blocks_at(report_json(run.inputs), definitions).at(0);
        for (const Json& row : table["rows"])
            if (row.value("mark", "") == "chosen") names.push_back(row["cells"][0]);
        return names;
    };
    EXPECT_EQ(chosen(),
              (std::vector<std::string>{
                  "Recorded velocities, mean of the speeds after the first – the rule's"}));
    expect_in(sentences_at(report_json(run.inputs), window_of_nalsa),
              "velocities that the recording states");
    run.inputs.profiles[0].speed_source = SpeedSource::position;
    EXPECT_EQ(chosen(),
              std::vector<std::string>{"Mean of the speeds after the first – the rule's"});
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
    const Json report = report_json(run.inputs);
    const Place together{"window", "Windows that make the figure", "nalsa"};
    const Json table = blocks_at(report, together).at(0);
    std::vector<std::string> names;
    for (const Json& row : table["rows"])
        names.push_back(row["cells"][0]);
    EXPECT_EQ(names, (std::vector<std::string>{"3.000 s from 40.200 s", "3.000 s from 35.200 s",
                                               "Mean of the 2"}));
    // (216.0087 + 212.4) / 2
    EXPECT_EQ(table["columns"][1]["head"], "km/h");
    EXPECT_EQ(table["rows"][2]["cells"][1], "214.20");
    EXPECT_EQ(table["rows"][2]["mark"], "chosen");
    const std::string uncertainty =
        sentences_at(report, {.section = "uncertainty", .rule = "nalsa"});
    expect_in(uncertainty, "fastest window alone");
    // Of the speed that the verdict gives, not of the fastest window alone.
    expect_in(uncertainty, "Measured speed: " + verdict_of(run).shown->speed);
    expect_in(page_of(run), "Windows that make the figure");
}

TEST(Windows, WhatIsMissingIsSaid) {
    sample::Run run = sample::make_run({.certified = false});
    windows_of(run).missing = "the recording has no heights that could be estimated";
    expect_in(page_of(run),
              "What is missing: the recording has no heights that could be estimated.");
    const Json report = report_json(run.inputs);
    expect_in(sentences_at(report, requirements_of_nalsa), "What is missing");
    EXPECT_EQ(sentences_at(report, {.section = "requirements", .rule = "fisly"}).find("is missing"),
              std::string::npos);
}

TEST(Windows, AVerticalRuleSaysSo) {
    sample::Run run = sample::make_run();
    run.inputs.profiles[0].dimension = Dimension::vertical;
    const Json predicate = report_json(run.inputs)["predicate"];
    expect_in(fact_at(report_json(run.inputs), requirements_of_nalsa, "Rule"),
              "Vertical speed over 3 s, by the definition");
    expect_in(
        fact_at(report_json(run.inputs), {.section = "requirements", .rule = "fisly"}, "Rule"),
        "Speed over 2 s, by the definition");
    for (const Json& figure : predicate["figures"]) {
        if (figure["figure"] != "window") continue;
        const bool is_said = figure["caption"].get<std::string>().find(
                                 "counts another than the horizontal speed") != std::string::npos;
        EXPECT_EQ(is_said, figure["figure_profile"] == "nalsa") << figure["figure_profile"];
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
