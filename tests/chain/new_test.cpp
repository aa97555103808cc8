#include <fmt/format.h>
#include <gtest/gtest.h>

#include "chain_support.h"
#include "core/text.h"
#include "schemas/attempt/attempt.h"

// An attempt from a recording: what is asked and what is not, and that it certifies.

namespace runcert::chain::RUNCERT_FILE {
namespace {

const fs::path tables = fs::path(RUNCERT_SOURCE_DIR) / "tests" / "chain" / "data" / "tables";

using Words = std::vector<std::string>;

bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

ProcessResult make_new(const Words& recordings, const Words& more = {}) {
    Words arguments{"new"};
    arguments.insert(arguments.end(), recordings.begin(), recordings.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runcert(arguments);
}

const Words answers{"--craft",  "Yacht",   "--class",    "land-yacht",      "--rule",  "nalsa",
                    "--record", "90 km/h", "--source",   "a record",        "--place", "a lake",
                    "--pilot",  "Bo Ek",   "--official", "measurer Ann Lee"};

Words with(const Words& more) {
    Words all = answers;
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

/// With its lines joined, so that a sentence is found wherever it was broken.
std::string lines_as_one(const std::string& text) {
    std::string joined;
    for (const std::string& line : lines_of(text))
        joined += (joined.empty() ? "" : " ") + std::string(trim(line));
    return joined;
}

/// Types these lines at the terminal, as `script` makes one; without more it is closed.
ProcessResult typed(const std::string& command, const std::string& lines) {
    return run_process({"sh", "-c",
                        fmt::format("printf '{}' | script -qec '{}/{}' /dev/null", lines,
                                    RUNCERT_PROGRAMS, command)});
}

TEST(New, WritesAnAttemptThatCertifies) {
    const TemporaryFolder folder;
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    const ProcessResult made = make_new({recording}, answers);
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_TRUE(has(made.output, "rtklib-pos; ")) << made.output;
    EXPECT_TRUE(has(made.output, "next     runcert certify")) << made.output;
    // No question whose answer is in the file: what remains is the antenna.
    EXPECT_TRUE(has(made.output, "receivers.primary.antenna_height_m"));
    EXPECT_FALSE(has(made.output, "required")) << made.output;
    const fs::path attempt = folder.path() / "attempt.yaml";
    const Attempt read = read_attempt(read_file(attempt), "attempt.yaml");
    EXPECT_EQ(read.craft.name, "Yacht");
    EXPECT_EQ(read.pilot, "Bo Ek");
    EXPECT_EQ(read.record->speed, 90.0);
    const ProcessResult run = certify(attempt, folder.path() / "run", {"--no-render"});
    EXPECT_EQ(run.exit_status, 0) << run.errors << run.output;
    // Never over a file.
    const std::string before = read_file(attempt);
    const ProcessResult again = make_new({recording}, answers);
    EXPECT_EQ(again.exit_status, 2);
    EXPECT_TRUE(has(again.errors, "not written over") && has(again.errors, "--out"))
        << again.errors;
    EXPECT_EQ(read_file(attempt), before);
    EXPECT_EQ(make_new({recording}, with({"--out", folder.path() / "other.yaml"})).exit_status, 0);
    // Said before anything is asked.
    const ProcessResult nowhere =
        make_new({recording}, with({"--out", folder.path() / "none" / "a.yaml"}));
    EXPECT_EQ(nowhere.exit_status, 2);
    EXPECT_TRUE(has(nowhere.errors, "no such folder")) << nowhere.errors;
    fs::create_directory(folder.path() / "below");
    const ProcessResult below =
        make_new({recording}, with({"--out", folder.path() / "below" / "a.yaml"}));
    EXPECT_TRUE(has(below.errors, "in its own folder")) << below.errors;
}

TEST(New, NamesAllGapsAtOnceAndLeavesLinesForThem) {
    const TemporaryFolder folder;
    const std::string recording = folder.path() / bring(tables / "us_dates.csv", folder.path());
    const ProcessResult made = make_new({recording});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    for (const char* key : {"craft.name: Name of the craft (required)", "craft.class", "profiles",
                            "record.speed", "height_m", "accuracy.horizontal_m", "solution"})
        EXPECT_TRUE(has(made.output, key)) << key << made.output;
    EXPECT_TRUE(has(made.output, "columns.latitude")) << made.output;
    EXPECT_TRUE(has(made.output, "2026-03-14T13:00:18.000Z, latitude 52.1000000")) << made.output;
    EXPECT_TRUE(has(made.output, "complete what is required"));
    const std::string text = read_file(folder.path() / "attempt.yaml");
    EXPECT_TRUE(has(text, "    # height_m: ...  # ")) << text;
    EXPECT_TRUE(has(text, "# craft:\n#   name: ")) << text;
}

TEST(New, AsksAtATerminal) {
    const TemporaryFolder folder;
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    // Name, kind (a wrong one first), rule by Enter, pilot left out, place, an official, a record
    // without its unit and with it, its source, no antenna, and that it is to be written.
    const ProcessResult made = typed(
        "runcert new " + recording,
        "Greenbird\\nship\\nLand yacht\\n\\n\\na lake\\nmeasurer\\nAnn Lee\\n\\n202.9\\n202.9 "
        "kmh\\nNALSA\\n\\n\\n");
    ASSERT_EQ(made.exit_status, 0) << made.output;
    EXPECT_TRUE(has(made.output, "\"ship\" is not one of land-yacht")) << made.output;
    EXPECT_TRUE(has(made.output, "names no unit")) << made.output;
    const Attempt read = read_attempt(read_file(folder.path() / "attempt.yaml"), "attempt.yaml");
    EXPECT_EQ(read.craft.name, "Greenbird");
    EXPECT_EQ(read.craft.kind, "land-yacht");
    EXPECT_EQ(read.profiles, Words{"nalsa"});
    EXPECT_EQ(read.pilot, "");
    EXPECT_EQ(read.place, "a lake");
    EXPECT_EQ(read.record->source, "NALSA");
    EXPECT_EQ(read.officials.at(0).name, "Ann Lee");
    ASSERT_EQ(read.officials.size(), 1U);
    EXPECT_LT(made.output.find("name Greenbird, class land-yacht"), made.output.find("Write this?"))
        << made.output;
}

TEST(New, WritesNothingThatIsNotWanted) {
    const TemporaryFolder folder;
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    const auto before = contents_of(folder.path());
    const ProcessResult made =
        typed("runcert new " + recording,
              "Greenbird\\n1\\n\\n\\na lake\\n\\n202.9 km/h\\nNALSA\\n\\nn\\n");
    EXPECT_EQ(made.exit_status, 1) << made.output;
    EXPECT_TRUE(has(made.output, "nothing was written")) << made.output;
    EXPECT_EQ(contents_of(folder.path()), before);
}

TEST(New, AnInterruptedDialogueLeavesNoFile) {
    const TemporaryFolder folder;
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    const auto before = contents_of(folder.path());
    // The terminal is closed; Ctrl-C.
    const ProcessResult closed = typed("runcert new " + recording, "Greenbird\\nland-yacht\\n");
    EXPECT_EQ(closed.exit_status, 2) << closed.output;
    EXPECT_TRUE(has(closed.output, "nothing was written")) << closed.output;
    EXPECT_EQ(contents_of(folder.path()), before);
    EXPECT_NE(typed("runcert new " + recording, "Greenbird\\n\\003").exit_status, 0);
    EXPECT_EQ(contents_of(folder.path()), before);
}

TEST(New, SaysOfNonsenseWhatItIs) {
    const TemporaryFolder folder;
    const auto write = [&](const std::string& name, const std::string& bytes) {
        write_file_atomically(folder.path() / name, bytes);
        return (folder.path() / name).string();
    };
    fs::create_directory(folder.path() / "folder");
    const struct {
        std::string file, said;
    } cases[] = {{write("letter.txt", "Dear official,\nI was fast.\n"), "Formats that are read"},
                 {write("run.zip", "PK\x03\x04 and so on, a good deal of it"), "Unpack it"},
                 {write("empty.csv", ""), "empty"},
                 {folder.path() / "missing.pos", "missing.pos"},
                 {folder.path() / "folder", "runcert new --day"},
                 {write("old.yaml", "schema: attempt/1.0\n"), "runcert certify"}};
    for (const auto& one : cases) {
        const ProcessResult made = make_new({one.file});
        EXPECT_EQ(made.exit_status, 2) << one.file;
        EXPECT_TRUE(has(made.errors, one.said)) << made.errors;
        EXPECT_TRUE(has(made.errors, "what to do")) << made.errors;
    }
    bring(examples / "salt_lake" / "recording.pos", folder.path());
    fs::rename(folder.path() / "recording.pos", folder.path() / "run\x1b[1m.pos");
    const ProcessResult steering = make_new({folder.path() / "run\x1b[1m.pos"});
    EXPECT_EQ(steering.exit_status, 2);
    EXPECT_TRUE(has(steering.errors, "name holds a character")) << steering.errors;
    EXPECT_FALSE(has(steering.errors, "\x1b"));
    EXPECT_FALSE(fs::exists(folder.path() / "attempt.yaml"));
    EXPECT_EQ(make_new({}).exit_status, 2);
    // Wrong answers, of which nothing is written.
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    const std::pair<Words, std::string> answers_of[] = {
        {{"--record", "440,5 km/h"}, "decimal comma"},
        {{"--class", "ship"}, "--class"},
        {{"--rule", "nalsaa"}, "Did you mean nalsa"},
        {{"--set", "solution"}, "KEY=VALUE"},
        {{"--set", "colour=red"}, "no such key"}};
    for (const auto& [words, said] : answers_of) {
        const ProcessResult made = make_new({recording}, words);
        EXPECT_EQ(made.exit_status, 2);
        EXPECT_TRUE(has(made.errors, said)) << made.errors;
    }
    EXPECT_FALSE(fs::exists(folder.path() / "attempt.yaml"));
}

TEST(New, IsOfferedToWhoCertifiesARecording) {
    const TemporaryFolder folder;
    const fs::path recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    for (const fs::path& file : {recording, tables / "edgetx.csv"}) {
        const ProcessResult result = certify(file, folder.path() / "run");
        EXPECT_EQ(result.exit_status, 2);
        EXPECT_TRUE(has(result.errors, "This is a recording")) << result.errors;
        EXPECT_TRUE(has(result.errors, "runcert new " + file.string())) << result.errors;
    }
    // What is neither says what an attempt must be.
    write_file_atomically(folder.path() / "letter.txt", "Dear official\n");
    EXPECT_TRUE(
        has(certify(folder.path() / "letter.txt", folder.path() / "run").errors, "not an attempt"));
    EXPECT_FALSE(fs::exists(folder.path() / "run"));
}

TEST(New, TablesOfOtherProgramsCertifyWithWhatIsAskedFor) {
    const std::map<std::string, Words> needed{
        {"gpslogger_android", {"--set", "accuracy.vertical_m=5"}},
        {"sensor_logger_ios", {}},
        {"edgetx",
         {"--set", "accuracy.horizontal_m=0.5", "--set", "accuracy.vertical_m=1", "--set",
          "time_scale=local", "--set", "utc_offset_h=1"}},
        {"gpsbabel_unicsv",
         {"--set", "accuracy={horizontal_m: 0.5, vertical_m: 1}", "--set", "time_scale=utc"}},
        {"us_dates", {"--set", "height_m=44", "--set", "accuracy.horizontal_m=0.5"}},
        {"laptimer",
         {"--set", "start_date=2026-03-14", "--set",
          "accuracy={horizontal_m: 0.5, vertical_m: 1}"}},
        {"racelogic_export",
         {"--set", "start_date=2026-03-14", "--set",
          "accuracy={horizontal_m: 0.5, vertical_m: 1}"}},
        {"waypoint_export", {}},
        {"utm_survey", {"--set", "frame=31 north"}},
        {"unclear_date",
         {"--set", "start_date=2026-03-04", "--set",
          "accuracy={horizontal_m: 0.5, vertical_m: 1}"}}};
    for (const auto& [program, more] : needed) {
        SCOPED_TRACE(program);
        const TemporaryFolder folder;
        const std::string recording =
            folder.path() / bring(tables / (program + ".csv"), folder.path());
        Words all = with(more);
        all.insert(all.end(), {"--set", "solution=fixed", "--set", "time_source=satellites"});
        const ProcessResult made = make_new({recording}, all);
        ASSERT_EQ(made.exit_status, 0) << made.errors;
        EXPECT_FALSE(has(made.output, "(required)")) << made.output;
        EXPECT_FALSE(has(made.output, "not yet")) << made.output;
        const fs::path run = folder.path() / "run";
        const ProcessResult certified =
            certify(folder.path() / "attempt.yaml", run, {"--no-render"});
        EXPECT_LE(certified.exit_status, 1) << certified.errors;
        const YamlValue verdict = read_yaml(run / "6-verdict.yaml")["profiles"].list().at(0);
        // 90 km/h are reached, and a second of samples shows about that.
        if (verdict["speed_km_h"].exists())
            EXPECT_NEAR(verdict["speed_km_h"].real(), 90.0, 2.0);
        else
            EXPECT_NEAR(verdict["indicated"]["speed_km_h"].real(), 90.0, 2.0);
    }
}

TEST(New, SeveralRecordingsAreReceiversOrFollowEachOther) {
    const TemporaryFolder folder;
    const std::string first = folder.path() / bring(tables / "edgetx.csv", folder.path());
    const std::string second = folder.path() / bring(tables / "us_dates.csv", folder.path());
    const ProcessResult made = make_new({first, second}, answers);
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_TRUE(has(made.output, "us_dates.csv was recorded at the same time and place"))
        << made.output;
    const YamlValue read = read_yaml(folder.path() / "attempt.yaml");
    ASSERT_EQ(read["receivers"].list().size(), 2U);
    EXPECT_EQ(read["receivers"].list()[1]["id"].text(), "secondary");
    EXPECT_TRUE(has(made.output, "receivers.secondary.height_m"));
    // A table cut in two, named in the wrong order.
    const std::string text = read_file(tables / "gpsbabel_unicsv.csv");
    const std::size_t half = text.find("\n20,") + 1;
    const std::string head = text.substr(0, text.find('\n') + 1);
    fs::create_directory(folder.path() / "parts");
    write_file_atomically(folder.path() / "parts" / "a.csv", text.substr(0, half));
    write_file_atomically(folder.path() / "parts" / "b.csv", head + text.substr(half));
    const ProcessResult parts = make_new(
        {folder.path() / "parts" / "b.csv", folder.path() / "parts" / "a.csv"},
        with({"--set", "accuracy={horizontal_m: 0.5, vertical_m: 1}", "--set", "solution=fixed"}));
    ASSERT_EQ(parts.exit_status, 0) << parts.errors;
    EXPECT_TRUE(has(parts.output, "b.csv follows a.csv: they are one recording")) << parts.output;
    const YamlValue files =
        read_yaml(folder.path() / "parts" / "attempt.yaml")["receivers"].list().at(0)["recording"];
    EXPECT_EQ(files.list().at(0).text(), "a.csv");
    EXPECT_LE(
        certify(folder.path() / "parts" / "attempt.yaml", folder.path() / "run", {"--no-render"})
            .exit_status,
        1);
}

TEST(New, ASeriesBesideARecordingIsNamedUnderItsKey) {
    const TemporaryFolder folder;
    const std::string recording =
        folder.path() / bring(examples / "salt_lake" / "recording.pos", folder.path());
    std::string series = "time_s,speed_m_s\n";
    for (int i = 0; i < 450; ++i)
        series += fmt::format("{:.1f},{:.2f}\n", 0.1 * i, 0.1 * i);
    const std::string wheel = folder.path() / "rear.csv";
    write_file_atomically(wheel, series);
    const ProcessResult open = make_new({recording, wheel}, answers);
    ASSERT_EQ(open.exit_status, 0) << open.errors;
    EXPECT_TRUE(has(open.output, "wheel.source")) << open.output;
    EXPECT_TRUE(has(open.output, "(required)")) << open.output;
    const fs::path attempt = folder.path() / "with.yaml";
    const ProcessResult made = make_new(
        {recording, wheel}, with({"--set", "wheel.source=rear wheel", "--out", attempt.string()}));
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_FALSE(has(made.output, "(required)")) << made.output;
    EXPECT_LE(certify(attempt, folder.path() / "run", {"--no-render"}).exit_status, 1);
    EXPECT_TRUE(fs::exists(folder.path() / "run" / "wheel.csv"));
    const ProcessResult alone = make_new({wheel}, {"--out", folder.path() / "alone.yaml"});
    EXPECT_EQ(alone.exit_status, 2);
    EXPECT_TRUE(has(alone.errors, "a series, and no recording")) << alone.errors;
    const ProcessResult twice =
        make_new({recording, recording}, {"--out", folder.path() / "t.yaml"});
    EXPECT_TRUE(has(twice.errors, "named twice")) << twice.errors;
}

TEST(New, ASurfaceBesideARecordingIsArrangedWithWhatItsFileDoesNotSay) {
    const TemporaryFolder folder;
    Words files;
    for (const char* name : {"recording.pos", "surface.xml", "imu.csv"})
        files.push_back(folder.path() / bring(examples / "oval" / name, folder.path()));
    const ProcessResult open =
        make_new(files, {"--no-questions", "--out", (folder.path() / "open.yaml").string()});
    ASSERT_EQ(open.exit_status, 0) << open.errors;
    for (const char* part :
         {"the surface of a course (landxml); 600 vertices, 894 triangles",
          "receivers.primary.surface.frame", "may be local_plane",
          "receivers.primary.surface.source", "receivers.primary.antenna_height_m"})
        EXPECT_TRUE(has(lines_as_one(open.output), part)) << part << open.output;
    EXPECT_TRUE(has(read_file(folder.path() / "open.yaml"), "# in surface: frame: ..."));
    const ProcessResult made = make_new(
        files,
        with({"--set", "surface.frame=local_plane", "--set", "surface.source=a survey", "--set",
              "surface.vertical_sd_m=0.02", "--set", "antenna_height_m=1.5", "--set",
              "origin={latitude_deg: 34.0862, longitude_deg: -117.5008, height_m: 290.0}", "--set",
              "imu.grade=tactical", "--set",
              "imu.antenna_m={forward: -0.5, right: 0.2, down: -1.2}"}));
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const fs::path attempt = folder.path() / "attempt.yaml";
    const ProcessResult certified = certify(attempt, folder.path() / "run", {"--no-render"});
    EXPECT_EQ(certified.exit_status, 0) << certified.errors << read_file(attempt);
    EXPECT_TRUE(has(certified.output, "0 of 281 heights rejected")) << certified.output;
    const ProcessResult inspected = runcert({"inspect", files[1]});
    EXPECT_TRUE(has(inspected.output, "Triangles        894")) << inspected.output;
    EXPECT_TRUE(has(inspected.output, "Northing ")) << inspected.output;
}

TEST(New, ADayHasAnAttemptForEachRecording) {
    const TemporaryFolder folder;
    const fs::path day = folder.path() / "lake";
    fs::create_directory(day);
    bring(examples / "salt_lake" / "recording.pos", day);
    bring(tables / "waypoint_export.csv", day);
    write_file_atomically(day / "letter.txt", "Dear official,\nI was fast.\n");
    const ProcessResult made = make_new({}, with({"--day", day, "--set", "solution=fixed"}));
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    EXPECT_TRUE(has(made.output, "letter.txt: ")) << made.output;
    const ProcessResult run = runcert({"batch", (day / "day.yaml").string(), "--out",
                                       (folder.path() / "out").string(), "--no-render"});
    EXPECT_EQ(run.exit_status, 0) << run.errors << run.output;
    for (const char* id : {"recording", "waypoint_export"})
        EXPECT_TRUE(fs::exists(folder.path() / "out" / id / "report.json")) << id;
    EXPECT_EQ(make_new({}, with({"--day", day})).exit_status, 2);
    EXPECT_EQ(make_new({}, {"--day", folder.path() / "none"}).exit_status, 2);
}

/// Files of a folder that is not there everywhere, and of the cases beside it.
std::vector<fs::path> real_files(const fs::path& data) {
    std::vector<fs::path> files;
    for (const fs::path& folder : {data, data.parent_path() / "cases"}) {
        if (!fs::is_directory(folder)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            const std::string suffix = entry.path().extension().string();
            if (entry.is_regular_file() && suffix != ".md" && suffix != ".txt" && suffix != ".yaml")
                files.push_back(entry.path());
        }
    }
    std::ranges::sort(files);
    return files;
}

TEST(New, EveryRealRecordingIsWrittenOrSaidWhatItIs) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    std::size_t certified = 0;
    for (const fs::path& file : real_files(*data)) {
        SCOPED_TRACE(file.string());
        const TemporaryFolder folder;
        const std::string recording = folder.path() / bring(file, folder.path());
        const ProcessResult made = make_new({recording}, answers);
        if (made.exit_status == 2) {
            EXPECT_TRUE(has(made.errors, "what to do")) << made.errors;
            EXPECT_FALSE(fs::exists(folder.path() / "attempt.yaml"));
            continue;
        }
        ASSERT_EQ(made.exit_status, 0) << made.errors;
        // It runs, or what is missing is said in one list, and with that it runs. Long ones take
        // their time elsewhere.
        constexpr std::uintmax_t long_bytes = 300'000;
        fs::path attempt = folder.path() / "attempt.yaml";
        if (has(made.output, "receivers.primary.base")) continue;
        if (fs::file_size(file) > long_bytes) continue;
        if (has(made.output, "(required)")) {
            attempt = folder.path() / "complete.yaml";
            const ProcessResult complete =
                make_new({recording}, with({"--set", "accuracy={horizontal_m: 0.5, vertical_m: 1}",
                                            "--set", "height_m=40", "--out", attempt.string()}));
            ASSERT_EQ(complete.exit_status, 0) << complete.errors;
            EXPECT_FALSE(has(complete.output, "(required)")) << complete.output;
        }
        EXPECT_FALSE(has(made.output, "not yet")) << made.output;
        const ProcessResult run = certify(attempt, folder.path() / "run", {"--no-render"});
        EXPECT_LE(run.exit_status, 1) << run.errors << read_file(attempt);
        ++certified;
    }
    EXPECT_GE(certified, 15U);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
