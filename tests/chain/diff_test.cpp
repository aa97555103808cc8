#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "chain_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Runs of the example that is refused: as it is, and changed.
class Diff : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        make("plain", {}, {});
    }
    static void TearDownTestSuite() {
        delete folder_;
        folder_ = nullptr;
    }
    static fs::path run(const std::string& name) { return folder_->path() / name / "run"; }

    /// A run with more in its attempt, and with another recording where one is given.
    static void make(const std::string& name, const std::string& more,
                     const std::string& recording) {
        const fs::path example = examples / "rejected";
        const fs::path folder = folder_->path() / name;
        fs::create_directory(folder);
        write_file_atomically(folder / "attempt.yaml", read_file(example / "attempt.yaml") + more);
        write_file_atomically(folder / "recording.pos",
                              recording.empty() ? read_file(example / "recording.pos") : recording);
        const ProcessResult result = certify(folder / "attempt.yaml", run(name), {"--no-render"});
        ASSERT_NE(result.exit_status, 2) << result.errors;
    }
    static ProcessResult diff(const std::string& a, const std::string& b,
                              std::vector<std::string> more = {}) {
        std::vector<std::string> arguments{"diff", run(a).string(), run(b).string()};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments);
    }
    static nlohmann::json json_of(const std::string& a, const std::string& b) {
        const ProcessResult result = diff(a, b, {"--json"});
        EXPECT_TRUE(result.errors.empty()) << result.errors;
        return nlohmann::json::parse(result.output);
    }

    static TemporaryFolder* folder_;
};
TemporaryFolder* Diff::folder_ = nullptr;

TEST_F(Diff, ARunDoesNotDifferFromItself) {
    const auto before = contents_of(run("plain"));
    const ProcessResult result = diff("plain", "plain");
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    EXPECT_NE(result.output.find("\nNothing differs.\n"), std::string::npos) << result.output;
    EXPECT_EQ(json_of("plain", "plain")["equal"], true);
    EXPECT_EQ(contents_of(run("plain")), before);
}

TEST_F(Diff, OneParameterIsNamedWithTheWindowsThatItChanges) {
    make("stated", "parameters:\n  smooth: {noise: stated}\n", {});
    const ProcessResult result = diff("plain", "stated");
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const nlohmann::json found = json_of("plain", "stated");
    EXPECT_EQ(found["parameters"],
              nlohmann::json::parse(
                  R"([{"what": "smooth.noise", "a": "\"fitted\"", "b": "\"stated\""}])"));
    EXPECT_TRUE(found["attempt"].empty()) << found["attempt"];
    EXPECT_TRUE(found["inputs"].empty()) << found["inputs"];
    EXPECT_TRUE(found["programs"].empty()) << found["programs"];
    EXPECT_TRUE(found["epochs"][0]["changes"].empty());
    // The change of the speed, from the two files themselves.
    const auto best = [](const std::string& name) {
        return read_yaml(run(name) / "5-windows.yaml")["profiles"].list()[0]["best"];
    };
    const double speed_a = best("plain")["speed_m_s"].real();
    const double speed_b = best("stated")["speed_m_s"].real();
    const double u_a = best("plain")["standard_uncertainty_m_s"].real();
    const double u_b = best("stated")["standard_uncertainty_m_s"].real();
    ASSERT_NE(speed_a, speed_b);
    const std::string expected =
        fmt::format("{:+.6f} m/s, {:.4f} of the combined expanded uncertainty (k = 2)",
                    speed_b - speed_a, std::abs(speed_b - speed_a) / (2 * std::hypot(u_a, u_b)));
    bool named = false;
    for (const auto& change : found["windows"])
        named =
            named || (change["what"] == "nalsa, best window, speed" && change["note"] == expected);
    EXPECT_TRUE(named) << expected << found["windows"];
    // What comes before the stage is the same, value for value.
    for (const auto& product : found["products"])
        EXPECT_EQ(product["equal"], product["file"] < "4") << product["file"];
    const std::string text = result.output;
    EXPECT_NE(text.find("smooth.noise  \"fitted\"  \"stated\"\n"), std::string::npos) << text;
    EXPECT_NE(text.find("Attempt: the same."), std::string::npos) << text;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        EXPECT_LE(line.size(), 80U) << line;
}

