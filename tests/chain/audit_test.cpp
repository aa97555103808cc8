#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "chain_support.h"
#include "schemas/screened/screened.h"

namespace runcert::chain {
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
        R"((before epoch|epochs?) (\d+)(?: to (\d+))? \(lines? \d+.*?\), .*? s: (left out|used)?.*)");
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
            EXPECT_LE(line.size(), 100U) << line;
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
    EXPECT_NE(text.find("recording.pos: "), std::string::npos) << text;
    // From 54 s on every position is 0.6 m too far along the track: a step, or at 62 m/s a jump of
    // the stamps by 9.7 ms.
    const std::regex step(
        R"(before epoch 541 \(line \d+\), 54\.000 s: a step of 0\.[56]\d\d m .*)");
    const std::regex shift(
        R"(before epoch 541 \(line \d+\), 54\.000 s: the time stamps jump by 0\.0(09|10)\d s .*)"
        R"(along the track, about 0\.[56]\d m.*; statistic .*)");
    std::istringstream entries(text);
    bool listed = false;
    for (std::string line; std::getline(entries, line);)
        listed = listed || std::regex_match(line, step) || std::regex_match(line, shift);
    EXPECT_TRUE(listed) << text;
    EXPECT_EQ(text.find("Not checked"), std::string::npos) << text;
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
    EXPECT_NE(text.find("rover.pos: 5,395 epochs"), std::string::npos) << text;
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

    // What is missing and does not decide is named; what was changed is refused.
    fs::remove(run / "4-trajectory.ecsv");
    const ProcessResult result = runcert({"audit", run.string(), "--receiver", "primary"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_NE(unwrapped(result.output).find("names its hash: 3-screened.ecsv."), std::string::npos)
        << result.output;
    const std::string recording = read_file(run / "recording.primary.pos");
    write_file_atomically(run / "recording.primary.pos", recording + "\n");
    refused({run.string()}, "recording.primary.pos");
    write_file_atomically(run / "recording.primary.pos", recording);
    fs::remove(run / "3-screened.ecsv");
    refused({run.string()}, "3-screened.ecsv");
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
    EXPECT_NE(result.errors.find("not the one that 4-trajectory.ecsv was made from"),
              std::string::npos)
        << result.errors;
}

}  // namespace
}  // namespace runcert::chain
