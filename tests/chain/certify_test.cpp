#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "chain_support.h"
#include "core/text.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

TEST(Certify, LandYachtIsBeatenAndNotGeoreferenced) {
    const TemporaryFolder folder;
    const ProcessResult result =
        certify(examples / "land_yacht" / "attempt.yaml", folder.path() / "run");
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_NE(result.output.find(
                  "RESULT  nalsa: 215.97 ± 0.35 km/h, required 204.51: exceeds the record. Not yet "
                  "beaten: 14 answers are due.\nNEXT    read "),
              std::string::npos)
        << result.output;
    EXPECT_NE(result.output.find("UNSIGNED"), std::string::npos);
    const YamlValue verdict = read_yaml(folder.path() / "run" / "6-verdict.yaml");
    EXPECT_FALSE(verdict["georeferenced"].boolean());
    const YamlValue profile = verdict["profiles"].list().at(0);
    EXPECT_EQ(profile["outcome"].text(), "beaten");
    // The true speed of the simulated run is 60 m/s.
    EXPECT_NEAR(profile["speed_km_h"].real(), 216.0, profile["expanded_uncertainty_km_h"].real());
    EXPECT_FALSE(profile["window"]["start_gps"].exists());
}

TEST(Certify, SaltLakeIsBeatenUnderBothRules) {
    const TemporaryFolder folder;
    const ProcessResult result =
        certify(examples / "salt_lake" / "attempt.yaml", folder.path() / "run", {"--no-render"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    for (const YamlValue& profile :
         read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"].list()) {
        EXPECT_EQ(profile["outcome"].text(), "beaten");
        EXPECT_TRUE(profile["window"]["start_utc"].exists());
    }
    EXPECT_TRUE(fs::exists(folder.path() / "run" / "report.json"));
    EXPECT_FALSE(fs::exists(folder.path() / "run" / "report.html"));
}

TEST(Certify, ASurveyedCourseIsTimedBetweenItsLines) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    const ProcessResult result =
        certify(examples / "course" / "attempt.yaml", run, {"--no-render"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    const YamlValue profile = read_yaml(run / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_EQ(profile["outcome"].text(), "beaten");
    // By truth.csv the lines, 600 m and 1100 m from the start, are crossed at 41.4328 s and
    // 59.2984 s.
    EXPECT_NEAR(profile["window"]["start_time_s"].real(), 41.4328, 0.0015);
    EXPECT_NEAR(profile["window"]["duration_s"].real(), 59.2984 - 41.4328, 0.002);
    // 500 m over that time, less the component of 0.05 m/s that sets to 91 degrees.
    EXPECT_NEAR(profile["speed_m_s"].real(), 500.0 / (59.2984 - 41.4328) - 0.05, 0.01);
    EXPECT_NEAR(profile["current_subtracted_m_s"].real(), 0.05, 1e-3);
    EXPECT_EQ(runcert({"explain", run.string(), "decision"}).exit_status, 0);
    EXPECT_EQ(runcert({"explain", run.string(), "no-such-clause"}).exit_status, 2);
}

TEST(Certify, AStepInsideTheBestWindowIsNotCertified) {
    const TemporaryFolder folder;
    const ProcessResult result =
        certify(examples / "rejected" / "attempt.yaml", folder.path() / "run", {"--no-render"});
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const YamlValue profile =
        read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_NE(profile["outcome"].text(), "beaten");
    // The raw positions look like a record, and that window is refused because of the step.
    EXPECT_GT(profile["indicated"]["speed_km_h"].real(), profile["required_speed_km_h"].real());
    EXPECT_NE(profile["indicated"]["refusals"].list().at(0).text().find("step"), std::string::npos);
}

/// What must not depend on where, when or under which locale a run was made.
std::map<std::string, std::string> hashed_files(const fs::path& run) {
    auto contents = contents_of(run);
    contents.erase("run.yaml");
    return contents;
}

TEST(Certify, TheSameCommandTwiceGivesTheSameBytes) {
    const TemporaryFolder folder;
    const fs::path attempt = examples / "salt_lake" / "attempt.yaml";
    certify(attempt, folder.path() / "a", {"--brief"});
    certify(attempt, folder.path() / "b", {"--brief"});
    const auto a = hashed_files(folder.path() / "a");
    EXPECT_GE(a.size(), 11U);
    EXPECT_EQ(a, hashed_files(folder.path() / "b"));
    // Again into a folder that holds an earlier result.
    certify(attempt, folder.path() / "a", {"--brief"});
    EXPECT_EQ(a, hashed_files(folder.path() / "a"));
}

// The first page can be read when it is named; RESULT and NEXT stand last.
TEST(Certify, TheCertificateIsThereWhenItIsNamed) {
    const TemporaryFolder folder;
    const std::string page = (folder.path() / "run" / "certificate.pdf").string();
    const ProcessResult said = run_process(
        {"bash", "-c",
         fmt::format("{}/runcert certify {} --out {} | while IFS= read -r line; do echo \"$line\"; "
                     "case \"$line\" in *' {} '*) echo \"$line\"; head -c 5 {}; echo;; esac; done",
                     RUNCERT_PROGRAMS, (examples / "land_yacht" / "attempt.yaml").string(),
                     (folder.path() / "run").string(), page, page)});
    EXPECT_NE(said.output.find("\n%PDF-\nRESULT "), std::string::npos) << said.output;
    const std::size_t last = said.output.rfind("\nNEXT ");
    ASSERT_NE(last, std::string::npos);
    EXPECT_EQ(said.output.find('\n', last + 1), said.output.size() - 1) << said.output;
    for (const char* name : {"report.html", "report.pdf"})
        EXPECT_TRUE(fs::exists(folder.path() / "run" / name)) << name;
}

// Where the whole cannot be drawn, the run and its first page stand, and the exit status says so.
TEST(Certify, AWholeThatCannotBeDrawnLeavesTheCertificate) {
    const TemporaryFolder folder;
    const fs::path programs = folder.path() / "programs";
    fs::create_directory(programs);
    write_file_atomically(programs / "weasyprint",
                          "#!/bin/sh\ncat report.html > page.html\n"
                          "[ $(wc -c < page.html) -gt 60000 ] && exit 3\n"
                          "mv page.html report.html\n"
                          "exec /usr/bin/weasyprint \"$@\"\n");
    fs::permissions(programs / "weasyprint", fs::perms::all);
    const fs::path run = folder.path() / "run";
    const ProcessResult said =
        certify(examples / "land_yacht" / "attempt.yaml", run, {},
                {{"RUNCERT_EXTERNAL_PATH", programs.string() + ":/usr/bin:/bin"}});
    EXPECT_EQ(said.exit_status, 2) << said.output;
    EXPECT_NE(said.errors.find("The PDF could not be made"), std::string::npos) << said.errors;
    EXPECT_TRUE(fs::exists(run / "certificate.pdf"));
    EXPECT_TRUE(fs::exists(run / "report.json"));
    EXPECT_FALSE(fs::exists(run / "report.pdf"));
    EXPECT_EQ(runcert({"verify", run.string()}).exit_status, 1);  // nobody signed it
}

TEST(Certify, AGermanLocaleGivesTheSameBytes) {
    const TemporaryFolder folder;
    const std::string locale = (folder.path() / "de_DE.UTF-8").string();
    if (run_process({"sh", "-c", fmt::format("localedef -i de_DE -f UTF-8 {} 2>/dev/null", locale)})
            .exit_status > 1)
        GTEST_SKIP() << "localedef cannot make a German locale here";
    const Environment german{{"LC_ALL", "de_DE.UTF-8"}, {"LOCPATH", folder.path().string()}};
    // The locale must really have a decimal comma.
    ASSERT_EQ(run_process({"bash", "-c", "printf '%.1f' 1,5"}, {.environment = german}).output,
              "1,5");
    const fs::path attempt = examples / "land_yacht" / "attempt.yaml";
    certify(attempt, folder.path() / "plain", {"--brief"});
    certify(attempt, folder.path() / "german", {"--brief"}, german);
    const auto plain = hashed_files(folder.path() / "plain");
    EXPECT_GE(plain.size(), 11U);
    EXPECT_EQ(plain, hashed_files(folder.path() / "german"));
}

TEST(Certify, StagesByHandGiveTheSameBytesAsCertify) {
    const TemporaryFolder folder;
    const fs::path attempt = examples / "salt_lake" / "attempt.yaml";
    certify(attempt, folder.path() / "chain", {"--no-render"});
    for (const char* stage : {"import", "enu", "screen", "smooth", "window", "check"}) {
        const ProcessResult result =
            run_process({fmt::format("{}/runcert-{}", RUNCERT_PROGRAMS, stage), "--attempt",
                         attempt.string(), "--run-dir", (folder.path() / "hand").string()});
        ASSERT_EQ(result.exit_status, 0) << stage << result.errors;
    }
    run_process({RUNCERT_PROGRAMS "/runcert-report", "--attempt", attempt.string(), "--run-dir",
                 (folder.path() / "hand").string(), "--no-render"});
    EXPECT_EQ(hashed_files(folder.path() / "chain"), hashed_files(folder.path() / "hand"));
}

TEST(Certify, ThePdfHoldsVerdictSpeedUncertaintyAndAllHashes) {
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    ASSERT_EQ(certify(examples / "salt_lake" / "attempt.yaml", run).exit_status, 0);
    ProcessResult text;
    try {
        text = run_process({"pdftotext", (run / "report.pdf").string(), "-"});
    } catch (const std::exception&) {
        GTEST_SKIP() << "pdftotext is not installed";
    }
    ASSERT_EQ(text.exit_status, 0) << text.errors;
    const YamlValue profile = read_yaml(run / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_NE(text.output.find(format_fixed(profile["speed_km_h"].real(), 2)), std::string::npos);
    EXPECT_NE(text.output.find("UNSIGNED"), std::string::npos);
    std::string lower = text.output;
    for (char& c : lower)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    EXPECT_NE(lower.find("beaten"), std::string::npos);
    const auto report = nlohmann::json::parse(read_file(run / "report.json"));
    EXPECT_GE(report["subject"].size(), 9U);
    for (const auto& subject : report["subject"]) {
        const auto hash = subject["digest"]["sha256"].get<std::string>();
        EXPECT_NE(text.output.find(hash), std::string::npos) << subject["name"];
    }
}

TEST(Help, EveryProgramSaysWhatItDoes) {
    for (const char* name :
         {"runcert", "runcert-import", "runcert-enu", "runcert-screen", "runcert-smooth",
          "runcert-window", "runcert-check", "runcert-compare", "runcert-report"}) {
        const ProcessResult result =
            run_process({fmt::format("{}/{}", RUNCERT_PROGRAMS, name), "--help"});
        EXPECT_EQ(result.exit_status, 0) << name;
        EXPECT_GT(result.output.size(), 100U) << name;
    }
    const ProcessResult help = runcert({"certify", "--help"});
    EXPECT_NE(help.output.find("receivers[].recording"), std::string::npos);
    EXPECT_NE(help.output.find("schema: attempt/1.0"), std::string::npos);
}

TEST(Help, UnknownArgumentsAreRefused) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{}, {"certifi"}, {"certify"}, {"certify", "a", "--oot", "b"}}) {
        const ProcessResult result = runcert(arguments);
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_NE(result.errors.find("what to do"), std::string::npos);
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
