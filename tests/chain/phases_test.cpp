#include <fmt/format.h>
#include <gtest/gtest.h>

#include "chain_support.h"
#include "core/text.h"
#include "schemas/phase/phase.h"
#include "schemas/screened_phase/screened_phase.h"

// Raw phases beside a recording, as an official hands them in.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A run of examples/phase with changes to its simulation.
class PhaseRun {
  public:
    explicit PhaseRun(const std::string& from = {}, const std::string& to = {}) {
        fs::copy_file(examples / "phase/broadcast.nav", folder_.path() / "broadcast.nav");
        std::string spec = read_file(examples / "phase/spec.yaml");
        if (!from.empty()) {
            EXPECT_NE(spec.find(from), std::string::npos);
            spec.replace(spec.find(from), from.size(), to);
        }
        write_file_atomically(folder_.path() / "spec.yaml", spec);
        const ProcessResult made = runcert({"simulate", (folder_.path() / "spec.yaml").string(),
                                            "--out", (folder_.path() / "made").string()});
        EXPECT_EQ(made.exit_status, 0) << made.errors;
    }

    fs::path made(const std::string& file) const { return folder_.path() / "made" / file; }
    fs::path run() const { return folder_.path() / "run"; }

    void edit(const std::string& file, const std::string& from, const std::string& to) const {
        std::string text = read_file(made(file));
        ASSERT_NE(text.find(from), std::string::npos) << from;
        text.replace(text.find(from), from.size(), to);
        write_file_atomically(made(file), text);
    }
    ProcessResult certified() const {
        return certify(made("attempt.yaml"), run(), {"--no-render"});
    }
    ScreenedPhaseTable screened() const {
        return read_screened_phase(read_file(run() / "3-phase.ecsv"), "3-phase.ecsv");
    }

  private:
    TemporaryFolder folder_;
};

bool says(const std::string& text, std::string_view words) {
    return text.find(words) != std::string::npos;
}

TEST(Phases, ASlipIsFoundAndStandsInTheAuditWithItsLine) {
    const PhaseRun run;
    const ProcessResult result = run.certified();
    ASSERT_NE(result.exit_status, 2) << result.errors;
    const ScreenedPhaseTable screened = run.screened();
    EXPECT_EQ(screened.slips, 1);
    EXPECT_EQ(screened.refusals, 0);
    EXPECT_EQ(screened.motion.outcome, PhaseMotion::agrees);
    const PhaseTable phases = read_phase(read_file(run.run() / "1-phase.ecsv"), "1-phase.ecsv");
    ASSERT_EQ(phases.rows.size(), screened.rows.size());
    std::int64_t line = 0;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        const ScreenedPhase& row = screened.rows[i];
        EXPECT_EQ(row.satellite, phases.rows[i].satellite);
        if (!row.cycles) continue;
        EXPECT_EQ(to_text(row.satellite), "G22");
        EXPECT_NEAR(*row.cycles, 1.0, 0.1);
        EXPECT_NEAR(row.time.seconds(), 58.0, 0.001);
        line = *phases.rows[i].source_line;
    }
    // The satellite's own line of the raw file.
    const std::vector<std::string> raw = lines_of(read_file(run.made("raw.obs")));
    ASSERT_GT(line, 0);
    EXPECT_TRUE(raw[static_cast<std::size_t>(line) - 1].starts_with("G22"));
    const ProcessResult audit = runcert({"audit", run.run().string(), "--stage", "screen"});
    EXPECT_TRUE(says(audit.output, "G22 1C")) << audit.output;
    EXPECT_TRUE(says(audit.output, fmt::format("line {}", line))) << audit.output;
    const ProcessResult report = runcert({"verify", run.run().string(), "--recompute"});
    EXPECT_TRUE(says(report.output, "recompute     identical")) << report.output;
    EXPECT_TRUE(says(read_file(run.run() / "report.json"), "Carrier phases: 1 slip in"));
}

TEST(Phases, ASlipIsRepairedWhereTheAttemptAsksForIt) {
    const PhaseRun run("attempt:\n", "attempt:\n  parameters: {screen: {phase_slips: repair}}\n");
    ASSERT_NE(run.certified().exit_status, 2);
    const ScreenedPhaseTable screened = run.screened();
    EXPECT_EQ(screened.repaired, 1);
    std::int64_t corrected = 0;
    for (const ScreenedPhase& row : screened.rows)
        if (row.correction) {
            EXPECT_EQ(to_text(row.satellite) + to_text(row.signal), "G221C");
            EXPECT_EQ(*row.correction, 1);
            ++corrected;
        }
    EXPECT_EQ(corrected, 21);  // from 58 s to 60 s
}

