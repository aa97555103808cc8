#include "reports/day/day_list.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

const std::string hash(64, 'a');

Json file(const std::string& name) {
    return {{"file", name}, {"sha256", hash}, {"bytes", 12}};
}

Json done(const std::string& id) {
    return {{"id", id},
            {"source", "day.yaml:3"},
            {"state", "done"},
            {"verdict", file(id + "/6-verdict.yaml")},
            {"report", file(id + "/report.json")},
            {"pages", {id + "/report.html"}},
            {"notes", {"a note"}}};
}

Json good_list() {
    return {{"day", "lake-day"},
            {"attempts",
             {done("run-1"),
              {{"id", "two words; \"quoted\""},
               {"source", "b.yaml"},
               {"state", "failed"},
               {"step", "import"},
               {"problem", "what"},
               {"where", ""},
               {"remedy", "do this"}},
              {{"id", "run-3"},
               {"source", "c.yaml"},
               {"state", "not_processed"},
               {"reason", "left out by --only"}}}},
            {"notes", {"one"}}};
}

TEST(DayList, IsReadAsItWasWritten) {
    const DayList list = read_day_list(good_list().dump(), "list.json");
    EXPECT_EQ(list.day, "lake-day");
    EXPECT_EQ(list.notes, std::vector<std::string>{"one"});
    ASSERT_EQ(list.attempts.size(), 3U);
    EXPECT_EQ(list.attempts[0].verdict->file, "run-1/6-verdict.yaml");
    EXPECT_EQ(list.attempts[0].verdict->sha256, hash);
    EXPECT_EQ(list.attempts[0].report->bytes, 12);
    EXPECT_EQ(list.attempts[0].pages, std::vector<std::string>{"run-1/report.html"});
    EXPECT_EQ(list.attempts[0].notes, std::vector<std::string>{"a note"});
    EXPECT_EQ(list.attempts[1].step, "import");
    EXPECT_EQ(list.attempts[1].where, "");
    EXPECT_EQ(list.attempts[1].remedy, "do this");
    EXPECT_EQ(list.attempts[2].reason, "left out by --only");
}

/// Expects a Failure that names `part`.
void expect_refused(const std::string& text, const std::string& part) {
    try {
        (void)read_day_list(text, "list.json");
        ADD_FAILURE() << text;
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), "list.json");
        EXPECT_NE(failure.problem().find(part), std::string::npos) << failure.problem();
        EXPECT_FALSE(failure.remedy().empty());
    }
}

TEST(DayList, WhatIsWrongIsNamedByItsPlace) {
    expect_refused("{", "is not JSON");
    expect_refused("[]", "not a map");
    const auto changed = [](const std::string& pointer, const Json& value) {
        Json list = good_list();
        list[Json::json_pointer(pointer)] = value;
        return list.dump();
    };
    expect_refused(changed("/days", 1), "days");
    expect_refused(changed("/day", ""), "day: is empty");
    expect_refused(changed("/attempts", 1), "attempts: is a single value, not a list");
    expect_refused(changed("/attempts/0/state", "well"),
                   "attempts[0].state: \"well\" is not one of");
    expect_refused(changed("/attempts/0/id", "../x"), "attempts[0].id: has other characters");
    expect_refused(changed("/attempts/0/verdict/sha256", "AA"), "attempts[0].verdict.sha256");
    expect_refused(changed("/attempts/0/report/bytes", -1), "attempts[0].report.bytes");
    expect_refused(changed("/attempts/0/notes", "x"), "attempts[0].notes: is a single value");
    for (const char* outside : {"../6-verdict.yaml", "/etc/passwd", "run-1/../../x", ".."})
        expect_refused(changed("/attempts/0/verdict/file", outside), "not within the day's folder");
    expect_refused(changed("/attempts/0/pages", {"/a.html"}), "attempts[0].pages[0]");
    Json incomplete = good_list();
    incomplete["attempts"][0].erase("report");
    expect_refused(incomplete.dump(), "attempts[0]: has no \"report\"");
    Json without_step = good_list();
    without_step["attempts"][1].erase("step");
    expect_refused(without_step.dump(), "attempts[1]: has no \"step\"");
    Json twice = good_list();
    twice["attempts"].push_back(done("run-1"));
    expect_refused(twice.dump(), "attempts[3].id: is that of another attempt");
}

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
    const DayList list = read_day_list(good_list().dump(), "list.json");
    const ListedAttempt& listed = list.attempts[0];
    Verdict verdict;
    verdict.attempt = "run-1";
    const ReportIdentity report = read_report_identity(good_report().dump(), "report.json");
    EXPECT_EQ(summary_of(listed, verdict, report).id, "run-1");
    ReportIdentity other = report;
    other.verdict_sha256 = std::string(64, 'b');
    EXPECT_THROW((void)summary_of(listed, verdict, other), Failure);
    other = report;
    other.attempt = "run-2";
    EXPECT_THROW((void)summary_of(listed, verdict, other), Failure);
    verdict.attempt = "run-2";
    EXPECT_THROW((void)summary_of(listed, verdict, report), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
