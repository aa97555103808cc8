#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

TEST(ReportJson, IsTheSameTwice) {
    EXPECT_EQ(write_report_json(sample::make_run().inputs),
              write_report_json(sample::make_run().inputs));
}

TEST(ReportJson, IsAStatementOverEveryFile) {
    const sample::Run run = sample::make_run();
    const Json report = report_json(run.inputs);
    EXPECT_EQ(report["_type"], "https://in-toto.io/Statement/v1");
    EXPECT_EQ(report["predicateType"], "urn:runcert:measurement-report:1.0");
    ASSERT_EQ(report["subject"].size(), run.inputs.subjects.size());
    for (std::size_t i = 0; i < run.inputs.subjects.size(); ++i) {
        const ReportSubject& subject = run.inputs.subjects[i];
        EXPECT_EQ(report["subject"][i]["name"], subject.file);
        EXPECT_EQ(report["subject"][i]["digest"]["sha256"],
                  digest_of(run.files.at(subject.file)).sha256);
    }
}

TEST(ReportJson, TheIdNamesTheFiles) {
    sample::Run run = sample::make_run();
    const std::string id = report_id(run.inputs.subjects);
    EXPECT_EQ(id.size(), 16U);
    EXPECT_EQ(report_json(run.inputs)["predicate"]["report_id"], id);
    run.inputs.subjects.back().sha256[0] ^= 1;
    EXPECT_NE(report_id(run.inputs.subjects), id);
    // printf 'HASH  NAME\n' | sha256sum
    EXPECT_EQ(report_id({{"", "a", std::string(64, '0'), 0, ""}}),
              sha256_hex(std::string(64, '0') + "  a\n").substr(0, 16));
}

TEST(ReportJson, HoldsTheFullFiguresBesideTheShownOnes) {
    const Json predicate = report_json(sample::make_run().inputs)["predicate"];
    const Json& nalsa = predicate["profiles"][0];
    EXPECT_EQ(nalsa["speed_m_s"], 60.002417);
    EXPECT_EQ(nalsa["expanded_uncertainty_m_s"], 0.005102);
    EXPECT_EQ(nalsa["standard_uncertainty_m_s"], 0.002551);
    EXPECT_EQ(nalsa["lower_limit_m_s"], 59.997315);
    EXPECT_EQ(nalsa["required_speed_km_h"], 204.5093);
    EXPECT_EQ(nalsa["headline"]["headline_speed"], "216.00");
    EXPECT_EQ(nalsa["headline"]["headline_uncertainty"], "0.019");
    EXPECT_EQ(nalsa["window"]["definitions"].size(), 4U);
    EXPECT_EQ(nalsa["window"]["methods"].size(), 4U);  // v2 has no value
    EXPECT_EQ(nalsa["window"]["end_utc"], "2022-03-18T08:51:47.500Z");
}

TEST(ReportJson, SaysWhichParametersTheAttemptSet) {
    const Json predicate = report_json(sample::make_run().inputs)["predicate"];
    std::vector<std::string> set_by_attempt;
    for (const Json& stage : predicate["method"]["stages"])
        for (const Json& parameter : stage["parameters"])
            if (parameter["set_by_attempt"].get<bool>()) {
                set_by_attempt.push_back(parameter["parameter"]);
                EXPECT_EQ(parameter.value("value_unit", ""),
                          set_by_attempt.back() == "smooth.jerk_density" ? "m s-2.5" : "");
            }
    // What import has is what the attempt states of the receiver.
    EXPECT_EQ(set_by_attempt, (std::vector<std::string>{"import.format", "smooth.jerk_density"}));
}

TEST(ReportJson, WithoutAWindowThereIsNoSpeed) {
    const Json predicate = report_json(sample::make_run({.certified = false}).inputs)["predicate"];
    for (const Json& profile : predicate["profiles"]) {
        EXPECT_EQ(profile["outcome_title"], "Not certifiable under altered rules");
        EXPECT_EQ(profile["tone"], "refused");
        for (const char* absent : {"speed_km_h", "headline", "window", "lower_limit_m_s"})
            EXPECT_FALSE(profile.contains(absent)) << absent;
        EXPECT_TRUE(profile.contains("indicated"));
    }
    EXPECT_EQ(predicate["figures"].size(), 5U);
}

TEST(ReportJson, NothingIsDrawnWhereNothingWasEstimated) {
    sample::Run run = sample::make_run({.certified = false});
    for (TrajectoryEpoch& row : run.inputs.receivers[0].trajectory.rows)
        row.arc.reset();
    EXPECT_TRUE(report_json(run.inputs)["predicate"]["figures"].empty());
}

// [DHD22] figure 11: a curve for each length, whose first point stands at the end of that.
// that.
TEST(ReportJson, TheSpeedOverEachRulesLengthIsDrawn) {
    sample::Run run = sample::make_run();
    const Json drawn = report_json(run.inputs)["predicate"]["figures"][2];
    EXPECT_EQ(drawn["figure"], "average");
    ASSERT_EQ(drawn["curves"].size(), 2U);  // 3 s and 2 s
    EXPECT_EQ(drawn["curves"][0]["curve_name"], "speed over 3 s");
    const TrajectoryTable& table = run.inputs.receivers[0].trajectory;
    EXPECT_EQ(drawn["curves"][0]["x"].size() + 30, table.rows.size());
    double sum = 0.0;
    for (std::size_t k = 0; k <= 30; ++k)
        sum += *table.rows[k].speed_m_s;
    EXPECT_NEAR(drawn["curves"][0]["y"][0].get<double>(), 3.6 * sum / 31.0, 1e-3);
    EXPECT_EQ(drawn["levels"].size(), 2U);
    EXPECT_EQ(drawn["spans"].size(), 2U);
    for (Profile& profile : run.inputs.profiles)
        profile.window_kind = WindowKind::course;
    for (const Json& figure : report_json(run.inputs)["predicate"]["figures"])
        EXPECT_NE(figure["figure"], "average");
}

TEST(ReportJson, LongRunsAreThinned) {
    const auto run = sample::make_run({.epochs = 28200, .interval_s = 0.05});
    const Json figures = report_json(run.inputs)["predicate"]["figures"];
    for (const Json& figure : figures)
        for (const Json& curve : figure["curves"]) {
            EXPECT_LE(curve["x"].size(), 1100U) << figure["figure"];
            EXPECT_EQ(curve["x"].size(), curve["y"].size());
        }
    const Json& speed = figures[3];
    EXPECT_EQ(speed["figure"], "speed");
    EXPECT_NE(speed["caption"].get<std::string>().find("One epoch in 29"), std::string::npos);
}

TEST(ReportJson, TwoReceiversStandBesideEachOther) {
    const Json predicate =
        report_json(sample::make_run({.second_receiver = true}).inputs)["predicate"];
    EXPECT_EQ(predicate["receivers"].size(), 2U);
    EXPECT_EQ(predicate["profiles"][0]["by_receiver"].size(), 2U);
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
          R"([{"op":"replace","path":"/predicate/frame/georeferenced",
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