TEST(Phases, OfAnotherTimeSaySoAtOnce) {
    const PhaseRun run;
    const PhaseRun other("start_gps: \"2026-03-14T03:20:18.000\"",
                         "start_gps: \"2026-03-14T04:40:18.000\"");
    fs::copy_file(other.made("raw.obs"), run.made("raw.obs"), fs::copy_options::overwrite_existing);
    const ProcessResult result = run.certified();
    ASSERT_NE(result.exit_status, 2) << result.errors;
    EXPECT_EQ(run.screened().motion.outcome, PhaseMotion::not_enough);
    EXPECT_TRUE(says(result.output, "not enough to judge the motion")) << result.output;
}

TEST(Phases, OfAnotherReceiverSaySoAtOnce) {
    const PhaseRun run;
    const PhaseRun other("latitude_deg: -31.6", "latitude_deg: -31.2");
    fs::copy_file(other.made("raw.obs"), run.made("raw.obs"), fs::copy_options::overwrite_existing);
    const ProcessResult result = run.certified();
    ASSERT_NE(result.exit_status, 2) << result.errors;
    EXPECT_TRUE(says(result.output, "the receiver was 44 km away")) << result.output;
}

TEST(Phases, WhoseClockIsOffContradictThePositions) {
    const PhaseRun run;
    const PhaseRun other("start_gps: \"2026-03-14T03:20:18.000\"",
                         "start_gps: \"2026-03-14T03:20:36.000\"");
    fs::copy_file(other.made("raw.obs"), run.made("raw.obs"), fs::copy_options::overwrite_existing);
    const ProcessResult result = run.certified();
    ASSERT_NE(result.exit_status, 2) << result.errors;
    EXPECT_EQ(run.screened().motion.outcome, PhaseMotion::contradicts);
    EXPECT_TRUE(says(result.output, "another motion than the positions")) << result.output;
}

TEST(Phases, ThatCannotBeReadAreRefusedWithTheirPlace) {
    struct Case {
        const char* file;
        const char* from;
        const char* to;
        const char* said;
    };
    for (const Case& one :
         {Case{"attempt.yaml", "    navigation: broadcast.nav\n", "", "navigation: is not given"},
          Case{"attempt.yaml", "phase: raw.obs", "phase: recording.pos",
               "no raw measurements that are read"},
          Case{"attempt.yaml", "phase: raw.obs", "phase: none.obs", "does not exist"},
          Case{"raw.obs", "     GPS         TIME", "     XYZ         TIME",
               "time system \"XYZ\" is not known"},
          Case{"broadcast.nav", "N: GNSS NAV DATA", "O: GNSS NAV DATA",
               "is not read as navigation"},
          Case{"attempt.yaml", "    phase: raw.obs\n", "", "RINEX alone"}}) {
        const PhaseRun run;
        run.edit(one.file, one.from, one.to);
        const ProcessResult result = run.certified();
        EXPECT_EQ(result.exit_status, 2) << one.said;
        EXPECT_TRUE(says(result.errors, one.said)) << result.errors;
    }
}

TEST(Phases, OfADayWithoutOrbitsNameSatelliteAndAge) {
    const PhaseRun run;
    std::string broadcast = read_file(run.made("broadcast.nav"));
    for (std::size_t at = 0; (at = broadcast.find("2026 03 14", at)) != std::string::npos;)
        broadcast.replace(at, 10, "2026 03 07");
    write_file_atomically(run.made("broadcast.nav"), broadcast);
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(says(result.errors, "G01")) << result.errors;
    EXPECT_TRUE(says(result.errors, "h away")) << result.errors;
}

TEST(Phases, CutOffAreReadAsFarAsTheyGo) {
    const PhaseRun run;
    const std::string raw = read_file(run.made("raw.obs"));
    write_file_atomically(run.made("raw.obs"), raw.substr(0, raw.size() - 300));
    ASSERT_NE(run.certified().exit_status, 2);
    const PhaseTable phases = read_phase(read_file(run.run() / "1-phase.ecsv"), "1-phase.ecsv");
    EXPECT_EQ(phases.epochs, 600);
    EXPECT_EQ(phases.records.bad, 1);
}

TEST(Phases, ATamperedTableIsNotVerified) {
    const PhaseRun run;
    ASSERT_NE(run.certified().exit_status, 2);
    std::string table = read_file(run.run() / "3-phase.ecsv");
    table.replace(table.find(",geometry_free,"), 15, ",displacement,");
    write_file_atomically(run.run() / "3-phase.ecsv", table);
    EXPECT_TRUE(says(runcert({"verify", run.run().string()}).output, "NO   files"));
}

TEST(Phases, InspectSaysWhatRawMeasurementsAre) {
    const PhaseRun run;
    const ProcessResult beside = runcert({"inspect", run.made("raw.obs").string()});
    EXPECT_EQ(beside.exit_status, 2) << "no navigation stands beside it under its name";
    const ProcessResult result = runcert({"inspect", run.made("raw.obs").string(), "--navigation",
                                          run.made("broadcast.nav").string()});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    for (const char* words : {"6 of GPS (1C 2W)", "9 of Galileo (1C 5Q)", "no gaps",
                              "1 in 600 pairs", "moves", "km/h by carrier phase"})
        EXPECT_TRUE(says(result.output, words)) << words << "\n" << result.output;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
