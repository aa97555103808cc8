#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>

#include "chain_support.h"
#include "core/text.h"
#include "store/sha256.h"

// Commands as people and programs type them.

namespace runcert::chain::RUNCERT_FILE {
namespace {

TEST(CommandLine, AMistypedCommandIsAnsweredWithTheNearest) {
    const struct {
        std::string typed, meant;
    } cases[] = {{"certfy", "certify"},
                 {"verfy", "verify"},
                 {"inspct", "inspect"},
                 {"bundel", "bundle"},
                 {"at", "attest"}};
    for (const auto& one : cases) {
        const ProcessResult result = runcert({one.typed, "x"});
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_NE(result.errors.find("Did you mean " + one.meant + "?"), std::string::npos)
            << result.errors;
    }
    EXPECT_NE(runcert({"\x1b[31m"}).errors.find("\\x1b[31m"), std::string::npos);
}

TEST(CommandLine, HelpAndVersionAreCommandsToo) {
    EXPECT_EQ(runcert({"help"}).output, runcert({"--help"}).output);
    EXPECT_EQ(runcert({}).output, runcert({"--help"}).output);
    EXPECT_EQ(runcert({"help", "verify"}).output, runcert({"verify", "--help"}).output);
    EXPECT_EQ(runcert({"version"}).output, runcert({"--version"}).output);
    EXPECT_EQ(runcert({"help", "verify"}).exit_status, 0);
}

TEST(CommandLine, WhatTheProgramsAreMadeWithIsListedAsSpdx) {
    const ProcessResult result = runcert({"--version", "--sbom"});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_EQ(runcert({"--sbom", "--version"}).output, result.output);
    EXPECT_EQ(runcert({"--sbom"}).exit_status, 2);
    const auto document = nlohmann::json::parse(result.output);
    EXPECT_EQ(document["spdxVersion"], "SPDX-2.3");
    std::set<std::string> names, ids{"SPDXRef-DOCUMENT"};
    for (const auto& package : document["packages"]) {
        const std::string name = package["name"], id = package["SPDXID"];
        EXPECT_TRUE(ids.insert(id).second) << id;
        EXPECT_TRUE(std::regex_match(id, std::regex("SPDXRef-[A-Za-z0-9.-]+"))) << id;
        names.insert(name);
        if (name == "runcert" || name == "runcert-import") {
            EXPECT_EQ(package["checksums"][0]["checksumValue"],
                      sha256_hex(read_file(fs::path(RUNCERT_PROGRAMS) / name)));
        }
    }
    for (const char* name :
         {"runcert", "runcert-window", "Eigen", "Ceres Solver", "yaml-cpp", "fmt"})
        EXPECT_TRUE(names.contains(name)) << name;
    for (const auto& one : document["relationships"])
        for (const char* end : {"spdxElementId", "relatedSpdxElement"})
            EXPECT_TRUE(ids.contains(one[end])) << one;
}

TEST(CommandLine, AReportNamesTheFilesOfTheProgramsThatMadeIt) {
    const TemporaryFolder folder;
    certify(examples / "rejected" / "attempt.yaml", folder.path() / "run", {"--no-render"});
    const auto report = nlohmann::json::parse(read_file(folder.path() / "run/report.json"));
    std::map<std::string, std::string> files;
    for (const auto& one : report["predicate"]["program"]["files"])
        files[one["name"]] = one["sha256"];
    for (const char* name : {"runcert", "runcert-import", "runcert-window", "runcert-report"})
        EXPECT_EQ(files[name], sha256_hex(read_file(fs::path(RUNCERT_PROGRAMS) / name)));
}

TEST(CommandLine, CertifyAnswersProgramsInOneDocument) {
    const TemporaryFolder folder;
    for (const char* example : {"land_yacht", "rejected"}) {
        const ProcessResult result = certify(examples / example / "attempt.yaml",
                                             folder.path() / example, {"--json", "--no-render"});
        const auto json = nlohmann::json::parse(result.output);
        EXPECT_EQ(json["exit_status"], result.exit_status);
        EXPECT_EQ(json["signed"], false);
        const bool beaten = json["profiles"][0]["outcome"] == "beaten";
        EXPECT_EQ(beaten, result.exit_status == 0);
        const auto report = nlohmann::json::parse(
            read_file(fs::path(json["run_folder"].get<std::string>()) / "report.json"));
        EXPECT_EQ(report["predicate"]["verdict"]["profiles"][0]["outcome"],
                  json["profiles"][0]["outcome"]);
    }
}

TEST(CommandLine, QuietCertifySaysTheVerdictAlone) {
    const TemporaryFolder folder;
    const ProcessResult result = certify(examples / "land_yacht" / "attempt.yaml",
                                         folder.path() / "run", {"--quiet", "--no-render"});
    EXPECT_EQ(result.exit_status, 0);
    EXPECT_TRUE(result.output.starts_with("\nwindow ")) << result.output;
    EXPECT_NE(result.output.find("\nRESULT  nalsa: "), std::string::npos) << result.output;
    for (const char* stage : {"\nimport ", "\nsmooth ", "\nreport "})
        EXPECT_EQ(result.output.find(stage), std::string::npos) << stage;
    // Times of the run before that cannot be read are no reason to refuse.
    for (const char* times : {"{[", "stages: 1", "stages: [{stage: check, seconds: soon}]", ""}) {
        write_file_atomically(folder.path() / "run" / "run.yaml", times);
        const ProcessResult again = certify(examples / "land_yacht" / "attempt.yaml",
                                            folder.path() / "run", {"--quiet", "--no-render"});
        EXPECT_EQ(again.exit_status, 0) << times << again.errors;
        EXPECT_EQ(again.output, result.output) << times;
    }
}

TEST(CommandLine, ARefusalEndsWithReasonPlaceAndTheCommandThatExplainsIt) {
    const TemporaryFolder folder;
    const std::string run = (folder.path() / "run").string();
    const ProcessResult result =
        certify(examples / "rejected" / "attempt.yaml", run, {"--no-render"});
    const std::size_t at =
        result.output.rfind("\nRESULT  nalsa: Not certifiable. The recording shows");
    ASSERT_NE(at, std::string::npos) << result.output;
    const std::string last = result.output.substr(at);
    std::smatch explain;
    ASSERT_TRUE(std::regex_search(last, explain, std::regex("\nNEXT .*: runcert (explain .*)\n")))
        << last;
    EXPECT_NE(result.output.find("\nrefused 224.32 km/h"), std::string::npos) << result.output;
    const std::string words = explain[1].str();
    const ProcessResult explained =
        run_process({"sh", "-c", std::string(RUNCERT_PROGRAMS) + "/runcert " + words});
    EXPECT_EQ(explained.exit_status, 0) << words << explained.errors;
}

TEST(CommandLine, OnATerminalLinesKeepToItsWidthAndOneMoves) {
    const TemporaryFolder folder;
    if (run_process({"sh", "-c", "command -v script"}).exit_status != 0)
        GTEST_SKIP() << "the program script is not installed";
    const std::string run = (folder.path() / "run").string();
    const std::string command = "stty cols 60; TERM=xterm " RUNCERT_PROGRAMS "/runcert certify " +
                                (examples / "land_yacht" / "attempt.yaml").string() +
                                " --no-render --out " + run;
    const ProcessResult first = run_process({"script", "-qec", command, "/dev/null"});
    EXPECT_EQ(first.exit_status, 0) << first.output;
    EXPECT_NE(first.output.find("window 0 s"), std::string::npos) << first.output;
    EXPECT_EQ(first.output.find("of about"), std::string::npos);
    const std::string again = run_process({"script", "-qec", command, "/dev/null"}).output;
    EXPECT_NE(again.find("kept"), std::string::npos) << again;
    std::string run_times = read_file(fs::path(run) / "run.yaml");
    replace_all(run_times, "seconds: ", "seconds: 7");  // long enough to be worth saying
    write_file_atomically(fs::path(run) / "run.yaml", run_times);
    fs::remove(fs::path(run) / "5-windows.yaml");
    const std::string third = run_process({"script", "-qec", command, "/dev/null"}).output;
    EXPECT_NE(third.find("of about"), std::string::npos) << third;
    const std::size_t verdict = first.output.find("witness ");
    std::istringstream lines(first.output.substr(verdict));
    for (std::string line; std::getline(lines, line) && line.find("\033[J") == std::string::npos;) {
        if (line.ends_with('\r')) line.pop_back();
        if (line.find(run) != std::string::npos) continue;
        EXPECT_LE(line.size(), 62U) << line;  // with the bytes of "±"
    }
}

TEST(CommandLine, InspectTakesSeveralRecordingsAndWhatIsPipedIn) {
    const fs::path salt = examples / "salt_lake" / "recording.pos";
    const fs::path course = examples / "course" / "recording.pos";
    const ProcessResult both = runcert({"inspect", salt.string(), course.string()});
    EXPECT_EQ(both.exit_status, 0) << both.errors;
    EXPECT_NE(both.output.find(salt.string()), std::string::npos);
    EXPECT_NE(both.output.find(course.string()), std::string::npos);
    const auto list = nlohmann::json::parse(
        runcert({"inspect", "--json", salt.string(), course.string()}).output);
    EXPECT_EQ(list.size(), 2U);
    const ProcessResult piped =
        run_process({RUNCERT_PROGRAMS "/runcert", "inspect", "-"}, {.standard_input = salt});
    EXPECT_EQ(piped.exit_status, 0) << piped.errors;
    EXPECT_TRUE(piped.output.starts_with("standard input\n")) << piped.output;
    const std::string alone = runcert({"inspect", salt.string()}).output;
    EXPECT_EQ(piped.output.substr(piped.output.find("Positions\n")),
              alone.substr(alone.find("Positions\n")));
    // What cannot be read is said, and the others are shown.
    const ProcessResult one_bad = runcert({"inspect", "missing.pos", salt.string()});
    EXPECT_EQ(one_bad.exit_status, 2);
    EXPECT_NE(one_bad.output.find("Positions\n"), std::string::npos);
}

/// Of a file that they read, or of all that the report names.
TEST(CommandLine, WhatOpensARunSaysThatAFileOfItWasChanged) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    certify(examples / "land_yacht" / "attempt.yaml", run, {"--no-render"});
    using Words = std::vector<std::string>;
    const std::vector<Words> commands{
        {"explain", run.string()},
        {"export", run.string(), "--format", "csv", "--out", "-"},
        {"export", run.string(), "--format", "csv", "--table", "observations", "--out", "-"},
        {"compare", run.string()},
        {"audit", run.string()}};
    for (const Words& command : commands)
        EXPECT_EQ(runcert(command).exit_status, 0) << command[0];
    const std::map<std::string, std::vector<std::size_t>> readers{
        {"recording.primary.csv", {0, 4}}, {"1-observations.ecsv", {0, 2, 4}},
        {"3-screened.ecsv", {0, 3, 4}},    {"4-trajectory.ecsv", {0, 1, 3, 4}},
        {"5-windows.yaml", {0, 3, 4}},     {"6-verdict.yaml", {0, 4}}};
    for (const auto& [file, by] : readers) {
        const std::string whole = read_file(run / file);
        std::string changed = whole;
        char& digit = changed[changed.find_last_of("12345678")];
        digit = static_cast<char>(digit + 1);
        write_file_atomically(run / file, changed);
        for (const std::size_t which : by) {
            const ProcessResult result = runcert(commands[which]);
            EXPECT_EQ(result.exit_status, 2) << commands[which][0] << " " << file;
            EXPECT_NE(result.errors.find(file), std::string::npos) << result.errors;
            EXPECT_NE(result.errors.find("SHA-256"), std::string::npos) << result.errors;
        }
        write_file_atomically(run / file, whole);
    }
}

TEST(CommandLine, InspectDrawsARecordingAsOnePage) {
    const TemporaryFolder folder;
    const std::string page = (folder.path() / "page.html").string();
    const std::string recording = (examples / "salt_lake" / "recording.pos").string();
    const ProcessResult said = runcert({"inspect", recording, "--plot", page});
    EXPECT_EQ(said.exit_status, 0) << said.errors;
    EXPECT_EQ(said.output, runcert({"inspect", recording}).output);
    const std::string drawn = read_file(page);
    for (const char* title :
         {"Horizontal speed", "Track", "Height", "Stated uncertainty", "Steps between epochs"})
        EXPECT_NE(drawn.find(fmt::format("aria-label=\"{}\"", title)), std::string::npos) << title;
    EXPECT_NE(drawn.find("From each epoch to the next."), std::string::npos);
    EXPECT_EQ(drawn.find("http://"), drawn.find("http://www.w3.org"));

    // Nothing is written over, and nothing where nothing can be drawn.
    EXPECT_EQ(runcert({"inspect", recording, "--plot", page}).exit_status, 2);
    EXPECT_EQ(read_file(page), drawn);
    const std::string other = (folder.path() / "other.html").string();
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{recording, recording, "--plot", other},
          {recording, "--plot", (folder.path() / "other.png").string()},
          {(examples / "land_yacht" / "attempt.yaml").string(), "--plot", other}}) {
        std::vector<std::string> words{"inspect"};
        words.insert(words.end(), arguments.begin(), arguments.end());
        const ProcessResult refused = runcert(words);
        EXPECT_EQ(refused.exit_status, 2);
        EXPECT_NE(refused.errors.find("what to do"), std::string::npos);
    }
    EXPECT_FALSE(fs::exists(other));
}

