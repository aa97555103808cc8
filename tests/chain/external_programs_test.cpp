#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "chain_support.h"
#include "store/external_program.h"

// Programs of others as a user meets them: what is said of them, and that it does not matter where
// they run.

namespace runcert::chain::RUNCERT_FILE {
namespace {

const std::string runcert_program = RUNCERT_PROGRAMS "/runcert";

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::string sha256_of(const fs::path& file) {
    return run_process({"sha256sum", file.string()}).output.substr(0, 64);
}

/// An attempt whose recording only gpsbabel reads.
std::string converted_attempt(const fs::path& folder) {
    std::string points;
    for (int i = 0; i < 60; ++i)
        points += fmt::format(
            "<Trackpoint><Time>2019-04-12T00:{:02}:{:02}Z</Time><Position><LatitudeDegrees>{:.7f}"
            "</LatitudeDegrees><LongitudeDegrees>-1.3000000</LongitudeDegrees></Position>"
            "<AltitudeMeters>10.0</AltitudeMeters></Trackpoint>",
            39 + i / 60, i % 60, 54.3 + i * 1e-4);
    write_file_atomically(
        folder / "track.tcx",
        "<?xml version=\"1.0\"?><TrainingCenterDatabase><Activities><Activity Sport=\"Other\">"
        "<Id>2019-04-12T00:39:00Z</Id><Lap StartTime=\"2019-04-12T00:39:00Z\"><Track>" +
            points + "</Track></Lap></Activity></Activities></TrainingCenterDatabase>");
    write_file_atomically(
        folder / "attempt.yaml",
        "schema: attempt/1.0\nid: converted\ncraft: {name: y, class: land-yacht}\n"
        "receivers:\n  - {id: primary, recording: track.tcx, accuracy: "
        "{horizontal_m: 0.5, vertical_m: 1.0}}\nprofiles: [nalsa]\n");
    return (folder / "attempt.yaml").string();
}

TEST(ExternalPrograms, WhoConvertedARecordingStandsInTheReportByHash) {
    if (external_program_file("gpsbabel").empty()) GTEST_SKIP() << "gpsbabel is not installed";
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    const ProcessResult made = certify(converted_attempt(folder.path()), run, {"--no-render"});
    ASSERT_LT(made.exit_status, 2) << made.errors;
    const auto report = nlohmann::json::parse(read_file(run / "report.json"));
    const std::string hash = sha256_of("/usr/bin/gpsbabel");
    std::size_t named = 0;
    for (const auto& program : report["predicate"]["certificate"]["software"])
        if (program["name"] == "gpsbabel") {
            ++named;
            EXPECT_EQ(program["sha256"], hash);
            EXPECT_TRUE(program.contains("release"));
        }
    EXPECT_EQ(named, 1U);
}

// It is who made the table, and no result.
TEST(ExternalPrograms, AnotherBuildOfAConverterIsNoFaultWhereItReadsTheSame) {
    if (external_program_file("gpsbabel").empty()) GTEST_SKIP() << "gpsbabel is not installed";
    const TemporaryFolder folder;
    const fs::path run = folder.path() / "run";
    const fs::path other = folder.path() / "programs" / "gpsbabel";
    fs::create_directory(other.parent_path());
    write_file_atomically(other, "#!/bin/sh\nexec /usr/bin/gpsbabel \"$@\"\n");
    fs::permissions(other, fs::perms::owner_all);
    const ProcessResult made =
        certify(converted_attempt(folder.path()), run, {"--no-render"},
                {{"RUNCERT_EXTERNAL_PATH", other.parent_path().string() + ":/usr/bin"}});
    ASSERT_LT(made.exit_status, 2) << made.errors;
    EXPECT_TRUE(holds(read_file(run / "1-observations.ecsv"), sha256_of(other)));
    const ProcessResult verified = runcert({"verify", run.string(), "--recompute"});
    EXPECT_TRUE(holds(verified.output, "yes  recompute")) << verified.output;
}

TEST(ExternalPrograms, VersionSaysWhichThereAreAndWhatCouldNotBeHad) {
    const std::string said = runcert({"--version"}).output;
    for (const ExternalProgram& program : external_programs())
        EXPECT_TRUE(holds(said, fmt::format("\n{:<11} ", program.name))) << said;
    EXPECT_EQ(holds(said, "The sandbox is not in force"), !has_sandbox()) << said;
    const std::string without =
        runcert({"--version"}, {{"RUNCERT_EXTERNAL_PATH", "/nonexistent"}}).output;
    EXPECT_TRUE(holds(without, "gpsbabel    missing: install the package gpsbabel\n")) << without;
}

const std::string hidden = "mount --bind /dev/null /usr/bin/bwrap; ";

bool can_hide_the_sandbox() {
    return run_process({"unshare", "-m", "sh", "-c", hidden + "true"}).exit_status == 0 &&
           has_sandbox();
}

// Got through unsaid: only --version said it. What a converter made of a recording without a
// sandbox is the same where it is computed again in one, and the report says how it was.
TEST(AttacksOnPrograms, Sandbox01ThatThereWasNoneIsSaidByCertifyVerifyAndTheReport) {
    if (!can_hide_the_sandbox() || external_program_file("gpsbabel").empty())
        GTEST_SKIP() << "bubblewrap cannot be hidden here";
    const TemporaryFolder folder;
    const std::string run = (folder.path() / "run").string();
    const auto without = [](const std::string& arguments) {
        return run_process(
            {"unshare", "-m", "sh", "-c", hidden + runcert_program + " " + arguments});
    };
    const ProcessResult made =
        without("certify " + converted_attempt(folder.path()) + " --out " + run + " --no-pdf");
    ASSERT_LT(made.exit_status, 2) << made.errors;
    const std::string said = "The sandbox is not in force (bubblewrap is not installed)";
    EXPECT_TRUE(holds(made.output, said)) << made.output;
    EXPECT_TRUE(holds(without("verify " + run).output, said));
    EXPECT_TRUE(holds(without("verify --json " + run).output, said));
    EXPECT_TRUE(holds(read_file(run + "/report.html"), "gpsbabel (without a sandbox)"));
    const ProcessResult verified = runcert({"verify", run, "--recompute"});
    EXPECT_FALSE(holds(verified.output, said)) << verified.output;
    EXPECT_TRUE(holds(verified.output, "gpsbabel ran without a sandbox where this was made"))
        << verified.output;
    EXPECT_TRUE(holds(verified.output, "yes  recompute")) << verified.output;
    // And the other way: nothing is said of what ran in one.
    const std::string inside = (folder.path() / "inside").string();
    const ProcessResult again =
        certify((folder.path() / "attempt.yaml").string(), inside, {"--no-pdf"});
    ASSERT_LT(again.exit_status, 2) << again.errors;
    EXPECT_FALSE(holds(read_file(inside + "/report.html"), "without a sandbox"));
    EXPECT_FALSE(holds(again.output, "sandbox")) << again.output;
}

// In a container there may be neither bubblewrap nor namespaces.
TEST(ExternalPrograms, TheSameBytesComeFromInsideAndOutsideOfTheSandbox) {
    if (!can_hide_the_sandbox()) GTEST_SKIP() << "bubblewrap cannot be hidden here";
    const TemporaryFolder folder;
    const std::string attempt = (examples / "land_yacht" / "attempt.yaml").string();
    const auto certified = [&](const std::string& name, const std::vector<std::string>& before,
                               const std::string& script) {
        std::vector<std::string> command = before;
        command.insert(command.end(),
                       {"sh", "-c", script + "\"$0\" --version; \"$0\" certify \"$1\" --out \"$2\"",
                        runcert_program, attempt, (folder.path() / name).string()});
        return run_process(command);
    };
    const ProcessResult inside = certified("inside", {}, "");
    const ProcessResult missing = certified("missing", {"unshare", "-m"}, hidden);
    const ProcessResult limits =
        certified("limits",
                  {"unshare", "-Ur", "sh", "-c",
                   "echo 0 > /proc/sys/user/max_user_namespaces; exec setpriv --bounding-set=-all "
                   "--inh-caps=-all \"$0\" \"$@\""},
                  "");
    EXPECT_FALSE(holds(inside.output, "not in force")) << inside.output;
    const std::string said =
        "). Programs of others can read your files and may reach the network, and what they start "
        "may outlive this program.";
    EXPECT_TRUE(holds(missing.output, "bubblewrap is not installed" + said))
        << missing.output << missing.errors;
    EXPECT_TRUE(holds(limits.output, said)) << limits.output;
    for (const char* file : {"report.json", "report.html", "certificate.pdf", "report.pdf"})
        for (const char* other : {"missing", "limits"})
            EXPECT_EQ(sha256_of(folder.path() / "inside" / file),
                      sha256_of(folder.path() / other / file))
                << other << " " << file;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
