#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "chain_support.h"
#include "recorded_run.h"
#include "schemas/verdict/declared.h"

// What a recording says of itself, and what is typed beside it: each way to make it say more than a
// receiver measured, by its family. "Got through" and "held" say what the commit before these tests
// made of it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// An attempt on one recording, and what becomes of it.
class Origins : public testing::Test {
  protected:
    Origins() { fs::create_directory(folder_.path() / "attempt"); }
    fs::path path(const std::string& name) const { return folder_.path() / "attempt" / name; }
    fs::path run() const { return folder_.path() / "run"; }
    void put(const std::string& name, const std::string& bytes) const {
        write_file_atomically(path(name), bytes);
    }
    void attempt(const std::string& recording, const std::string& of_receiver = {},
                 const std::string& more = {}, const std::string& craft = "land-yacht",
                 const std::string& profile = "nalsa") const {
        put("attempt.yaml",
            fmt::format("schema: attempt/1.0\nid: origin\ncraft: {{name: yacht, class: {}}}\n"
                        "receivers:\n  - {{id: primary, recording: {}{}}}\nprofiles: [{}]\n{}",
                        craft, recording, of_receiver, profile, more));
    }
    ProcessResult certified(std::vector<std::string> more = {"--no-render"}) const {
        fs::remove_all(run());
        return certify(path("attempt.yaml"), run(), std::move(more));
    }
    ProfileVerdict verdict() const {
        const ProcessResult result = certified();
        EXPECT_NE(result.exit_status, 2) << result.errors;
        return read_verdict(read_file(run() / "6-verdict.yaml"), "6-verdict.yaml").profiles.at(0);
    }
    static Requirement clause(const ProfileVerdict& verdict, const std::string& id) {
        const auto found = std::ranges::find(verdict.requirements, id, &Requirement::clause);
        EXPECT_NE(found, verdict.requirements.end()) << id;
        return found == verdict.requirements.end() ? Requirement{} : *found;
    }
    std::string inspected(const std::string& name) const {
        const ProcessResult result = runcert({"inspect", path(name).string()});
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        return result.output;
    }
    /// It is said on page one, in the verdict, in the report and by inspect.
    void expect_simulated(const std::string& recording, const std::string& said) const {
        SCOPED_TRACE(recording);
        const ProfileVerdict found = verdict();
        ASSERT_FALSE(found.notes.empty());
        EXPECT_TRUE(holds(found.notes.front(), "receiver \"primary\" says that it was simulated"));
        const Requirement measured = clause(found, "positions-as-measured");
        EXPECT_EQ(measured.status, RequirementStatus::attest);
        EXPECT_TRUE(holds(measured.evidence, "the recording says that it was simulated"))
            << measured.evidence;
        const std::string table = (run() / "1-observations.ecsv").string();
        const Observations observed = read_observations(read_file(table), table);
        EXPECT_TRUE(observed.simulated);
        EXPECT_TRUE(holds(fmt::format("{}", fmt::join(observed.written_by, "; ")), said));
        const std::string text = inspected(recording);
        EXPECT_TRUE(holds(text, "It was simulated") || holds(text, "it was simulated")) << text;
        EXPECT_TRUE(holds(text, said)) << text;
    }

    TemporaryFolder folder_;
};

const std::string fixed_csv =
    ", format: csv, solution: fixed, frame: local_plane, columns: {time: "
    "time_s, east: east_m, north: north_m, up: up_m}, accuracy: "
    "{horizontal_m: 0.01, vertical_m: 0.02}";
const std::string typed_accuracy = ", accuracy: {horizontal_m: 0.01, vertical_m: 0.02}";
const std::string single_allowed = "parameters: {screen: {allowed_fixes: [fixed, single]}}\n";