TEST(CommandLine, OutputThatCannotBeWrittenIsAnErrorWithItsReason) {  // ended with 0, or inside
    using namespace std::string_literals;
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    const std::string attempt = (examples / "land_yacht" / "attempt.yaml").string();
    const std::string table = (examples / "land_yacht" / "appendix_a_simulated_ppk.csv").string();
    ASSERT_NE(certify(attempt, run, {"--no-render"}).exit_status, 2);
    const auto in_shell = [](const std::string& command) {
        return run_process(
            {"/bin/sh", "-c", "\"$0\" " + command, fmt::format("{}/runcert", RUNCERT_PROGRAMS)});
    };
    const std::string quoted = "'" + run.string() + "'";
    for (const std::string& command :
         {"--help"s, "--version"s, "certify --help"s, "verify " + quoted, "explain " + quoted,
          "audit " + quoted, "attest " + quoted, "verify --json " + quoted,
          "inspect '" + table + "'", "certify '" + attempt + "' --no-render --out " + quoted}) {
        for (const char* where : {" >/dev/full", " >&-"}) {
            const ProcessResult result = in_shell(command + where);
            EXPECT_EQ(result.exit_status, 2) << command << where;
            EXPECT_NE(result.errors.find("tandard output"), std::string::npos)
                << command << where << result.errors;
        }
        // Nobody can be told, but the status says it.
        EXPECT_EQ(in_shell(command + " >/dev/full 2>/dev/full").exit_status, 2) << command;
    }
    EXPECT_EQ(runcert({"verify", run.string()}).exit_status, 1);  // nobody signed: the run is whole
}

