#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/day/summary.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

const std::string hash(64, 'a');

Json good_report() {
    return {
        {"subject", {{{"name", "6-verdict.yaml"}, {"digest", {{"sha256", hash}}}}}},
        {"predicate",
         {{"report_id", "0123"},
          {"attempt", {{"id", "run-1"}, {"craft_name", "Ice Bird"}, {"craft_class", "ice-yacht"}}},
          {"figures", Json::array()}}}};
}

Plot window_plot(const std::string& rule) {
    Plot plot{.kind = "window", .rule = rule, .y_label = "speed (km/h)"};
    plot.spans = {{"window", "window", 31.0, 34.0}};
    Curve other{"forward filter", "dashed", "purple"}, smoothed{"smoothed ± 2", "line", "blue"},
        counts{"speed that counts", "outline", "black"};
    other.add(1.0, 2.0);
    smoothed.add(30.5, 200.5);
    smoothed.interrupt();
    smoothed.add(31.5, 201.5);
    counts.add(31.0, 201.0);
    plot.curves = {other, smoothed, counts};
    return plot;
}

TEST(DaySummary, TakesTheSmoothedSpeedAroundTheWindowOfEachRule) {
    Json report = good_report();
    Plot no_speed = window_plot("c");
    no_speed.curves.pop_back();
    report["predicate"]["figures"] =
        Json::array({{{"figure", "place"}, {"curves", Json::array()}}});
    for (const Plot& plot : {window_plot("a"), window_plot("b"), window_plot("a"), no_speed})
        report["predicate"]["figures"].push_back(plot_json(plot));
    const auto curves = read_report_identity(report.dump(), "report.json").curves;
    ASSERT_EQ(curves.size(), 2U);
    EXPECT_EQ(curves[0].profile, "a");
    EXPECT_EQ(curves[1].profile, "b");
    EXPECT_EQ(curves[0].duration_s, 3.0);
    EXPECT_EQ(curves[0].speed.x, (std::vector<double>{-0.5, 0.5, 0.5}));
    EXPECT_EQ(curves[0].speed.y[0], 200.5);
    EXPECT_TRUE(std::isnan(curves[0].speed.y[1]));
}

TEST(DaySummary, TakesIdAndCraftFromTheReport) {
    const ReportIdentity report = read_report_identity(good_report().dump(), "report.json");
    EXPECT_EQ(report.report_id, "0123");
    EXPECT_EQ(report.attempt, "run-1");
    EXPECT_EQ(report.craft_name, "Ice Bird");
    EXPECT_EQ(report.craft_class, "ice-yacht");
    EXPECT_EQ(report.verdict_sha256, hash);
    for (const char* text : {"", "{}", "[1]", R"({"predicate": 1})", R"({"subject": []})"})
        EXPECT_THROW((void)read_report_identity(text, "report.json"), Failure) << text;
}

TEST(DaySummary, RefusesAVerdictOrReportOfAnotherAttempt) {
    const GivenAttempt attempt{.id = "run-1", .source = "day.yaml:3"};
    const AttemptOutcome outcome{.state = "done"};
    const DayOutcome of{attempt, outcome};
    Verdict verdict;
    verdict.attempt = "run-1";
    const ReportIdentity report = read_report_identity(good_report().dump(), "report.json");
    EXPECT_EQ(summary_of(of, verdict, hash, report).id, "run-1");
    EXPECT_THROW((void)summary_of(of, verdict, std::string(64, 'b'), report), Failure);
    ReportIdentity other = report;
    other.attempt = "run-2";
    EXPECT_THROW((void)summary_of(of, verdict, hash, other), Failure);
    verdict.attempt = "run-2";
    EXPECT_THROW((void)summary_of(of, verdict, hash, report), Failure);
}

TEST(DaySummary, SaysWhyAnAttemptIsNotDone) {
    const GivenAttempt attempt{.id = "run-1", .source = "day.yaml:3"};
    const AttemptOutcome failed{
        .state = "failed",
        .failure = RunFailure{.step = "import", .problem = "p", .where = "w", .remedy = "r"}};
    EXPECT_EQ(summary_of({attempt, failed}).failure->step, "import");
    const AttemptOutcome left{.reason = "left out by --only"};
    EXPECT_EQ(summary_of({attempt, left}).reason, "left out by --only");
    EXPECT_EQ(summary_of({attempt, left}).state, "not_processed");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
