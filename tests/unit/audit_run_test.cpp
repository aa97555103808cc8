#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "reports/audit/record.h"
#include "reports/audit/sections.h"
#include "reports/document/document_text.h"

namespace runcert::RUNCERT_FILE {
namespace {

const std::string hash_a(64, 'a');
const std::string hash_b(64, 'b');

/// A run of which import alone is there, made of one recording with a record that is cut short.
RunRecord record_of(const std::string& parameters = {}) {
    RunRecord record;
    record.attempt = read_attempt(
        "schema: attempt/1.0\nid: small\ncraft: {name: yacht, class: land-yacht}\n"
        "receivers: [{id: primary, recording: a.pos}]\nprofiles: [nalsa]\n" +
            parameters,
        "attempt.yaml");
    ReceiverResults& one = record.receivers.emplace_back();
    one.receiver = record.attempt.receivers.front();
    one.files = {{"observations", "1-observations.ecsv"},
                 {"enu", "2-enu.ecsv"},
                 {"screened", "3-screened.ecsv"},
                 {"trajectory", "4-trajectory.ecsv"},
                 {"windows", "5-windows.yaml"}};
    Observations& observations = one.observations;
    observations.header.stage = "import";
    observations.header.program_version = "1.0.0";
    observations.header.source_revision = "abc";
    observations.header.inputs = {{"recording", "recording.primary.pos", hash_a, 1234, "a.pos"}};
    observations.header.parameters = nlohmann::ordered_json::object();
    observations.format = "rtklib-pos";
    observations.frame = "geodetic";
    observations.time_scale = "gps";
    observations.accuracy_source = "recording";
    observations.records = {
        .total = 3, .bad = 1, .bad_records = {{.line = 7, .byte = 400, .epoch = 2, .what = "cut"}}};
    observations.rows.resize(2);
    record.files = {{"observations", "1-observations.ecsv", hash_b, 99, ""},
                    {"recording", "recording.primary.pos", hash_a, 1234, ""}};
    record.named_by["recording.primary.pos"] = {"1-observations.ecsv"};
    return record;
}

std::string text_of(const RunRecord& record, const WalkOptions& options = {}) {
    return std::regex_replace(document_text(walk_through(record, options), 80),
                              std::regex("\n {2,}"), " ");
}

void expect_in(const std::string& text, const std::vector<std::string>& all) {
    for (const std::string& said : all)
        EXPECT_NE(text.find(said), std::string::npos) << said << "\n" << text;
}

TEST(WalkThrough, WhatIsThereIsShownAndWhatIsNotIsNamed) {
    const std::string text = text_of(record_of());
    expect_in(text,
              {"Audit of the attempt small", "“yacht”, class land-yacht",
               "recording  recording.primary.pos  1,234  aaaaaaaaaaaa  yes handed in as a.pos",
               "1-observations.ecsv: 2 epochs, 99 bytes", "0 epochs\n",
               "by no file of the folder: nothing shows that it was not changed",
               "line 7 (at epoch 2): cut", "1 of 3 could not be read",
               "rtklib-pos, recognised by the recording's content",
               "MISSING from the folder: 2-enu.ecsv (enu)", "2-enu.ecsv is MISSING",
               "6-verdict.yaml is MISSING", "report.json is not in the folder",
               "All of them were made by the same program."});
    EXPECT_EQ(text.find(hash_a), std::string::npos);
    EXPECT_NE(text_of(record_of(), {.all = true}).find(hash_a), std::string::npos);
}

TEST(WalkThrough, TheStagesAskedForAndNoOthers) {
    const Document walk = walk_through(record_of(), {.stages = {"enu", "import"}});
    ASSERT_EQ(walk.sections.size(), 2U);
    EXPECT_EQ(walk.sections[0].title, "1. import, receiver primary");
    EXPECT_EQ(walk.sections[1].title, "2. enu, receiver primary");
    EXPECT_TRUE(
        walk_through(record_of(), {.stages = {"enu"}, .receiver = "other"}).sections.empty());
    EXPECT_EQ(walk_through(record_of(), {}).sections.size(), 7U);
}

TEST(WalkThrough, AFileThatIsNotThereAndAnotherProgramAreSaid) {
    RunRecord record = record_of();
    record.files.pop_back();  // the recording
    record.report.emplace();
    record.report->program_version = "2.0.0";
    record.report_id = "0123456789abcdef";
    const std::string text = text_of(record);
    expect_in(text, {"aaaaaaaaaaaa  NO", "made by 2 DIFFERENT versions", "id 0123456789abcdef",
                     "UNSIGNED"});
    record.signatures = {"report.json.minisig"};
    expect_in(text_of(record), {"report.json.minisig: whether they hold, `runcert verify` says"});
}

TEST(WalkThrough, ParametersAgainstTheDefaultsOfTheClass) {
    RunRecord record = record_of("parameters: {smooth: {robust_scale: 3}}\n");
    TrajectoryTable& table = record.receivers.front().trajectory;
    table.header.stage = "smooth";
    table.header.parameters = parameters_of(record.attempt, "smooth");
    record.files.push_back({"trajectory", "4-trajectory.ecsv", hash_b, 1, ""});
    const WalkOptions smooth{.stages = {"smooth"}};
    // The defaults are those of schemas/attempt/v1.yaml.
    std::string text = text_of(record, smooth);
    expect_in(text,
              {"Parameters, 1 of 7 not the default of the class land-yacht",
               "smooth.robust_scale  3     2              the attempt Scale of the Cauchy loss "
               "of the robust solution, in standard deviations.\n"});
    EXPECT_EQ(text.find("smooth.jerk_density"), std::string::npos) << text;
    expect_in(text_of(record, {.stages = {"smooth"}, .all = true}),
              {"smooth.jerk_density              0.6     0.6      m s-2.5  default"});
    // A file whose figure nobody asked for.
    table.header.parameters["jerk_density"] = 0.9;
    text = text_of(record, smooth);
    expect_in(text, {"2 of 7 not the default", "NOT THE ATTEMPT"});
}

TEST(WalkThrough, NoMoreThanTwentyRecordsLeftOutUnlessAll) {
    RunRecord record = record_of();
    RecordCount& records = record.receivers.front().observations.records;
    records.total = 5000;
    records.bad = 2000;
    records.bad_records.clear();
    for (std::int64_t i = 1; i <= 1000; ++i)
        records.bad_records.push_back({.line = i, .byte = i, .epoch = 0, .what = "cut"});
    const auto listed = [&](bool all) {
        const std::string text = text_of(record, {.stages = {"import"}, .all = all});
        std::ptrdiff_t count = 0;
        for (std::size_t at = text.find("(before the first epoch): cut"); at != std::string::npos;
             at = text.find("(before the first epoch): cut", at + 1))
            ++count;
        return count;
    };
    EXPECT_EQ(listed(false), 20);
    EXPECT_EQ(listed(true), 1000);
}

/// A verdict of the rule nalsa, whose sentences end as they like.
ProfileVerdict verdict_in(const std::string& unit) {
    ProfileVerdict verdict;
    verdict.profile = "nalsa";
    verdict.outcome = Outcome::not_proven;
    verdict.reason = "The uncertainty leaves it open.";
    verdict.speed_m_s = 60.00562;
    verdict.expanded_uncertainty_m_s = 0.0972;
    verdict.required_speed_m_s = 60.01;
    verdict.coverage_factor = 2.0;
    verdict.shown = shown_in(
        {.speed_m_s = 60.00562, .expanded_uncertainty_m_s = 0.0972, .required_speed_m_s = 60.01},
        speed_unit(unit), unit == "km/h" ? std::optional(1) : std::nullopt);
    verdict.requirements = {
        {.clause = "flat",
         .status = RequirementStatus::not_met,
         .evidence = "the course rises by 3 m.",
         .text = "The course is flat.",
         .source = "rules of the body.",
         .figures = {{.name = "rise", .value = 3.0, .unit = "m", .note = "up."}}}};
    verdict.indicated =
        RefusedWindow{.span = {}, .speed_m_s = 61.25, .refusals = {"it holds a step."}};
    return verdict;
}

RunRecord record_with(const ProfileVerdict& verdict) {
    RunRecord record = record_of("record: {speed: 216, unit: kn, source: board}\n");
    record.profiles = {read_profile(builtin_profile("nalsa"), "nalsa.yaml")};
    record.verdict.profiles = {verdict};
    record.verdict.header.stage = "check";
    record.verdict.header.parameters = nlohmann::ordered_json::object();
    record.files.push_back({"verdict", "6-verdict.yaml", hash_b, 1, ""});
    return record;
}

TEST(WalkThrough, AVerdictHasItsSpeedsInEveryUnitAndNoSentenceTwoStops) {
    const Document walk = walk_through(record_with(verdict_in("km/h")), {.stages = {"check"}});
    const std::string text = document_text(walk, 1000);
    expect_in(
        text,
        {"\n                               km/h    m/s      kn     mph\n"
         "Measured speed                216.0  60.00  116.64  134.22\n",
         "\nRequired speed                216.1  60.01  116.66  134.24\n",
         "The raw positions show 220.5 km/h in this window. It is not certified:\n- it holds a "
         "step.",
         "\nNOT MET  flat    window_complete\n    The course is flat.\n    The course rises by "
         "3 m.\n    rise: 3 m; up.\n    Quoted from the rule: rules of the body.\n"});
    EXPECT_EQ(text.find(".."), std::string::npos) << text;
}

TEST(WalkThrough, WithoutTheTextOfItsRuleAVerdictIsNotShown) {
    RunRecord record = record_with(verdict_in("km/h"));
    record.profiles.clear();
    const std::string text = text_of(record, {.stages = {"check"}});
    expect_in(text, {"The text of the rule nalsa is MISSING from the folder"});
    EXPECT_EQ(text.find("Measured speed"), std::string::npos) << text;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
