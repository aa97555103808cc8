#include <fmt/format.h>
#include <gtest/gtest.h>

#include "rules_support.h"

// Ways to make a false record that verification believed, each by its number: what is handed in,
// and what is said of it now.

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

void replace_in(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = read_file(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << ": " << from;
    write_file_atomically(file, text.replace(at, from.size(), to));
}

/// A copy of the example, whose record its speed exceeds by the body's own rule.
class Attacks : public testing::Test {
  protected:
    Attacks() { fs::copy(examples / "land_yacht", attempt_folder(), fs::copy_options::recursive); }
    fs::path attempt_folder() const { return folder_.path() / "attempt"; }
    fs::path attempt() const { return attempt_folder() / "attempt.yaml"; }
    fs::path run() const { return folder_.path() / "run"; }
    fs::path rule_of_the_program() const {
        return fs::path(RUNCERT_SOURCE_DIR) / "stages/check/profiles/nalsa.yaml";
    }
    void claim(const std::string& profiles) const {
        replace_in(attempt(), "profiles: [nalsa]", "profiles: [" + profiles + "]");
    }
    ProcessResult stage(const std::string& name) const {
        return run_process({RUNCERT_PROGRAMS "/runcert-" + name, "--attempt",
                            (run() / "attempt.yaml").string(), "--run-dir", run().string()});
    }
    /// The copy of the rule in a finished run, edited, and every file after it made again.
    void edit_the_rule_of_a_run() const {
        certify(attempt(), run(), {"--no-render"});
        replace_in(run() / "profile.nalsa.yaml", "duration_s: 3", "duration_s: 1");
    }

    TemporaryFolder folder_;
};

TEST_F(Attacks, Rule01ARuleOfOnesOwnWithABodysIdIsRefused) {
    fs::copy_file(rule_of_the_program(), attempt_folder() / "nalsa.yaml");
    replace_in(attempt_folder() / "nalsa.yaml", "duration_s: 3", "duration_s: 1");
    claim("nalsa.yaml");
    const ProcessResult result = certify(attempt(), run(), {"--no-render"});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_TRUE(holds(result.errors, "is that of a rule that comes with the program"))
        << result.errors;
    EXPECT_TRUE(holds(result.errors, "Give") || holds(result.errors, "give a rule of your own"))
        << result.errors;
    EXPECT_FALSE(fs::exists(run() / "6-verdict.yaml"));
}

TEST_F(Attacks, Rule01TheProgramsOwnTextFromAFileIsTheProgramsRule) {
    fs::copy_file(rule_of_the_program(), attempt_folder() / "nalsa.yaml");
    claim("nalsa.yaml");
    const ProcessResult result = certify(attempt(), run(), {"--no-render"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_FALSE(holds(result.output, "altered rules")) << result.output;
}

TEST_F(Attacks, Rule01AnEditedCopyInTheRunFolderIsRefusedByStagesAndSeenByVerify) {
    edit_the_rule_of_a_run();
    for (const char* name : {"window", "check"}) {
        const ProcessResult result = stage(name);
        EXPECT_EQ(result.exit_status, 2) << name;
        EXPECT_TRUE(holds(result.errors, "is not that rule's")) << result.errors;
    }
    const ProcessResult verified = runcert({"verify", run().string(), "--recompute"});
    EXPECT_EQ(verified.exit_status, 1);
    EXPECT_TRUE(holds(verified.output, "NO   rules")) << verified.output;
    EXPECT_TRUE(holds(verified.output, "profile.nalsa.yaml")) << verified.output;
}

TEST_F(Attacks, Rule01AVerdictThatNamesAnotherTextOfTheRuleIsSeen) {
    certify(attempt(), run(), {"--no-render"});
    const fs::path verdict = run() / "6-verdict.yaml";
    const std::string sha256 =
        read_yaml(verdict)["profiles"].list().front()["rule"]["sha256"].text();
    std::string text = read_file(verdict);
    text.replace(text.rfind(sha256), sha256.size(), sha256.size(), 'a');
    write_file_atomically(verdict, text);
    const ProcessResult verified = runcert({"verify", run().string()});
    EXPECT_EQ(verified.exit_status, 1);
    EXPECT_TRUE(holds(verified.output, "NO   rules")) << verified.output;
}

TEST_F(Attacks, Rule01ARuleOfOnesOwnNeverBeatsARecord) {
    write_file_atomically(attempt_folder() / "ours.yaml",
                          profile_of("ours", "{duration_s: 1, definition: displacement}"));
    claim("ours.yaml");
    const ProcessResult result = certify(attempt(), run());
    EXPECT_TRUE(holds(result.output, "exceeds the record under altered rules")) << result.output;
    EXPECT_TRUE(holds(result.output, "The rule ours is the attempt's own")) << result.output;
    EXPECT_FALSE(holds(result.output, "Record beaten")) << result.output;
    for (const char* file : {"report.html", "report.json"}) {
        const std::string page = read_file(run() / file);
        EXPECT_TRUE(holds(page, "under altered rules")) << file;
        EXPECT_FALSE(holds(page, "Record beaten")) << file;
    }
    const ProcessResult verified = runcert({"verify", run().string()});
    EXPECT_TRUE(holds(verified.output, "yes  rules")) << verified.output;
    EXPECT_TRUE(holds(verified.output, "the attempt's own, not a body's: ours")) << verified.output;
}

TEST_F(Attacks, Rule01AReplacedFigureIsSaidInTheHeadline) {
    replace_in(attempt(), "profiles: [nalsa]",
               "profiles: [nalsa]\nrules: [{profile: nalsa, figure: window.duration_s, value: 1}]");
    const ProcessResult result = certify(attempt(), run(), {"--no-render"});
    EXPECT_TRUE(holds(result.output, "under altered rules")) << result.output << result.errors;
    EXPECT_FALSE(holds(result.output, "Record beaten")) << result.output;
}

TEST_F(Attacks, Files07NothingIsWrittenOrRemovedThroughALinkInAFolderOfResults) {
    const fs::path out = folder_.path() / "out";
    const fs::path victim = folder_.path() / "victim";
    fs::create_directory(victim);
    write_file_atomically(victim / "kept.txt", "kept");
    write_file_atomically(victim / "report.json", "theirs");
    const auto before = contents_of(victim);
    for (const char* link : {".runcert", ".runcert/batch.lock", ".runcert/work",
                             ".runcert/work/land-yacht", ".runcert/records", "land-yacht"}) {
        SCOPED_TRACE(link);
        fs::remove_all(out);
        fs::create_directories((out / link).parent_path());
        fs::create_symlink(std::string(link).ends_with(".lock") ? victim / "kept.txt" : victim,
                           out / link);
        const ProcessResult result =
            runcert({"batch", attempt().string(), "--out", out.string(), "--no-render"});
        EXPECT_EQ(result.exit_status, 2) << result.output << result.errors;
        EXPECT_TRUE(holds(result.output + result.errors, "symbolic link"))
            << result.output << result.errors;
        EXPECT_EQ(contents_of(victim), before);
    }
}

TEST_F(Attacks, Files07SignaturesAreNotMovedThroughALink) {
    const std::string key = (folder_.path() / "key").string();
    ASSERT_EQ(runcert({"keygen", "--out", key, "--no-password"}).exit_status, 0);
    certify(attempt(), run(), {"--no-render", "--key", key + ".key"});
    const std::string signature = read_file(run() / "report.json.minisig");
    fs::create_directory(folder_.path() / "elsewhere");
    fs::create_symlink(folder_.path() / "elsewhere", run() / "superseded");
    const ProcessResult again = certify(attempt(), run(), {"--no-pdf", "--key", key + ".key"});
    EXPECT_EQ(again.exit_status, 2) << again.output;
    EXPECT_TRUE(holds(again.errors, "symbolic link")) << again.errors;
    EXPECT_TRUE(fs::is_empty(folder_.path() / "elsewhere"));
    EXPECT_EQ(read_file(run() / "report.json.minisig"), signature);
}

TEST_F(Attacks, Input12AReportWithACurveThatIsTooShortIsRefused) {
    certify(attempt(), run(), {"--no-render"});
    auto report = nlohmann::ordered_json::parse(read_file(run() / "report.json"));
    report["predicate"]["figures"][0]["curves"][0]["y"] = nlohmann::ordered_json::array();
    write_file_atomically(run() / "report.json", report.dump(2));
    const ProcessResult rendered = run_process({RUNCERT_PROGRAMS "/runcert-report", "--attempt",
                                                (run() / "attempt.yaml").string(), "--run-dir",
                                                run().string(), "--render-only"});
    EXPECT_EQ(rendered.exit_status, 2) << rendered.output << rendered.errors;
    EXPECT_TRUE(holds(rendered.errors, "0 values for")) << rendered.errors;
    EXPECT_FALSE(fs::exists(run() / "report.html"));
}

TEST_F(Attacks, Input12AReportThatBreaksItsSchemaIsNotSigned) {
    certify(attempt(), run(), {"--no-render"});
    auto report = nlohmann::ordered_json::parse(read_file(run() / "report.json"));
    report["predicate"]["praise"] = "the fastest";
    write_file_atomically(run() / "report.json", report.dump(2));
    const std::string key = (folder_.path() / "key").string();
    ASSERT_EQ(runcert({"keygen", "--out", key, "--no-password"}).exit_status, 0);
    const ProcessResult result = runcert({"sign", run().string(), "--key", key + ".key", "--role",
                                          "measurer", "--no-render", "--no-recompute"});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_TRUE(holds(result.errors, "praise")) << result.errors;
}

// What was recomputed before is not evidence of what lies there now.
TEST_F(Attacks, Recompute04StopsAfterAFaultUnlessAskedToGoOn) {
    certify(attempt(), run(), {"--no-render"});
    replace_in(run() / "4-trajectory.ecsv", "\n300,", "\n301,");
    const ProcessResult stopped = runcert({"verify", run().string(), "--recompute"});
    EXPECT_EQ(stopped.exit_status, 1);
    EXPECT_TRUE(holds(stopped.output, "not done, because of what was found above"))
        << stopped.output;
    const ProcessResult went_on =
        runcert({"verify", run().string(), "--recompute", "--keep-going"});
    EXPECT_EQ(went_on.exit_status, 1);
    EXPECT_TRUE(holds(went_on.output, "NO   recompute")) << went_on.output;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