/// A simulation's file; `place` puts it on the Earth.
std::string spec(bool place) {
    return std::string(
               "schema: simulation/1.0\nrun: {top_speed_m_s: 64, half_speed_time_s: 15, "
               "duration_s: 45, rate_hz: 10}\nwhite_noise: {horizontal_m: 0.01, vertical_m: "
               "0.02}\nattempt: {id: s, craft: {name: yacht, class: land-yacht}, profiles: "
               "[nalsa]}\n") +
           (place ? "place: {latitude_deg: -31.6, longitude_deg: 136.0, height_m: 110}\nstart_gps: "
                    "\"2026-03-14T03:20:18.000\"\n"
                  : "");
}

// Marks of simulators.

TEST_F(Origins, WhatSimulateWritesHandedInAsItIsIsSaidToBeSimulated) {  // got through, both
    for (const bool place : {true, false}) {
        put("spec.yaml", spec(place));
        const fs::path made = folder_.path() / (place ? "pos" : "csv");
        ASSERT_EQ(
            runcert({"simulate", path("spec.yaml").string(), "--out", made.string()}).exit_status,
            0);
        const std::string name = place ? "recording.pos" : "recording.csv";
        fs::copy_file(made / name, path(name));
        if (place) {
            attempt(name);
            expect_simulated(name, "runcert simulate");
            continue;
        }
        attempt(name, fixed_csv);
        EXPECT_TRUE(holds(verdict().notes.at(0), "simulated"));
        // And what it says is true may be handed in for measured.
        fs::copy_file(made / "truth.csv", path("truth.csv"));
        attempt("truth.csv", fixed_csv);
        EXPECT_TRUE(holds(verdict().notes.at(0), "simulated"));
    }
}

TEST_F(Origins, AMarkIsReadInEveryFormat) {  // got through, all
    const RecordedRun honest = RecordedRun::every(0.1);
    struct Marked {
        std::string name, bytes, of_receiver, said;
    };
    for (const Marked& one : std::vector<Marked>{
             {"german.pos", "% SIMULIERTE Fahrt\n" + honest.pos(), "", "SIMULIERTE"},
             {"end.pos", honest.pos() + "% made by a simulator\n", "", "made by a simulator"},
             {"quality.nmea", honest.nmea('8', 'S'), typed_accuracy, "quality 8 or mode S"},
             {"mode.nmea", honest.nmea('4', 'S'), typed_accuracy, "quality 8 or mode S"},
             {"run.vbo", honest.vbo("Created by GNSS Simulator 3"), typed_accuracy,
              "GNSS Simulator 3"},
             {"run.csv", honest.flysight("simulator-1"), "", "simulator-1"}}) {
        put(one.name, one.bytes);
        attempt(one.name, one.of_receiver, single_allowed);
        expect_simulated(one.name, one.said);
    }
}

TEST_F(Origins, AMarkOfTrackAndFlightSimulatorsIsRead) {  // got through, all
    const RecordedRun honest = RecordedRun::every(0.1);
    std::string gpx =
        "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"GPS SIMULATOR 2\" "
        "xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n";
    for (int k = 0; k < RecordedRun::epochs; ++k)
        gpx += fmt::format(
            "<trkpt lat=\"{:.9f}\" lon=\"{:.9f}\"><ele>{:.3f}</ele><time>"
            "2026-03-14T{}Z</time></trkpt>\n",
            honest.place(k).latitude_deg, honest.place(k).longitude_deg, honest.place(k).height_m,
            honest.clock(k, 3, ":"));
    put("run.gpx", gpx + "</trkseg></trk></gpx>\n");
    attempt("run.gpx", typed_accuracy + ", solution: fixed");
    expect_simulated("run.gpx", "GPS SIMULATOR 2");
    // As UTF-16, and with the mark in a comment behind the track.
    std::string other = gpx.replace(gpx.find("GPS SIMULATOR 2"), 15, "Logger") +
                        "</trkseg></trk></gpx>\n<!-- created with x-plane -->\n";
    std::string wide = "\xff\xfe";
    for (const char c : other)
        wide += std::string{c, '\0'};
    put("wide.gpx", wide);
    attempt("wide.gpx", typed_accuracy + ", solution: fixed");
    expect_simulated("wide.gpx", "x-plane");
}

