#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "chain_support.h"
#include "core/prose.h"
#include "schemas/screened/screened.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The epochs that the entries of an audit are about.
struct Listed {
    std::multiset<std::int64_t> left_out;
    std::multiset<std::int64_t> used;
    std::multiset<std::int64_t> breaks;
};

/// The text with each entry on one line, however long.
std::string unwrapped(const std::string& text) {
    return std::regex_replace(text, std::regex("\n +"), " ");
}

Listed listed_in(const std::string& text) {
    Listed listed;
    std::istringstream lines(unwrapped(text));
    const std::regex entry(
        R"(- (before epoch|epochs?) (\d+)(?: to (\d+))? \(lines? \d+.*?\), .*? s: (left out|used)?.*)");
    for (std::string line; std::getline(lines, line);) {
        std::smatch found;
        if (!std::regex_match(line, found, entry)) continue;
        const std::int64_t first = std::stoll(found[2]);
        const std::int64_t last = found[3].matched ? std::stoll(found[3]) : first;
        for (std::int64_t epoch = first; epoch <= last; ++epoch)
            (found[1] == "before epoch" ? listed.breaks
             : found[4] == "left out"   ? listed.left_out
                                        : listed.used)
                .insert(epoch);
    }
    return listed;
}

/// Audits a run, and holds what is listed against the table.
std::string expect_complete_audit(const fs::path& run) {
    const auto before = contents_of(run);
    const ProcessResult brief = runcert({"audit", run.string()});
    const ProcessResult full = runcert({"audit", run.string(), "--all"});
    EXPECT_EQ(brief.exit_status, 0) << brief.errors;
    EXPECT_EQ(full.exit_status, 0) << full.errors;
    EXPECT_EQ(contents_of(run), before);  // it writes nothing
    EXPECT_EQ(runcert({"audit", run.string()}).output, brief.output);
    const ScreenedTable table = read_screened(read_file(run / "3-screened.ecsv"), "3-screened");
    Listed expected;
    for (const ScreenedEpoch& row : table.rows) {
        (row.usable ? expected.used : expected.left_out).insert(row.epoch);
        if (row.break_before) expected.breaks.insert(row.epoch);
    }
    for (const std::string& text : {brief.output, full.output}) {
        const Listed listed = listed_in(text);
        EXPECT_EQ(listed.left_out, expected.left_out);
        EXPECT_EQ(listed.breaks, expected.breaks);
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);)
            EXPECT_LE(characters_in(line), 80U) << line;
    }
    EXPECT_TRUE(listed_in(brief.output).used.empty());
    EXPECT_EQ(listed_in(full.output).used, expected.used);
    return unwrapped(brief.output);
}

TEST(Audit, TheStepOfTheRejectedExampleIsListed) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    const std::string text = expect_complete_audit(run);
    // From 54 s on every position is 0.6 m too far along the track: a step, or at 62 m/s a jump of
    // the stamps by 9.7 ms.
    const std::string at_541 =
        R"(- before epoch 541 \(line \d+\), 54\.000 s: arc 2 begins 0\.100 s after epoch 540: )";
    const std::regex step(at_541 + R"(positions offset .*; error 0\.[56]\d\d m .*)");
    const std::regex shift(at_541 +
                           R"(time stamps shifted .*; error 0\.0(09|10)\d s .*; statistic .*)"
                           R"(along the track, about 0\.[56]\d m: .*)");
    std::istringstream entries(text);
    bool listed = false;
    for (std::string line; std::getline(entries, line);)
        listed = listed || std::regex_match(line, step) || std::regex_match(line, shift);
    EXPECT_TRUE(listed) << text;
    EXPECT_EQ(text.find("not checked"), std::string::npos) << text;
}

TEST(Audit, ARealRecording) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    write_file_atomically(
        folder.path() / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: recorded\ncraft: {{name: car, class: car}}\n"
                    "receivers: [{{id: primary, recording: \"{}\"}}]\nprofiles: [nalsa]\n",
                    bring(*data / "ppk_urban_car" / "rover.pos", folder.path())));
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(folder.path() / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    const std::string text = expect_complete_audit(run);
    EXPECT_NE(text.find(" of 5,395"), std::string::npos) << text;
    EXPECT_NE(text.find("ambiguities not fixed"), std::string::npos) << text;
}

