#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports_page_support.h"
#include "reports_sample.h"
#include "store/process.h"
#include "trust/run_standing.h"

// What was answered after a report was signed, in the places that the report has for it; and what a
// document may hold.

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

GivenAnswer answer(const std::string& word) {
    return {.file = "attestations/answer-1.json",
            .profile = "nalsa",
            .clause = "own-start",
            .answer = word,
            .role = "judge",
            .who = "Jane <Roe>",
            .time = "2026-11-26T20:12:03Z",
            .counts = true,
            .vouched = true};
}

/// One clause of nalsa was answered, the others are open.
RunStanding answered(const std::string& word) {
    ClauseStanding own_start{
        .due = {.profile = "nalsa", .clause = "own-start", .answered_by = {"judge", 1}},
        .answers = {answer(word)},
        .missing = word == "yes" ? 0 : 1,
        .refused = word == "no",
        .vouched = word == "yes"};
    ClauseStanding observers{
        .due = {.profile = "nalsa", .clause = "observers", .answered_by = {"judge", 1}},
        .missing = 1};
    RuleStanding nalsa{
        .profile = "nalsa",
        .state = {.outcome = Outcome::beaten,
                  .standing = {.state = StandingState::awaiting, .attestations = 4},
                  .record_named = true,
                  .vouched_by = "by the roster bbbb bbbb: compare it with your body's"},
        .clauses = {own_start, observers}};
    if (word == "no") {
        nalsa.state.standing.state = StandingState::refused;
        nalsa.state.standing.refused = 1;
    }
    return {.rules = {nalsa}, .given = {.envelopes = 1}, .roster_sha256 = std::string(64, 'b')};
}

Json report_of(const sample::Run& run) {
    return report_json(run.inputs);
}

Json slots_of(const Json& report, const std::string& word) {
    return standing_json(answered(word), report["predicate"])["slots"];
}

std::string page_with(const Json& report, const Json& standing) {
    return report_print_page(report_text_of(report), report, {}, report_text_of(standing));
}

TEST(Standing, OfNobodysAnswersIsNothing) {
    const Json report = report_of(sample::make_run());
    EXPECT_EQ(standing_json(RunStanding{}, report["predicate"]), Json::object());
    EXPECT_EQ(slot_at(report, "answers")["facts"][0]["value"], "none when this report was made");
}

TEST(Standing, ChangesWhatItIsAboutAndNothingElse) {
    const Json report = report_of(sample::with_one_rule(sample::make_run()));
    const Json slots = slots_of(report, "yes");
    std::vector<std::string> names;
    for (const auto& [name, block] : slots.items()) {
        names.push_back(name);
        EXPECT_EQ(block["slot"], name);
        const Json before = slot_at(report, name);
        ASSERT_FALSE(before.is_null()) << name;
        EXPECT_EQ(block["kind"], before["kind"]);
    }
    EXPECT_EQ(names,
              (std::vector<std::string>{"outcome/nalsa", "standing/nalsa", "requirements/nalsa",
                                        "clauses", "closing", "answers"}));
    EXPECT_NE(slots["closing"]["text"].get<std::string>().find("Keys of the roster"),
              std::string::npos);
    EXPECT_EQ(slots["standing/nalsa"]["text"], "Standing: awaiting 4 attestations.");
    for (const char* list : {"requirements/nalsa", "clauses"}) {
        const char* of = list == std::string("clauses") ? "rows" : "facts";
        const Json before = slot_at(report, list)[of];
        ASSERT_EQ(slots[list][of].size(), before.size());
        for (std::size_t i = 0; i < before.size(); ++i) {
            const Json& now = slots[list][of][i];
            if (now["clause"] != "own-start") {
                EXPECT_EQ(now, before[i]);
                continue;
            }
            EXPECT_EQ(now["mark"], "answered");
            // Few words on the first page; who it was in the annex.
            if (of == std::string("facts")) {
                EXPECT_EQ(now["value"], "✓ judge, 26 Nov");
            } else {
                EXPECT_NE(now.dump().find("Jane <Roe>"), std::string::npos) << now;
            }
        }
    }
    bool is_said = false;
    for (const Json& fact : slots["answers"]["facts"])
        is_said =
            is_said || fact["value"].get<std::string>().find("own-start") != std::string::npos;
    EXPECT_TRUE(is_said) << slots["answers"];
}

TEST(Standing, OfANoIsSeen) {
    const Json report = report_of(sample::with_one_rule(sample::make_run()));
    const Json slots = slots_of(report, "no");
    for (const Json& fact : slots["requirements/nalsa"]["facts"])
        if (fact["clause"] == "own-start") {
            EXPECT_EQ(fact["mark"], "not_met");
            EXPECT_TRUE(fact["value"].get<std::string>().starts_with("✗ no by judge, ")) << fact;
        }
    EXPECT_NE(slots["outcome/nalsa"], slot_at(report, "outcome/nalsa"));
}

/// The row of own-start in the one table of two rules' requirements.
Json own_start_of(const Json& block) {
    for (const Json& row : block["rows"])
        if (row["clause"] == "own-start") return row;
    return {};
}