TEST_F(Origins, AMarkStandsOnPageOneOfTheReport) {  // got through
    put("run.pos", "% program   : runcert simulate (simulated)\n" + RecordedRun::every(0.1).pos());
    attempt("run.pos");
    ASSERT_NE(certified({}).exit_status, 2);
    const std::string page = read_file(run() / "report.html");
    const std::size_t banner =
        page.find("<p class=\"caution\"><bdi>Simulated. The recording of receiver “primary” says");
    ASSERT_NE(banner, std::string::npos);
    EXPECT_LT(page.find("<section id=\"certificate\""), banner);
    EXPECT_LT(banner, page.find("<p class=\"outcome_"));
    EXPECT_LT(page.find("<section id=\"recording\""),
              page.find("<dt><bdi>The recording says</bdi></dt><dd><bdi>% program   : runcert "
                        "simulate"));
}

TEST_F(Origins, AStrippedMarkLeavesAClauseThatOnlyPeopleAnswer) {  // got through with a witness
    // Velocities agree: before, that met the clause.
    put("run.csv", RecordedRun::every(0.1).flysight());
    attempt("run.csv", "", "", "board");
    const ProfileVerdict found = verdict();
    EXPECT_FALSE(found.witnesses.empty());
    EXPECT_EQ(clause(found, "positions-as-measured").status, RequirementStatus::attest);
}

TEST_F(Origins, AnHonestRecordingIsNotSaidToBeSimulated) {
    const RecordedRun honest = RecordedRun::every(0.1);
    for (const auto& [name, bytes] :
         std::vector<std::pair<std::string, std::string>>{{"run.pos", honest.pos()},
                                                          {"run.nmea", honest.nmea()},
                                                          {"run.ubx", honest.ubx()},
                                                          {"run.oao", honest.oao()},
                                                          {"run.vbo", honest.vbo()},
                                                          {"run.csv", honest.flysight()}}) {
        put(name, bytes);
        EXPECT_FALSE(holds(inspected(name), "simulated")) << name;
    }
}

// From what a solution was made.

const std::string rtklib_header =
    "% program   : RTKPOST ver.2.4.3 b34\n% inp file  : C:\\Users\\someone\\other_day.obs\n"
    "% inp file  : /home/someone/base.obs\n% obs start : 2022/03/18 08:51:22.3 GPST\n"
    "% obs end   : 2022/03/18 09:51:22.3 GPST\n% pos mode  : kinematic\n% solution  : combined\n";

TEST_F(Origins, FromWhichFilesAPositionWasSolvedIsInReportEvidenceAndInspect) {  // got through
    put("run.pos", rtklib_header + RecordedRun::every(0.1).pos());
    attempt("run.pos");
    EXPECT_TRUE(
        holds(clause(verdict(), "positions-as-measured").evidence,
              "positions were solved by RTKPOST ver.2.4.3 b34 from other_day.obs, base.obs, "
              "as the recording's header says"));
    const std::string report = read_file(run() / "report.json");
    for (const char* part : {"other_day.obs", "base.obs", "pos mode: kinematic",
                             "solution: combined", "2022/03/18 08:51:22.3 GPST"})
        EXPECT_TRUE(holds(report, part)) << part;
    for (const auto& [name, text] : contents_of(run()))
        if (!holds(text, "%  GPST latitude")) {  // but for the recording's own copy
            EXPECT_FALSE(holds(text, "someone")) << name;
        }
    const std::string text = inspected("run.pos");
    for (const char* part : {"from other_day.obs, base.obs", "solution: combined"})
        EXPECT_TRUE(holds(text, part)) << text;
}

// Steps that no receiver makes.