TEST(Audit, WhatCannotBeAuditedIsRefused) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    const auto refused = [&](std::vector<std::string> arguments, const std::string& said) {
        arguments.insert(arguments.begin(), "audit");
        const ProcessResult result = runcert(arguments);
        EXPECT_EQ(result.exit_status, 2) << said;
        EXPECT_TRUE(result.output.empty()) << result.output;
        EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
        EXPECT_NE(result.errors.find("what to do: "), std::string::npos) << result.errors;
    };
    refused({(folder.path() / "absent").string()}, "no such run folder");
    EXPECT_FALSE(fs::exists(folder.path() / "absent"));
    refused({folder.path().string()}, "attempt.yaml");
    refused({run.string(), "--receiver", "third"}, "primary");

    refused({run.string(), "--stage", "screening"}, "import, enu, screen, smooth, window, check");

    // What was changed is refused.
    const std::string recording = read_file(run / "recording.primary.pos");
    write_file_atomically(run / "recording.primary.pos", recording + "\n");
    refused({run.string()}, "recording.primary.pos");
    write_file_atomically(run / "recording.primary.pos", recording);
    const std::string report = read_file(run / "report.json");
    write_file_atomically(run / "report.json", report.substr(0, report.size() / 2));
    refused({run.string()}, "report.json");
}

