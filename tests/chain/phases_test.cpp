#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "chain_support.h"
#include "core/text.h"
#include "schemas/phase/declared.h"
#include "schemas/screened_phase/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

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

Verdict verdict_of(const PhaseRun& run) {
    return read_verdict(read_file(run.run() / "6-verdict.yaml"), "6-verdict.yaml");
}

Windows windows_of(const PhaseRun& run) {
    return read_windows(read_file(run.run() / "5-windows.yaml"), "5-windows.yaml");
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
    EXPECT_EQ(run.screened().motion.positions_ahead_s, -18);
    EXPECT_TRUE(says(result.output, "another motion than the positions")) << result.output;
    EXPECT_TRUE(says(result.output, "18 s behind that of the phases")) << result.output;
    // What contradicts everywhere is no silent yes.
    EXPECT_EQ(verdict_of(run).profiles.at(0).outcome, Outcome::not_certifiable);
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
    EXPECT_EQ(beside.exit_status, 0) << beside.errors;
    EXPECT_TRUE(says(beside.output,
                     "raw measurements cannot be read: RINEX observations need "
                     "broadcast orbits"))
        << "no navigation stands beside it under its name" << beside.output;
    const ProcessResult result = runcert({"inspect", run.made("raw.obs").string(), "--navigation",
                                          run.made("broadcast.nav").string()});
    ASSERT_EQ(result.exit_status, 0) << result.errors;
    for (const char* words : {"6 of GPS (1C 2W)", "9 of Galileo (1C 5Q)", "no gaps",
                              "1 in 600 pairs", "moves", "km/h by carrier phase"})
        EXPECT_TRUE(says(result.output, words)) << words << "\n" << result.output;
}

/// The run of examples/phase with a drift of the team's positions.
PhaseRun drifting() {
    return PhaseRun("seed: 26\n",
                    "seed: 26\nfaults:\n  ramps:\n    - {from_s: 45, to_s: 60, east_m_s: 0.0513, "
                    "north_m_s: -0.141}\n");
}

// With the phases the honest run beats the record, and the certificate is sharper than that of the
// positions alone.
TEST(PhaseWitnessRun, BeatsTheRecordAndSaysWhoAgrees) {
    const PhaseRun run;
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    EXPECT_TRUE(says(result.output,
                     "can only contradict until officials have answered for them "
                     "(phases-as-recorded)"))
        << result.output;
    const ProfileVerdict before = verdict_of(run).profiles.at(0);
    EXPECT_TRUE(before.unseen_drift_m_s);
    const ProfileVerdict verdict = verdict_of(run).with_files.at(0);
    EXPECT_EQ(verdict.outcome, Outcome::beaten);
    EXPECT_LT(*verdict.expanded_uncertainty_m_s, 0.025);
    EXPECT_FALSE(verdict.unseen_drift_m_s);
    const CertifiableWindow window = windows_of(run).with_files.at(0).best.value();
    ASSERT_EQ(window.witnesses.size(), 1U);
    EXPECT_EQ(window.witnesses[0].slips, 1);
    const std::string report = read_file(run.run() / "report.json");
    for (const char* part :
         {"from the raw signals handed in", "\"figure\": \"sky\"", "\"figure\": \"satellites\"",
          "\"figure\": \"phase_residuals\"", "\"figure\": \"phase_displacement\"",
          "by carrier phases", "inside it 1 slip and 0 refused pairs"})
        EXPECT_TRUE(says(report, part)) << part;
    run.edit("attempt.yaml", "    phase:", "    # phase:");
    run.edit("attempt.yaml", "    navigation:", "    # navigation:");
    const ProcessResult alone = run.certified();
    EXPECT_EQ(alone.exit_status, 0) << alone.errors;
    EXPECT_TRUE(says(alone.output, "The result rests on positions alone: a drift below"))
        << alone.output;
    EXPECT_TRUE(says(read_file(run.run() / "report.json"), "The result rests on positions alone"));
    const double alone_m_s = *verdict_of(run).profiles.at(0).expanded_uncertainty_m_s;
    EXPECT_GT(alone_m_s, 2.0 * *verdict.expanded_uncertainty_m_s);
    EXPECT_NEAR(*before.expanded_uncertainty_m_s, alone_m_s, 0.01 * alone_m_s);
}

TEST(PhaseWitnessRun, RefusesADriftThatPositionsAloneWouldHaveCertified) {
    const PhaseRun run = drifting();
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    EXPECT_EQ(verdict_of(run).profiles.at(0).outcome, Outcome::not_certifiable);
    EXPECT_TRUE(says(result.output, "contradicted by the carrier phases")) << result.output;
    const ProcessResult audit = runcert({"audit", run.run().string(), "--stage", "screen"});
    const std::string unwrapped = std::regex_replace(audit.output, std::regex("\n +"), " ");
    EXPECT_TRUE(says(unwrapped, "left out: contradicted by the carrier phases; error "))
        << audit.output;
    run.edit("attempt.yaml", "    phase:", "    # phase:");
    run.edit("attempt.yaml", "    navigation:", "    # navigation:");
    EXPECT_EQ(run.certified().exit_status, 0);
    EXPECT_EQ(verdict_of(run).profiles.at(0).outcome, Outcome::beaten);
}