struct Format {
    const char* name;
    std::string (*bytes)(const RecordedRun&);
    const char* of_receiver;
};
const Format formats_of_satellites[] = {
    {"run.pos", [](const RecordedRun& run) { return run.pos(); }, ""},
    {"run.nmea", [](const RecordedRun& run) { return run.nmea(); },
     ", accuracy: {horizontal_m: 0.01, vertical_m: 0.02}"},
    {"run.ubx", [](const RecordedRun& run) { return run.ubx(); }, ""},
    {"run.oao", [](const RecordedRun& run) { return run.oao(); }, ""},
    {"run.vbo", [](const RecordedRun& run) { return run.vbo(); },
     ", accuracy: {horizontal_m: 0.01, vertical_m: 0.02}"},
    {"run.csv", [](const RecordedRun& run) { return run.flysight(); }, ""},
};

TEST_F(Origins, StepsOf98MillisecondsAreNotTheSatellitesTimeInAnyFormat) {  // got through, all
    for (const Format& format : formats_of_satellites)
        for (const double step_s : {0.1, 0.098}) {
            SCOPED_TRACE(fmt::format("{} {}", format.name, step_s));
            put(format.name, format.bytes(RecordedRun::every(step_s)));
            attempt(format.name, format.of_receiver, single_allowed, "board");
            const Requirement scale = clause(verdict(), "time-scale");
            // Even steps meet it only beside a witness that another rate would contradict.
            EXPECT_TRUE(scale.status == RequirementStatus::attest ||
                        (step_s == 0.1 && holds(scale.evidence, "at another rate the witnesses")))
                << scale.evidence;
            EXPECT_EQ(holds(scale.evidence, "away from 0.1 s"), step_s != 0.1) << scale.evidence;
        }
}

TEST_F(Origins, TenHertzStampedAsTwelveAreNoReceiversTimeByTheirEvenSteps) {  // got through, all
    for (const double rate_hz : {12.0, 15.0, 16.0, 20.0, 25.0, 30.0}) {
        put("run.pos", RecordedRun::every(1.0 / rate_hz).pos());
        attempt("run.pos");
        const Requirement scale = clause(verdict(), "time-scale");
        EXPECT_EQ(scale.status, RequirementStatus::attest) << rate_hz;
        EXPECT_TRUE(holds(scale.evidence, "no witness shares the stamps")) << scale.evidence;
    }
}

TEST_F(Origins, OtherStepsThatNoReceiverMakesAreSeenAsWell) {  // got through, all
    const auto scale_of = [&](const RecordedRun& stamped) {
        put("run.pos", stamped.pos());
        attempt("run.pos");
        return clause(verdict(), "time-scale");
    };
    for (const double step_s : {0.095, 0.099, 0.0995, 0.093})
        EXPECT_EQ(scale_of(RecordedRun::every(step_s)).status, RequirementStatus::attest) << step_s;
    // Alternately 97 and 99 ms; 98 ms for five seconds alone; 2 ms more at first, less later on.
    RecordedRun uneven = RecordedRun::every(0.098), window = RecordedRun::every(0.1),
                made_up = RecordedRun::every(0.1);
    for (int k = 0; k < RecordedRun::epochs; ++k) {
        const auto at = static_cast<std::size_t>(k);
        if (k % 2 == 1) uneven.stamps_s[at] -= 0.001;
        window.stamps_s[at] -= 0.002 * std::clamp(k - 300, 0, 50);
        made_up.stamps_s[at] += 0.002 * std::clamp(k, 0, 50) - 0.002 * std::clamp(k - 300, 0, 50);
    }
    for (const RecordedRun& stamped : {uneven, window, made_up})
        EXPECT_EQ(scale_of(stamped).status, RequirementStatus::attest);
}

TEST_F(Origins, SatellitesTimeByTheAttemptsWordIsSaidToHaveOddSteps) {  // got through: not said
    std::string csv = "time,lat,lon,h\n";
    const RecordedRun stamped = RecordedRun::every(0.098);
    for (int k = 0; k < RecordedRun::epochs; ++k)
        csv += fmt::format("{:.3f},{:.9f},{:.9f},{:.4f}\n", stamped.stamps_s[std::size_t(k)],
                           stamped.place(k).latitude_deg, stamped.place(k).longitude_deg,
                           stamped.place(k).height_m);
    put("run.csv", csv);
    attempt("run.csv",
            ", format: csv, frame: geodetic, solution: fixed, time_source: satellites, "
            "columns: {time: time, latitude: lat, longitude: lon, height: h}" +
                typed_accuracy);
    const Requirement scale = clause(verdict(), "time-scale");
    EXPECT_EQ(scale.status, RequirementStatus::attest);
    EXPECT_TRUE(holds(scale.evidence, "lead ")) << scale.evidence;
}