TEST(Audit, WhatIsMissingIsNamedAndTheRestIsShown) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    for (const char* name :
         {"4-trajectory.ecsv", "5-windows.yaml", "6-verdict.yaml", "report.json"})
        fs::remove(run / name);
    ProcessResult result = runcert({"audit", run.string(), "--receiver", "primary"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    const std::string text = unwrapped(result.output);
    for (const char* said :
         {"MISSING from the folder: 4-trajectory.ecsv (smooth), 5-windows.yaml (window), "
          "6-verdict.yaml (check) and report.json (report).",
          "4-trajectory.ecsv is MISSING", "6-verdict.yaml is MISSING",
          "these files name are not checked", "before epoch 541", "rtklib-pos"})
        EXPECT_NE(text.find(said), std::string::npos) << said << "\n" << text;
    fs::remove(run / "3-screened.ecsv");
    result = runcert({"audit", run.string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_NE(result.output.find("3-screened.ecsv is MISSING"), std::string::npos);
    for (const char* name : {"1-observations.ecsv", "2-enu.ecsv"})
        fs::remove(run / name);
    EXPECT_EQ(runcert({"audit", run.string()}).exit_status, 2);
}

TEST(Audit, EveryStageIsWalkedThroughAndTheRefusedWindowNamed) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    const std::string text = unwrapped(runcert({"audit", run.string(), "--all"}).output);
    const auto report = nlohmann::json::parse(read_file(run / "report.json"));
    std::vector<std::string> expected{
        "line 544", report["predicate"]["report_id"].get<std::string>(),
        "All of them were made by the same program",
        "It is not certified:\n- 1 step that the motion cannot explain"};
    // Every hash, as another program computes it.
    for (const auto& subject : report["subject"]) {
        const std::string file = subject["name"];
        const std::string sum =
            run_process({"sha256sum", (run / file).string()}).output.substr(0, 64);
        if (file != "attempt.yaml") expected.push_back(sum);
    }
    for (const auto& requirement : report["predicate"]["verdict"]["profiles"][0]["requirements"])
        expected.push_back(" " + requirement["clause"].get<std::string>() + " ");
    for (const char* stage : {"1. import", "2. enu", "3. screen", "4. smooth", "5. window"})
        expected.push_back(std::string(stage) + ", receiver primary");
    for (const std::string& said : expected)
        EXPECT_NE(text.find(said), std::string::npos) << said << "\n" << text;

    const std::string window = runcert({"audit", run.string(), "--stage", "window"}).output;
    EXPECT_NE(window.find("5. window"), std::string::npos);
    EXPECT_EQ(window.find("4. smooth"), std::string::npos);
    EXPECT_EQ(window.find("6. check"), std::string::npos);
    const std::string two =
        runcert({"audit", "--stage", "enu", "--stage", "check", run.string()}).output;
    EXPECT_NE(two.find("2. enu"), std::string::npos);
    EXPECT_NE(two.find("6. check"), std::string::npos);
    EXPECT_EQ(two.find("5. window"), std::string::npos);
}

/// An example's attempt with other text in it, and its recording beside it.
fs::path changed_example(const fs::path& folder, const std::string& example,
                         const std::map<std::string, std::string>& replaced) {
    std::string text = read_file(examples / example / "attempt.yaml");
    for (const auto& [from, to] : replaced) {
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
    }
    bring(examples / example / "recording.pos", folder);
    write_file_atomically(folder / "attempt.yaml", text);
    return folder / "attempt.yaml";
}

TEST(Audit, WhatTheAttemptReplacedIsNamedWithTheDefault) {
    const TemporaryFolder folder;
    const fs::path attempt = changed_example(
        folder.path(), "rejected",
        {{"profiles:",
          "rules:\n  - {profile: nalsa, figure: accuracy.limit, value: 0.75, reason: "
          "agreed before}\nparameters:\n  smooth: {robust_scale: 2.5}\nprofiles:"}});
    const fs::path run = folder.path() / "run";
    const ProcessResult certified = certify(attempt, run, {"--no-render"});
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const std::string text = unwrapped(runcert({"audit", run.string()}).output);
    for (const char* pattern : {"replaces smooth.robust_scale and nalsa accuracy.limit",
                                R"(1 of \d+ not the default of the class land-yacht)",
                                R"(\nsmooth.robust_scale +2.5 +2 +the attempt Scale of)",
                                R"(\naccuracy.limit +0.8 km/h +0.75 km/h +agreed before\n)"})
        EXPECT_TRUE(std::regex_search(text, std::regex(pattern))) << pattern << "\n" << text;
}

TEST(Audit, ThePageIsWellFormedAndShowsHostileTextAsText) {
    const TemporaryFolder folder;
    const std::string hostile = "<script>alert('1')</script> {{title}} & gnp";
    const fs::path attempt = changed_example(
        folder.path(), "rejected",
        {{"simulated land yacht", hostile},
         {"salt lake near Lake Gairdner, South Australia (simulated)", hostile},
         {"Horonuku, 11 December 2022, 2 s average, as reported by the press", hostile},
         {"- role: measurer", "- {role: measurer, name: \"" + hostile + "\"}"}});
    const fs::path run = folder.path() / "run";
    const ProcessResult certified = certify(attempt, run, {"--no-render"});
    ASSERT_NE(certified.exit_status, 2) << certified.errors;
    const fs::path page = folder.path() / "audit.html";
    const auto before = contents_of(run);
    const ProcessResult written = runcert({"audit", run.string(), "--html", page.string()});
    ASSERT_EQ(written.exit_status, 0) << written.errors;
    EXPECT_EQ(contents_of(run), before);
    const std::string html = read_file(page);
    EXPECT_EQ(html.find("<script"), std::string::npos);
    if (run_process({"sh", "-c", "command -v xmllint"}).exit_status != 0)
        GTEST_SKIP() << "xmllint is not installed";
    const auto found = [&](const std::string& xpath) {
        const ProcessResult result =
            run_process({"xmllint", "--nonet", "--xpath", xpath, page.string()});
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        return result.output;
    };
    const std::string shown = "<script>alert('1')</script> {{title}} & gnp";
    for (const char* name : {"Craft", "Place", "Officials", "Record to beat"}) {
        const std::string value = found(
            fmt::format("string(//*[local-name()='dd'][preceding-sibling::*[1]='{}'])", name));
        EXPECT_NE(value.find(shown), std::string::npos) << name << ": " << value;
    }
    EXPECT_EQ(found("count(//*[local-name()='section'])"), "7\n");
    // The same page twice, whoever makes it where.
    runcert({"audit", run.string(), "--html", page.string()});
    EXPECT_EQ(read_file(page), html);
}

TEST(Audit, AChangedDecisionIsRefused) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_NE(certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
    std::string table = read_file(run / "3-screened.ecsv");
    const std::size_t used = table.rfind(",True,none,");
    ASSERT_NE(used, std::string::npos);
    write_file_atomically(run / "3-screened.ecsv", table.replace(used, 11, ",False,no_fix,"));
    const ProcessResult result = runcert({"audit", run.string()});
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(result.output.empty()) << result.output;
    EXPECT_NE(result.errors.find("not the one that report.json was made from"), std::string::npos)
        << result.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
