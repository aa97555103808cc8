#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "core/failure.h"
#include "reports/diff/day_difference.h"
#include "reports/document/document_text.h"
#include "schemas/verdict/figures.h"
#include "store/process.h"

// What is said of two days' results: each change by hand, at its limit and beyond.

namespace runcert::RUNCERT_FILE {
namespace {

/// A result whose standard uncertainty is a tenth of 1 m/s.
DayResult result(double speed_m_s, Outcome outcome = Outcome::beaten, double expanded = 0.2) {
    return {.profile = "nalsa",
            .outcome = outcome,
            .reason = "why",
            .speed_m_s = speed_m_s,
            .expanded_uncertainty_m_s = expanded,
            .coverage_factor = 2.0};
}

AttemptResult done(const std::string& id, std::vector<DayResult> results) {
    return {.id = id, .source = "s", .state = "done", .results = std::move(results)};
}

AttemptResult failed(const std::string& id, const std::string& problem) {
    return {.id = id,
            .source = "s",
            .state = "failed",
            .failure = DayFailure{.step = "import", .problem = problem}};
}

DayComparison compared(std::vector<AttemptResult> then, std::vector<AttemptResult> now) {
    return compare_results({.header = {}, .day = "d", .attempts = std::move(then)},
                           {.header = {}, .day = "d", .attempts = std::move(now)});
}

TEST(CompareDays, AMoveUpToATenthOfTheSmallerStandardUncertaintyIsNone) {
    EXPECT_TRUE(compared({done("a", {result(64.0)})}, {done("a", {result(64.009765625)})}).equal());
    const DayComparison moved =
        compared({done("a", {result(64.0)})}, {done("a", {result(64.01171875)})});
    ASSERT_EQ(moved.results.size(), 1U);
    EXPECT_TRUE(moved.results[0].speed_moved);
    EXPECT_FALSE(moved.results[0].outcome_changed);
    EXPECT_NEAR(*moved.results[0].moved_by, 0.1171875, 1e-9);
    // The smaller of two uncertainties counts, whichever it is.
    for (const bool swap : {false, true}) {
        DayResult sure = result(64.0, Outcome::beaten, 0.2),
                  unsure = result(64.015, Outcome::beaten, 0.4);
        if (swap) std::swap(sure.speed_m_s, unsure.speed_m_s);
        if (swap) std::swap(sure, unsure);
        const DayComparison found = compared({done("a", {sure})}, {done("a", {unsure})});
        ASSERT_EQ(found.results.size(), 1U);
        EXPECT_TRUE(found.results[0].speed_moved);
        EXPECT_TRUE(found.results[0].uncertainty_moved);
    }
}

TEST(CompareDays, AnUncertaintyThatGrewIsSaidThoughTheSpeedStands) {
    const DayComparison found =
        compared({done("a", {result(64.0)})}, {done("a", {result(64.0, Outcome::beaten, 0.25)})});
    ASSERT_EQ(found.results.size(), 1U);
    EXPECT_FALSE(found.results[0].speed_moved);
    EXPECT_TRUE(found.results[0].uncertainty_moved);
}

TEST(CompareDays, OutcomesStatesAndAttemptsThatCameOrWent) {
    DayResult none = result(0.0, Outcome::not_certifiable);
    none.speed_m_s.reset();
    none.expanded_uncertainty_m_s.reset();
    DayResult fisly = result(63.0);
    fisly.profile = "fisly";
    const DayComparison found = compared(
        {done("same", {result(64.0)}), done("lost", {result(64.0)}), done("worse", {result(64.0)}),
         done("refused", {result(64.0)}), failed("cured", "x"), failed("sick", "x"),
         failed("other", "x"), done("gone", {})},
        {done("new", {}), done("refused", {none}),
         done("worse", {result(64.0, Outcome::not_beaten)}), failed("lost", "cut off"),
         done("cured", {}), failed("sick", "x"), failed("other", "y"),
         done("same", {result(64.0), fisly})});
    EXPECT_EQ(found.only_old, std::vector<std::string>{"gone"});
    EXPECT_EQ(found.only_new, std::vector<std::string>{"new"});
    EXPECT_EQ(found.in_both, 7);
    EXPECT_EQ(found.unchanged, 1);  // "sick" is as sick as before
    std::vector<std::string> states;
    for (const StateChange& change : found.states)
        states.push_back(change.id + " " + change.old_state + " " + change.new_state);
    EXPECT_EQ(states, (std::vector<std::string>{"lost done failed", "cured failed done",
                                                "other failed failed"}));
    std::vector<std::string> results;
    for (const ResultChange& change : found.results)
        results.push_back(change.id + " " + change.profile + (change.outcome_changed ? " o" : "") +
                          (change.speed_moved ? " s" : ""));
    EXPECT_EQ(results,
              (std::vector<std::string>{"refused nalsa o s", "worse nalsa o", "same fisly o"}));
    const std::string text = document_text(comparison_document(found, "old", "new"), 80);
    for (const char* part :
         {"The same  1 of 7 attempts in both",
          "lost     processed             failed at import (cut",
          "cured    failed at import (x)  processed\n", "worse, nalsa    beaten       not beaten\n",
          "same, fisly     not claimed  beaten\n", "Only in the old day: 1:\n- gone\n",
          "Only in the new day: 1:\n- new\n"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    EXPECT_EQ(text.find("Nothing changed"), std::string::npos);
}

TEST(CompareDays, OfEqualIdsTheOneThatIsDoneCounts) {
    const std::vector<AttemptResult> day{done("a", {result(64.0)}), failed("a", "id taken")};
    EXPECT_TRUE(compared(day, day).equal());
    EXPECT_EQ(compared(day, day).in_both, 1);
}

TEST(CompareDays, AttemptsThatChangedForTheSameReasonsStandTogetherAndListsAreCut) {
    std::vector<AttemptResult> then, now;
    for (int i = 0; i < 50; ++i) {
        then.push_back(done("run-" + std::to_string(i), {result(64.0)}));
        now.push_back(done("run-" + std::to_string(i), {result(65.0)}));
    }
    DayComparison found = compared(then, now);
    for (int i = 0; i < 50; ++i) {
        ChangeCauses causes{.id = "run-" + std::to_string(i)};
        causes.causes.parameters.push_back({"smooth.jerk_density", "1", i < 49 ? "2" : "3"});
        found.causes.push_back(causes);
    }
    const std::string text = document_text(comparison_document(found, "old", "new\x1b[2J"), 80);
    EXPECT_NE(text.find("and 30 more"), std::string::npos) << text;
    EXPECT_NE(text.find("parameter smooth.jerk_density: 1 -> 2"), std::string::npos) << text;
    EXPECT_NE(text.find("Why, of run-49:"), std::string::npos) << text;
    EXPECT_EQ(text.find('\x1b'), std::string::npos);
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        EXPECT_LE(characters_in(line), 80U) << line;
    const std::string all = document_text(comparison_document(found, "old", "new", true), 80);
    EXPECT_NE(all.find("run-33, nalsa"), std::string::npos);
    EXPECT_EQ(comparison_json(found)["results"].size(), 50U);
    EXPECT_EQ(comparison_json(found)["causes"][49]["parameters"][0]["new"], "3");
}

// A reader compares what reports show, in the record's unit; a move that rounding hides stands
// beneath, with the digits of the files.
TEST(CompareDays, SpeedsStandInTheRecordsUnitAndAsTheFilesHaveThem) {
    const auto shown = [](double speed_m_s) {
        DayResult one = result(speed_m_s);
        one.shown =
            shown_in({.speed_m_s = speed_m_s, .expanded_uncertainty_m_s = 0.2}, speed_unit("km/h"));
        return one;
    };
    const DayComparison found = compared({done("a", {shown(64.0)})}, {done("a", {shown(64.02)})});
    const Document said = comparison_document(found, "old", "new");
    const auto moved =
        std::ranges::find(said.sections.at(0).blocks, BlockKind::table, &Block::kind);
    ASSERT_NE(moved, said.sections[0].blocks.end());
    EXPECT_EQ(moved->text, "Speeds and uncertainties that moved: 1");
    EXPECT_EQ(moved->rows.at(0).cells,
              (std::vector<std::string>{"a, nalsa", "beaten, 230.40 km/h ± 0.72 km/h",
                                        "beaten, 230.47 km/h ± 0.72 km/h"}));
    EXPECT_EQ(moved->rows[0].further,
              std::vector<std::string>{"in the files 64.000000 m/s ± 0.200000 m/s -> 64.020000 m/s "
                                       "± 0.200000 m/s, +0.2 of its standard uncertainty"});
}

TEST(CompareDays, AFolderWithoutADayIsNamed) {
    const TemporaryFolder folder;
    try {
        (void)compare_days(folder.path(), folder.path());
        ADD_FAILURE();
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), (folder.path() / "day.yaml").string());
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