// A typed height.

std::string flat_csv() {
    const RecordedRun run = RecordedRun::every(0.1);
    std::string csv = "time,lat,lon\n";
    for (int k = 0; k < RecordedRun::epochs; ++k)
        csv += fmt::format("{:.1f},{:.9f},{:.9f}\n", 0.1 * k, run.place(k).latitude_deg,
                           run.place(k).longitude_deg);
    return csv;
}

std::string flat_receiver(double height_m) {
    return fmt::format(
        ", format: csv, frame: geodetic, solution: fixed, height_m: {:g}, columns: "
        "{{time: time, latitude: lat, longitude: lon}}, accuracy: {{horizontal_m: "
        "0.01}}",
        height_m);
}

TEST_F(Origins, ATypedHeightWhereNoCraftOfTheClassRunsIsRefused) {  // got through, all
    put("run.csv", flat_csv());
    for (const auto& [craft, height_m] :
         std::vector<std::pair<std::string, double>>{{"land-yacht", 20000},
                                                     {"land-yacht", 5201},
                                                     {"ice-yacht", -121},
                                                     {"sail-boat", 20000},
                                                     {"board", 5001},
                                                     {"car", 6001},
                                                     {"land-yacht", -451}}) {
        attempt("run.csv", flat_receiver(height_m), "", craft);
        const ProcessResult refused = certified();
        EXPECT_EQ(refused.exit_status, 2) << craft << height_m;
        for (const std::string& part :
             {std::string("attempt.yaml:5:"), "no " + craft + " runs at a height of",
              std::string("Give the course's height")})
            EXPECT_TRUE(holds(refused.errors, part)) << refused.errors;
    }
}

TEST_F(Origins, WhatATypedHeightAddsIsWithinItsRowOfTheBudget) {  // got through: no row
    put("run.csv", flat_csv());
    const auto at = [&](double height_m) {
        attempt("run.csv", flat_receiver(height_m));
        return verdict();
    };
    const ProfileVerdict low = at(0), high = at(150);
    // 150 m in Earth radii, to a tenth: the positions are rounded.
    const double added_m_s = *high.speed_m_s - *low.speed_m_s;
    EXPECT_NEAR(added_m_s, 64.0 * 150 / 6.37e6, 2e-4);
    const std::string windows = read_file(run() / "5-windows.yaml");
    EXPECT_TRUE(holds(windows, "height of the course, as the attempt states it"));
    EXPECT_TRUE(holds(windows, "150 m allowed for"));
    EXPECT_TRUE(
        holds(read_file(run() / "report.json"), "Height of the course stated by the attempt"));
}

// Fix types.

TEST_F(Origins, APositionWhoseFixTypeNobodyStatesCountsAsSingleUnderEveryClass) {  // got through
    put("run.csv", flat_csv());
    std::string unstated = flat_receiver(110);
    unstated.erase(unstated.find("solution: fixed, "), 17);
    for (const char* craft : {"land-yacht", "ice-yacht", "sail-boat", "car", "other"}) {
        SCOPED_TRACE(craft);
        attempt("run.csv", unstated, "", craft);
        const ProfileVerdict refused = verdict();
        EXPECT_EQ(refused.outcome, Outcome::not_certifiable);
        EXPECT_TRUE(holds(refused.reason, "write solution: fixed in the receiver"))
            << refused.reason;
        // What it says to write works, and is a claim.
        attempt("run.csv", flat_receiver(110), "", craft);
        const ProfileVerdict claimed = verdict();
        EXPECT_TRUE(claimed.speed_m_s.has_value()) << claimed.reason;
        EXPECT_EQ(clause(claimed, "kind-of-solution").status, RequirementStatus::attest);
    }
    for (const char* craft : {"board", "skydiver"}) {  // single is enough
        attempt("run.csv", unstated, "", craft);
        EXPECT_TRUE(verdict().speed_m_s.has_value()) << craft;
    }
}