TEST(PhaseWitnessRun, IsVerifiedAndRecomputed) {
    const PhaseRun run;
    ASSERT_EQ(run.certified().exit_status, 0);
    const ProcessResult verified = runcert({"verify", run.run().string(), "--recompute"});
    EXPECT_TRUE(says(verified.output, "identical")) << verified.output << verified.errors;
}

/// Speeds of a wheel and passages of gates of the run of examples/phase, by its truth.
struct HandedIn {
    std::string wheel = "time_s,speed_m_s\n";
    std::string gates = "time_s,distance_m\n";

    HandedIn(const PhaseRun& run, double scale, double later_s) {
        std::vector<std::string> lines = lines_of(read_file(run.made("truth.csv")));
        lines.erase(lines.begin());  // says that it is simulated
        const std::vector<std::string> header = cells_of(lines.front());
        const auto column = [&](std::string_view name) {
            return static_cast<std::size_t>(std::ranges::find(header, name) - header.begin());
        };
        const std::size_t time = column("time_s"), speed = column("speed_m_s"),
                          east = column("east_m"), north = column("north_m");
        double first_m = -1.0;
        for (std::size_t i = 1; i < lines.size(); ++i) {
            const std::vector<std::string> cells = cells_of(lines[i]);
            if (cells.size() <= speed) continue;
            const double at_s = std::stod(cells[time]);
            wheel +=
                fmt::format("{:.3f},{:.4f}\n", at_s + later_s, std::stod(cells[speed]) / scale);
            if (std::abs(at_s - 55.4) > 0.01 && std::abs(at_s - 58.4) > 0.01) continue;
            const double way_m = std::hypot(std::stod(cells[east]), std::stod(cells[north]));
            if (first_m < 0.0) first_m = way_m;
            gates += fmt::format("{:.4f},{:.4f}\n", at_s + later_s, way_m - first_m);
        }
    }
    static std::vector<std::string> cells_of(const std::string& line) {
        std::vector<std::string> cells(1);
        for (const char c : line)
            if (c == ',')
                cells.emplace_back();
            else
                cells.back() += c;
        return cells;
    }
};

void hand_in(const PhaseRun& run, const HandedIn& series) {
    write_file_atomically(run.made("wheel.csv"), series.wheel);
    write_file_atomically(run.made("gates.csv"), series.gates);
    run.edit("attempt.yaml", "profiles:",
             "wheel: {file: wheel.csv, source: rear wheel}\n"
             "gates: {file: gates.csv, source: surveyed, expanded_uncertainty_m: 0.02, "
             "expanded_uncertainty_s: 0.001}\nprofiles:");
}

TEST(HandedInWitnesses, AreHeardBesideThePhases) {
    const PhaseRun run;
    hand_in(run, HandedIn(run, 1.02, 0.0));
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 0) << result.output << result.errors;
    const Windows windows = windows_of(run);
    const CertifiableWindow window = windows.profiles.at(0).best.value();
    std::vector<std::string> kinds;
    for (const WitnessedSpeed& one : window.witnesses) {
        kinds.emplace_back(to_text(one.kind));
        EXPECT_LE(one.normalised_error, 1.0) << kinds.back();
        EXPECT_NEAR(one.speed_m_s, window.speed_m_s, 0.1) << kinds.back();
    }
    EXPECT_EQ(kinds, (std::vector<std::string>{"phases", "wheel", "gates"}));
    ASSERT_FALSE(windows.witness_notes.empty());
    EXPECT_TRUE(says(windows.witness_notes[0], "multiplied by 1.0")) << windows.witness_notes[0];
    EXPECT_TRUE(says(read_file(run.run() / "report.json"), "speeds of a wheel"));
    const ProcessResult verified = runcert({"verify", run.run().string(), "--recompute"});
    EXPECT_TRUE(says(verified.output, "identical")) << verified.output << verified.errors;
    // A gate that says otherwise forbids the certificate.
    HandedIn wrong(run, 1.02, 0.0);
    const std::size_t end = wrong.gates.rfind(',') + 1;
    wrong.gates = wrong.gates.substr(0, end) +
                  fmt::format("{:.4f}\n", std::stod(wrong.gates.substr(end)) + 1.5);
    write_file_atomically(run.made("gates.csv"), wrong.gates);
    const ProcessResult refused = run.certified();
    EXPECT_EQ(refused.exit_status, 1) << refused.output << refused.errors;
    EXPECT_TRUE(says(refused.output, "timing gates")) << refused.output;
}

TEST(HandedInWitnesses, OfAnotherTimeSaySo) {
    const PhaseRun run;
    hand_in(run, HandedIn(run, 1.0, 4000.0));
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    EXPECT_TRUE(says(result.output, "The speeds of a wheel were handed in and say nothing"))
        << result.output;
    EXPECT_TRUE(says(result.output, "The timing gates were handed in and say nothing"))
        << result.output;
}

TEST(HandedInWitnesses, ThatCannotBeReadAreRefusedWithTheirPlace) {
    const PhaseRun run;
    HandedIn bad(run, 1.0, 0.0);
    bad.wheel = "time_s,speed\n0,1\n";
    hand_in(run, bad);
    const ProcessResult result = run.certified();
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_TRUE(says(result.errors, "wheel.csv:1:8")) << result.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
