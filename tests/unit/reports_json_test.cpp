#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports_page_support.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

/// The first figure of that kind.
Json figure_of(const Json& report, std::string_view kind) {
    for (const Json& figure : report["predicate"]["figures"])
        if (figure["figure"] == kind) return figure;
    return Json{{"figure", "none"}, {"curves", Json::array()}, {"caption", ""}};
}

TEST(ReportJson, IsTheSameTwice) {
    EXPECT_EQ(write_report_json(sample::make_run().inputs),
              write_report_json(sample::make_run().inputs));
}

TEST(ReportJson, IsAStatementOverEveryFile) {
    const sample::Run run = sample::make_run();
    const Json report = report_json(run.inputs);
    EXPECT_EQ(report["_type"], "https://in-toto.io/Statement/v1");
    EXPECT_EQ(report["predicateType"], "urn:runcert:measurement-report:1.0");
    ASSERT_EQ(report["subject"].size(), run.inputs.files.size());
    for (std::size_t i = 0; i < run.inputs.files.size(); ++i) {
        const InputFile& subject = run.inputs.files[i];
        EXPECT_EQ(report["subject"][i]["name"], subject.file);
        EXPECT_EQ(report["subject"][i]["digest"]["sha256"],
                  digest_of(run.files.at(subject.file)).sha256);
    }
}

TEST(ReportJson, TheIdNamesTheFiles) {
    sample::Run run = sample::make_run();
    const std::string id = report_id(run.inputs.files);
    EXPECT_EQ(id.size(), 16U);
    EXPECT_EQ(report_json(run.inputs)["predicate"]["report_id"], id);
    run.inputs.files.back().sha256[0] ^= 1;
    EXPECT_NE(report_id(run.inputs.files), id);
    // printf 'HASH  NAME\n' | sha256sum
    EXPECT_EQ(report_id({{"", "a", std::string(64, '0'), 0, ""}}),
              sha256_hex(std::string(64, '0') + "  a\n").substr(0, 16));
}

TEST(ReportJson, HoldsTheFullFiguresBesideTheShownOnes) {
    const Json report = report_json(sample::make_run().inputs);
    const Json& nalsa = report["predicate"]["verdict"]["profiles"][0];
    EXPECT_EQ(nalsa["speed_m_s"], 60.002417);
    EXPECT_EQ(nalsa["expanded_uncertainty_m_s"], 0.005102);
    EXPECT_EQ(nalsa["required_speed_km_h"], 204.5093);
    const Place window{.section = "window", .rule = "nalsa"};
    EXPECT_EQ(cell_at(report, window, "Measured speed", "km/h"), "216.00");
    EXPECT_EQ(cell_at(report, window, "Expanded uncertainty (k = 2)", "km/h"), "0.02");
    // 56.8201 and 56.808151 m/s, rounded up.
    EXPECT_EQ(cell_at(report, window, "Acceptance limit", "km/h"), "204.56");
    EXPECT_EQ(cell_at(report, window, "Required speed", "km/h"), "204.51");
    EXPECT_EQ(fact_at(report, window, "UTC"), "2022-03-18 08:51:44.500 to 2022-03-18 08:51:47.500");
}

TEST(ReportJson, SaysWhichParametersTheAttemptSet) {
    const Json report = report_json(sample::make_run().inputs);
    std::map<std::string, std::string> used;
    for (const Json& block : blocks_at(report, {"method"}))
        for (const Json& row : block.value("rows", Json::array())) {
            if (row["cells"][4] != "the attempt") continue;
            EXPECT_EQ(row["mark"], "changed");
            used[row["cells"][0]] = row["cells"][1];
        }
    EXPECT_EQ(used, (std::map<std::string, std::string>{{"smooth.jerk_density", "0.9"}}));
    EXPECT_NE(sentences_at(report, {"method"}).find("All others have the default of the class"),
              std::string::npos);
}

TEST(ReportJson, WithoutAWindowThereIsNoSpeed) {
    const Json report = report_json(sample::make_run({.certified = false}).inputs);
    for (const Json& profile : report["predicate"]["verdict"]["profiles"]) {
        EXPECT_EQ(profile["outcome"], "not_certifiable");
        for (const char* absent : {"speed_m_s", "speed_km_h", "expanded_uncertainty_m_s", "window"})
            EXPECT_FALSE(profile.contains(absent)) << absent;
        EXPECT_TRUE(profile.contains("indicated"));
    }
    for (const Json& section : report["predicate"]["document"]["sections"])
        for (const Json& block : section["blocks"])
            EXPECT_NE(block["kind"], "headline") << section["anchor"];
    for (const char* rule : {"nalsa", "fisly"}) {
        EXPECT_EQ(slot_at(report, std::string("outcome/") + rule)["text"],
                  std::string(rule) + ": Not certifiable under altered rules");
        EXPECT_EQ(row_names(report, {"window", "Result", rule}), std::vector<std::string>());
    }
    EXPECT_EQ(report["predicate"]["figures"].size(), 6U);
}

TEST(ReportJson, OfWhatWasNotEstimatedTheTestsAloneAreDrawn) {
    sample::Run run = sample::make_run({.certified = false});
    for (TrajectoryEpoch& row : run.inputs.receivers[0].trajectory.rows)
        row.arc.reset();
    const Json figures = report_json(run.inputs)["predicate"]["figures"];
    ASSERT_EQ(figures.size(), 1U);
    EXPECT_EQ(figures[0]["figure"], "innovations");
}