TEST_F(Origins, UnknownInAllowedFixesIsAnotherWordForSingle) {  // got through: it let unknown in
    put("run.csv", flat_csv());
    std::string unstated = flat_receiver(110);
    unstated.erase(unstated.find("solution: fixed, "), 17);
    std::string single = flat_receiver(110);
    single.replace(single.find("solution: fixed"), 15, "solution: single");
    for (const char* allowed : {"[unknown]", "[single]", "[fixed, unknown]"})
        for (const std::string& receiver : {unstated, single}) {
            attempt("run.csv", receiver,
                    fmt::format("parameters: {{screen: {{allowed_fixes: {}}}}}\n", allowed));
            EXPECT_TRUE(verdict().speed_m_s.has_value()) << allowed << receiver;
        }
    attempt("run.csv", unstated, "parameters: {screen: {allowed_fixes: [fixed]}}\n");  // held
    EXPECT_FALSE(verdict().speed_m_s.has_value());
}

TEST_F(Origins, FixTypesThatAFormatDoesNotKnowCountAsSingle) {  // got through, both
    const RecordedRun honest = RecordedRun::every(0.1);
    put("odd.nmea", honest.nmea('7', 'M'));
    attempt("odd.nmea", typed_accuracy);
    EXPECT_EQ(verdict().outcome, Outcome::not_certifiable);
    put("run.nmea", honest.nmea());
    attempt("run.nmea", typed_accuracy);
    EXPECT_TRUE(verdict().speed_m_s.has_value());
}

// Two attempts of a day on one recording.

class OriginsOfADay : public Origins {
  protected:
    /// day.yaml of attempts on these recordings, each with its own text for the receiver.
    std::string notes_of(const std::vector<std::pair<std::string, std::string>>& recordings) const {
        std::string day =
            "schema: day/1.0\nid: day\ndefaults:\n  craft: {name: y, class: "
            "land-yacht}\n  profiles: [nalsa]\nattempts:\n";
        for (std::size_t i = 0; i < recordings.size(); ++i)
            day +=
                fmt::format("  - {{id: run-{}, receivers: [{{id: primary, recording: {}{}}}]}}\n",
                            i + 1, recordings[i].first, recordings[i].second);
        put("day.yaml", day);
        fs::remove_all(run());
        const ProcessResult result = runcert({"batch", path("day.yaml").string(), "--out",
                                              run().string(), "--no-render", "--jobs", "1"});
        EXPECT_NE(result.exit_status, 2) << result.errors;
        std::string notes;
        const YamlValue results = read_yaml(run() / "day.yaml");
        for (const YamlValue& attempt : results["attempts"].list())
            for (const YamlValue& note : attempt["notes"].list()) {
                notes += attempt["id"].text() + ": " + note.text() + "\n";
                EXPECT_TRUE(holds(read_file(run() / "day.html"), note.text())) << note.text();
                EXPECT_TRUE(holds(read_file(run() / "day.csv"), note.text())) << note.text();
            }
        return notes;
    }
    /// The rows of a .pos from one to another.
    static std::string cut(const std::string& pos, std::size_t from, std::size_t to) {
        std::string text;
        std::size_t line = 0;
        for (std::size_t begin = 0; begin < pos.size(); ++line) {
            const std::size_t end = pos.find('\n', begin) + 1;
            if (line == 0 || (line > from && line <= to)) text += pos.substr(begin, end - begin);
            begin = end;
        }
        return text;
    }
};