TEST(CommandLine, ATimeLimitEndsWithoutAPartOfAResult) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    const std::string attempt = (examples / "salt_lake" / "attempt.yaml").string();
    ASSERT_NE(certify(attempt, run, {"--no-render"}).exit_status, 2);
    const std::string before = read_file(run / "report.json");
    const std::string verified = runcert({"verify", run.string()}).output;
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"certify", attempt, "--out", run.string()},
          {"certify", attempt, "--out", (folder.path() / "new").string()},
          {"verify", run.string(), "--recompute"}}) {
        std::vector<std::string> limited = arguments;
        limited.insert(limited.end(), {"--time-limit", "1"});
        const ProcessResult result = runcert(limited);
        if (result.exit_status != 2) continue;  // a fast machine
        EXPECT_NE(result.errors.find("--time-limit"), std::string::npos) << result.errors;
        EXPECT_EQ(result.output.find("Measured speed"), std::string::npos) << result.output;
        EXPECT_EQ(read_file(run / "report.json"), before);
        EXPECT_FALSE(fs::exists(folder.path() / "new"));
        EXPECT_EQ(runcert({"verify", run.string()}).output, verified);
    }
    for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with(".runcert-")) << entry;
    for (const char* wrong : {"0", "-1", "soon", ""})
        EXPECT_EQ(runcert({"verify", run.string(), "--time-limit", wrong}).exit_status, 2) << wrong;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