TEST(Standing, OfSeveralRulesEachKeepsItsSourceAndWhatTheDataRefuse) {
    sample::Run run = sample::make_run();
    auto& rules = run.inputs.verdict.profiles;
    const auto own_start =
        std::ranges::find(rules[0].requirements, std::string("own-start"), &Requirement::clause);
    ASSERT_NE(own_start, rules[0].requirements.end());
    std::erase_if(rules[1].requirements,
                  [](const Requirement& one) { return one.clause == "own-start"; });
    rules[1].requirements.push_back(*own_start);
    rules[1].requirements.back().source = "another text";
    const Json alike = own_start_of(slot_at(report_of(run), "clauses"));
    EXPECT_EQ(alike["cells"][0], "to attest");
    EXPECT_NE(alike["further"].dump().find("nalsa: "), std::string::npos) << alike;
    EXPECT_NE(alike["further"].dump().find("fisly: "), std::string::npos) << alike;
    EXPECT_NE(alike["further"].dump().find("another text"), std::string::npos) << alike;
    // Where nobody has answered, the row stays as it was.
    RunStanding standing = answered("yes");
    standing.rules[0].clauses[0].answers.clear();
    const Json report = report_of(run);
    EXPECT_EQ(own_start_of(standing_json(standing, report["predicate"])["slots"]["clauses"]),
              own_start_of(slot_at(report, "clauses")));
    EXPECT_EQ(own_start_of(slots_of(report, "yes")["clauses"])["mark"], "answered");
    // A yes under one rule hides nothing that the data refuse under the other.
    rules[1].requirements.back().status = RequirementStatus::not_met;
    EXPECT_EQ(own_start_of(slots_of(report_of(run), "yes")["clauses"])["mark"], "not_met");
}

TEST(Standing, OfOneRuleOfSeveralLeavesTheOthersAlone) {
    const Json report = report_of(sample::make_run());
    const Json slots = slots_of(report, "yes");
    EXPECT_TRUE(slots.contains("outcome/nalsa"));
    EXPECT_TRUE(slots["outcome/nalsa"]["text"].get<std::string>().starts_with("nalsa: "));
    EXPECT_EQ(slots["outcome/nalsa"]["look"], "strong");
    EXPECT_FALSE(slots.contains("requirements/nalsa")) << "an overview has no list of them";
    for (const auto& [name, block] : slots.items())
        EXPECT_EQ(name.find("fisly"), std::string::npos) << name;
}

TEST(Standing, StandsInThePageWhereItsSlotsAre) {
    const Json report = report_of(sample::with_one_rule(sample::make_run()));
    const std::string before = print_page(report);
    const std::string after =
        page_with(report, standing_json(answered("yes"), report["predicate"]));
    for (const char* same :
         {"window", "uncertainty", "screening", "run", "recording", "method", "files"}) {
        EXPECT_FALSE(section_html(before, same).empty()) << same;
        EXPECT_EQ(section_html(after, same), section_html(before, same)) << same;
    }
    for (const char* other : {"certificate", "requirements"})
        EXPECT_NE(section_html(after, other), section_html(before, other)) << other;
    EXPECT_NE(after.find("Jane &lt;Roe&gt;"), std::string::npos);
    EXPECT_NE(after.find("<div class=\"mark-answered\"><dt><bdi>Own start</bdi></dt>"),
              std::string::npos);
}

// Whoever writes a standing cannot put a block where the report has no place for one.
TEST(Standing, OfAPlaceThatTheReportDoesNotHaveIsNotShown) {
    const Json report = report_of(sample::make_run());
    Json block{{"kind", "headline"}, {"slot", "praise"}, {"text", "299.99 km/h"}};
    const std::string page = page_with(
        report, {{"roster_sha256", ""}, {"slots", {{"praise", block}, {"outcome/none", block}}}});
    EXPECT_EQ(page.find("299.99"), std::string::npos);
}

TEST(Document, HoldsNoMemberThatItsSchemaDoesNotKnow) {
    const Json report = report_of(sample::make_run());
    const std::string block = "/predicate/document/sections/0/blocks/0";
    const auto refused = [&](const std::string& path, const Json& value) {
        const Json patch = Json::array({{{"op", "add"}, {"path", path}, {"value", value}}});
        EXPECT_THROW(parse_report(report.patch(patch).dump(), "report.json"), Failure) << path;
    };
    refused(block + "/is_check", true);
    refused(block + "/code_image", "<b>checked</b>");
    refused(block + "/kind", "frame");
    refused(block + "/look", "beautiful");
    refused(block + "/html", "<b>");
    refused("/predicate/document/sections/0/code_image", "<b>");
    refused("/predicate/document/style", "p {}");
}

// Whoever writes a report by hand can name any figure, and leave anything out that may be absent.
TEST(Document, ThatNamesAFigureWhichIsNotThereIsRefused) {
    const Json whole = report_of(sample::make_run());
    const auto with_plot = [&](int index) {
        Json report = whole;
        for (Json& section : report["predicate"]["document"]["sections"])
            for (Json& block : section["blocks"])
                if (block.contains("plots")) block["plots"][0]["plot"] = index;
        return parse_report(report_text_of(report), "report.json");
    };
    const auto count = static_cast<int>(whole["predicate"]["figures"].size());
    EXPECT_NO_THROW(print_page(with_plot(count - 1)));
    EXPECT_THROW(print_page(with_plot(count)), Failure);
}

TEST(Document, OfATableWithoutColumnsHasAPage) {
    Json report = report_of(sample::make_run());
    for (Json& section : report["predicate"]["document"]["sections"])
        for (Json& block : section["blocks"])
            block.erase("columns");
    EXPECT_NO_THROW(print_page(parse_report(report_text_of(report), "report.json")));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