TEST_F(OriginsOfADay, OneRecordingUnderTwoNamesIsNamedInBoth) {  // got through
    const std::string pos = RecordedRun::every(0.1).pos();
    put("a.pos", pos);
    put("b.pos", pos);
    EXPECT_EQ(notes_of({{"a.pos", ""}, {"b.pos", ""}}),
              "run-1: It rests on the same recording, byte for byte, as run-2.\n"
              "run-2: It rests on the same recording, byte for byte, as run-1.\n");
}

TEST_F(OriginsOfADay, RecordingsThatOverlapAreNamedInBoth) {  // got through, all
    const RecordedRun run = RecordedRun::every(0.1);
    const std::string pos = run.pos();
    put("whole.pos", pos);
    put("cut.pos", cut(pos, 100, 400));
    put("commented.pos", "% another day\n" + pos);
    std::string csv = "time,lat,lon,h\n";
    for (int k = 0; k < RecordedRun::epochs; ++k)
        csv += fmt::format("2026-03-14T{},{:.8f},{:.8f},{:.3f}\n", run.clock(k, 3, ":"),
                           run.place(k).latitude_deg, run.place(k).longitude_deg,
                           run.place(k).height_m);
    put("converted.csv", csv);
    const std::string of_csv =
        ", format: csv, frame: geodetic, solution: fixed, time_format: iso, columns: {time: time, "
        "latitude: lat, longitude: lon, height: h}, accuracy: {horizontal_m: 0.01, vertical_m: "
        "0.02}";
    EXPECT_EQ(
        notes_of({{"whole.pos", ""}, {"cut.pos", ""}}),
        "run-1: Its recording overlaps that of run-2: up to 300 epochs have the same time and "
        "position.\n"
        "run-2: Its recording overlaps that of run-1: up to 300 epochs have the same time and "
        "position.\n");
    for (const auto& [file, receiver] : std::vector<std::pair<std::string, std::string>>{
             {"commented.pos", ""}, {"converted.csv", of_csv}})
        EXPECT_TRUE(holds(notes_of({{"whole.pos", ""}, {file, receiver}}),
                          "run-2: Its recording overlaps that of run-1"))
            << file;
    // Moved to another hour.
    RecordedRun later = run;
    for (double& stamp_s : later.stamps_s)
        stamp_s += 3600.0;
    put("later.pos", later.pos());
    EXPECT_TRUE(holds(
        notes_of({{"whole.pos", ""}, {"later.pos", ""}}),
        "run-2: Its recording repeats that of run-1, at other times, elsewhere, turned or without "
        "a date: up to "));
    // Moved by kilometres or turned, and at another hour: got through.
    for (const auto& [north_m, turned_rad] : {std::pair{1000.0, 0.0}, {0.0, 1.0}, {5000.0, 3.0}}) {
        std::string moved = "time,lat,lon,h\n";
        const auto from = run.place(0);
        const double scale = std::cos(from.latitude_deg * std::numbers::pi / 180.0);
        const double c = std::cos(turned_rad), s = std::sin(turned_rad);
        for (int k = 0; k < RecordedRun::epochs; ++k) {
            const double north = run.place(k).latitude_deg - from.latitude_deg,
                         east = (run.place(k).longitude_deg - from.longitude_deg) * scale;
            moved += fmt::format("2026-03-14T{},{:.8f},{:.8f},{:.3f}\n", later.clock(k, 3, ":"),
                                 from.latitude_deg + north_m / 111'320.0 + c * north + s * east,
                                 from.longitude_deg + (c * east - s * north) / scale,
                                 run.place(k).height_m);
        }
        put("moved.csv", moved);
        EXPECT_TRUE(holds(notes_of({{"whole.pos", ""}, {"moved.csv", of_csv}}),
                          "run-2: Its recording repeats that of run-1, at other times"))
            << north_m << " " << turned_rad;
    }
    // Two cuts that meet without an epoch in common are two recordings.
    put("first.pos", cut(pos, 0, 300));
    put("second.pos", cut(pos, 300, 600));
    EXPECT_EQ(notes_of({{"first.pos", ""}, {"second.pos", ""}}), "");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