// [DHD22] figure 11: a curve for each length, whose first point stands at the end of that.
// that.
TEST(ReportJson, TheSpeedOverEachRulesLengthIsDrawn) {
    sample::Run run = sample::make_run();
    const Json drawn = figure_of(report_json(run.inputs), "average");
    ASSERT_EQ(drawn["curves"].size(), 2U);  // 3 s and 2 s
    EXPECT_EQ(drawn["curves"][0]["curve_name"], "speed over 3 s");
    const TrajectoryTable& table = run.inputs.receivers[0].trajectory;
    EXPECT_EQ(drawn["curves"][0]["x"].size() + 30, table.rows.size());
    double sum = 0.0;
    for (std::size_t k = 0; k <= 30; ++k)
        sum += *table.rows[k].speed_m_s;
    EXPECT_NEAR(drawn["curves"][0]["y"][0].get<double>(), 3.6 * sum / 31.0, 1e-3);
    EXPECT_EQ(drawn["levels"].size(), 2U);
    EXPECT_EQ(
        std::ranges::count(drawn["spans"], "window",
                           [](const Json& span) { return span["span_kind"].get<std::string>(); }),
        2);
    for (Profile& profile : run.inputs.profiles)
        profile.window_kind = WindowKind::course;
    const Json course = report_json(run.inputs);
    for (const Json& figure : course["predicate"]["figures"])
        EXPECT_NE(figure["figure"], "average");
}

// Written again, a speed in miles per hour can come out other by its last digit: it was rounded
// from more digits than the metres per second have.
TEST(ReportJson, HoldsTheVerdictAsItsFileHasIt) {
    sample::Run run = sample::make_run();
    run.inputs.verdict_text = write_verdict(run.inputs.verdict);
    const std::string key = "speed_mph: ";
    const std::size_t digit =
        run.inputs.verdict_text.find('\n', run.inputs.verdict_text.find(key)) - 1;
    char& last = run.inputs.verdict_text.at(digit);
    last = last == '5' ? '6' : '5';
    const Json verdict = report_json(run.inputs)["predicate"]["verdict"];
    const double speed = verdict["profiles"][0]["speed_mph"];
    EXPECT_EQ(fmt::format("{:.4f}", speed).back(), last);
}

TEST(ReportJson, LongRunsAreThinned) {
    const auto run = sample::make_run({.epochs = 28200, .interval_s = 0.05});
    const Json figures = report_json(run.inputs)["predicate"]["figures"];
    for (const Json& figure : figures)
        for (const Json& curve : figure["curves"]) {
            EXPECT_LE(curve["x"].size(), 1100U) << figure["figure"];
            EXPECT_EQ(curve["x"].size(), curve["y"].size());
        }
    const Json speed = figure_of(report_json(run.inputs), "speed");
    EXPECT_NE(speed["caption"].get<std::string>().find("One epoch in 29"), std::string::npos);
}

TEST(ReportJson, TwoReceiversStandBesideEachOther) {
    const Json report = report_json(sample::make_run({.second_receiver = true}).inputs);
    const Place beside{"window", "By each receiver", "nalsa"};
    for (const char* receiver : {"primary", "secondary"})
        EXPECT_EQ(fact_at(report, beside, receiver),
                  "216.008 km/h ± 0.019 km/h, 40.200 s after its first epoch");
}

TEST(ReportJson, HoldsNoPathOfTheAttempt) {
    const std::string text = write_report_json(sample::make_run().inputs);
    EXPECT_EQ(text.find("data/rover.pos"), std::string::npos);
    EXPECT_NE(text.find("rover.pos"), std::string::npos);
}

TEST(ReportJson, IsReadBack) {
    const Json report = report_json(sample::make_run().inputs);
    EXPECT_EQ(parse_report(report_text_of(report), "report.json"), report);
}

TEST(ReportJson, WhatIsNotAReportIsRefused) {
    for (const char* text : {"", "[]", "{}", "not JSON", R"({"predicateType": 3, "predicate": {}})",
                             R"({"predicateType": "urn:other", "predicate": {}})"})
        EXPECT_THROW(parse_report(text, "report.json"), Failure) << text;
}

TEST(ReportJson, APredicateThatDeviatesFromItsFieldTableIsRefused) {
    const Json report = report_json(sample::make_run().inputs);
    for (const char* change :
         {R"([{"op":"add","path":"/predicate/extra","value":1}])",
          R"([{"op":"remove","path":"/predicate/report_id"}])",
          R"([{"op":"replace","path":"/predicate/schema/version","value":"2.0"}])",
          R"([{"op":"replace","path":"/predicate/verdict/georeferenced",
                                    "value":"yes"}])"})
        EXPECT_THROW(parse_report(report.patch(Json::parse(change)).dump(), "report.json"), Failure)
            << change;
}

TEST(ReportJson, PartsOfDifferentRunsAreRefused) {
    sample::Run run = sample::make_run();
    run.inputs.verdict.attempt = "another";
    EXPECT_THROW(report_json(run.inputs), Failure);
    run = sample::make_run();
    std::swap(run.inputs.profiles[0], run.inputs.profiles[1]);
    EXPECT_THROW(report_json(run.inputs), Failure);
    run = sample::make_run();
    run.inputs.receivers.clear();
    EXPECT_THROW(report_json(run.inputs), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