TEST_F(Diff, AnEditedEpochOfTheRecordingIsNamed) {
    // 1.1 m further north at epoch 300, which is line 303.
    std::istringstream lines(read_file(examples / "rejected" / "recording.pos"));
    std::string edited;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line); edited += line + "\n") {
        if (++number != 303) continue;
        std::smatch found;
        ASSERT_TRUE(std::regex_search(line, found, std::regex(R"(-\d+\.\d+)"))) << line;
        line.replace(static_cast<std::size_t>(found.position()),
                     static_cast<std::size_t>(found.length()),
                     fmt::format("{:.9f}", std::stod(found.str()) + 1e-5));
    }
    make("edited", {}, edited);
    EXPECT_EQ(diff("plain", "edited").exit_status, 1);
    const nlohmann::json found = json_of("plain", "edited");
    ASSERT_EQ(found["inputs"].size(), 1U) << found["inputs"];
    EXPECT_EQ(found["inputs"][0]["what"], "recording.primary.pos");
    const std::string sum =
        run_process({"sha256sum", (run("edited") / "recording.primary.pos").string()})
            .output.substr(0, 64);
    EXPECT_EQ(found["inputs"][0]["b"], sum);
    const nlohmann::json& changes = found["epochs"][0]["changes"];
    ASSERT_EQ(changes.size(), 1U) << changes;
    EXPECT_EQ(changes[0]["epoch_a"], 300);
    EXPECT_EQ(changes[0]["a"], "used");
    EXPECT_EQ(changes[0]["b"], "left out: outlier");
    EXPECT_EQ(found["epochs"][0]["counts"]["used -> left out: outlier"], 1);
    // The first table has one latitude otherwise.
    bool named = false;
    for (const auto& column : found["products"][0]["table"]["columns"])
        named = named || (column["column"] == "latitude" && column["cells"] == 1 &&
                          column["largest"]["epoch_a"] == 300);
    EXPECT_TRUE(named) << found["products"][0];
    const std::string text = diff("plain", "edited").output;
    EXPECT_NE(text.find("\n  300  29.900 s  used  left out: outlier\n"), std::string::npos) << text;
}

TEST_F(Diff, AMissingRowIsCountedAndTheOthersAreCompared) {
    std::istringstream lines(read_file(examples / "rejected" / "recording.pos"));
    std::string fewer;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);)
        if (++number != 303) fewer += line + "\n";
    make("fewer", {}, fewer);
    const nlohmann::json found = json_of("plain", "fewer");
    EXPECT_EQ(found["epochs"][0]["only_a"], 1);
    EXPECT_EQ(found["epochs"][0]["only_b"], 0);
    EXPECT_EQ(found["epochs"][0]["compared"], 600);
    for (const auto& column : found["products"][0]["table"]["columns"])
        EXPECT_NE(column["column"], "latitude") << column;
}

// The table of a surface has no time, and that of screened phases no word of what became of an
// epoch: neither kind of run could be compared.
TEST_F(Diff, RunsWithASurfaceOrPhasesAreCompared) {
    for (const char* name : {"oval", "phases"})
        fs::create_directory(folder_->path() / name);
    ASSERT_NE(certify(examples / "oval" / "attempt.yaml", run("oval"), {"--no-render"}).exit_status,
              2);
    const fs::path phases = folder_->path() / "phases" / "made";
    ASSERT_EQ(
        runcert({"simulate", (examples / "phase" / "spec.yaml").string(), "--out", phases.string()})
            .exit_status,
        0);
    ASSERT_NE(certify(phases / "attempt.yaml", run("phases"), {"--no-render"}).exit_status, 2);
    for (const std::string name : {"oval", "phases"}) {
        const ProcessResult result = diff(name, name);
        EXPECT_EQ(result.exit_status, 0) << result.errors;
    }
    EXPECT_EQ(json_of("oval", "phases")["epochs"].size(), 1U);
}

TEST_F(Diff, ARuleThatOneRunAloneClaimsIsOneDifference) {
    make("both", {}, {});
    const fs::path attempt = folder_->path() / "both" / "attempt.yaml";
    std::string text = read_file(attempt);
    const std::size_t rule = text.find("  - nalsa");
    ASSERT_NE(rule, std::string::npos);
    write_file_atomically(attempt, text.insert(rule, "  - fisly\n"));
    ASSERT_NE(certify(attempt, run("both"), {"--no-render"}).exit_status, 2);
    const nlohmann::json found = json_of("plain", "both");
    EXPECT_EQ(found["windows"],
              nlohmann::json::parse(R"([{"what": "fisly", "a": "not claimed", "b": "claimed"}])"));
    ASSERT_EQ(found["verdicts"].size(), 1U) << found["verdicts"];
    EXPECT_EQ(found["verdicts"][0]["what"], "fisly, outcome");
}

TEST_F(Diff, WhatCannotBeComparedIsRefused) {
    const auto refused = [&](const fs::path& other, const std::string& said) {
        const ProcessResult result = runcert({"diff", run("plain").string(), other.string()});
        EXPECT_EQ(result.exit_status, 2) << result.output;
        EXPECT_TRUE(result.output.empty()) << result.output;
        EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
        EXPECT_NE(result.errors.find("what to do: "), std::string::npos) << result.errors;
    };
    refused(folder_->path() / "absent", "absent");
    refused(folder_->path(), "not the folder of a run");
    const fs::path broken = folder_->path() / "broken";
    fs::copy(run("plain"), broken);
    write_file_atomically(broken / "3-screened.ecsv", "epoch,time\n1,2\n");
    refused(broken, "3-screened.ecsv");
    // A file that one of them lacks is a difference.
    fs::remove(broken / "3-screened.ecsv");
    const ProcessResult result = runcert({"diff", run("plain").string(), broken.string()});
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    EXPECT_NE(result.output.find("3-screened.ecsv: MISSING in B"), std::string::npos)
        << result.output;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
