#include <fmt/format.h>
#include <gtest/gtest.h>

#include "chain_support.h"
#include "schemas/observations/observations.h"

// Real recordings of every format that there are any of, certified as an official would.

namespace runcert::chain::RUNCERT_FILE {
namespace {

struct Given {
    const char* name;
    std::vector<const char*> files;  ///< the first is the recording
    const char* craft;
    const char* receiver;  ///< more of it
    const char* format;    ///< that was recognised
    std::size_t epochs;
    const char* outcome;
    double speed_km_h;  ///< 0 where there is no certifiable window
    double tolerance_km_h;
    std::vector<const char*> said;  ///< in the verdict
};

void PrintTo(const Given& given, std::ostream* out) {
    *out << given.name;
}

class Formats : public testing::TestWithParam<Given> {};

TEST_P(Formats, AreCertifiedOrRefusedWithTheirReason) {
    const Given& given = GetParam();
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    for (const char* file : given.files)
        bring(*data / file, folder.path());
    write_file_atomically(
        folder.path() / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: recorded\ncraft: {{name: craft, class: {}}}\n"
                    "receivers: [{{id: primary, recording: {}{}}}]\n"
                    "record: {{speed: 10, unit: km/h, source: none}}\nprofiles: [nalsa]\n",
                    given.craft, fs::path(given.files.front()).filename().string(),
                    given.receiver));
    const fs::path run = folder.path() / "run";
    const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
    if (given.outcome == std::string("refused")) {
        EXPECT_EQ(result.exit_status, 2) << result.output;
        for (const char* words : given.said)
            EXPECT_NE(result.errors.find(words), std::string::npos) << words << result.errors;
        return;
    }
    ASSERT_NE(result.exit_status, 2) << result.errors;
    const Observations observations =
        read_observations(read_file(run / "1-observations.ecsv"), "1-observations");
    EXPECT_EQ(observations.format, given.format);
    EXPECT_EQ(observations.rows.size(), given.epochs);
    const std::string verdict_text = read_file(run / "6-verdict.yaml");
    const YamlValue profile = read_yaml(run / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_EQ(profile["outcome"].text(), given.outcome) << verdict_text;
    if (given.tolerance_km_h > 0.0)
        EXPECT_NEAR(profile["speed_km_h"].real(), given.speed_km_h, given.tolerance_km_h);
    else
        EXPECT_FALSE(profile["speed_km_h"].exists());
    for (const char* words : given.said)
        EXPECT_NE(verdict_text.find(words), std::string::npos) << words << "\n" << verdict_text;
    // And it can be made again from the run folder alone.
    EXPECT_EQ(runcert({"audit", run.string()}).exit_status, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Real, Formats,
    testing::Values(Given{"NmeaStandingStill",
                          {"nmea_gst/static_skytraq.nmea"},
                          "board",
                          "",
                          "nmea",
                          96,
                          "not_certifiable",  // of one receiver alone, 0.5 m at least
                          0.0,
                          0.3,
                          {}},
                    Given{"Ubx",
                          {"ubx_walk/rover.ubx"},
                          "board",
                          "",
                          "ubx",
                          536,
                          "not_beaten",  // by its velocities the positions are better than stated
                          5.0,
                          0.2,
                          {"the recorded velocities give"}},
                    // A VBO states no fix type that a car's rule allows, and no accuracy.
                    Given{"VboOfACar",
                          {"race_car_vbo/run_a.vbo"},
                          "car",
                          ", accuracy: {horizontal_m: 0.3, vertical_m: 0.6}",
                          "vbo",
                          5675,
                          "not_certifiable",
                          0.0,
                          0.0,
                          {"fix type not allowed"}},
                    Given{"VboWithoutAccuracy",
                          {"race_car_vbo/run_a.vbo"},
                          "board",
                          "",
                          "vbo",
                          5675,
                          "refused",
                          0.0,
                          0.0,
                          {"states no accuracy of its positions"}},
                    Given{"FlySightWithBadAccuracyAndGaps",
                          {"speed_skydive/flysight1_bad_accuracy_gaps.csv"},
                          "skydiver",
                          "",
                          "flysight",
                          6731,
                          "not_certifiable",
                          187.4,
                          7.0,
                          {"absurd stated standard deviation"}},
                    Given{"Rinex",
                          {"rinex_pair/yamatogawa_rover.obs", "rinex_pair/yamatogawa_master.obs",
                           "rinex_pair/yamatogawa_rover.nav"},
                          "board",
                          ", base: yamatogawa_master.obs, navigation: yamatogawa_rover.nav",
                          "rinex",
                          203,
                          // By its float positions alone ± 2.2 km/h.
                          "not_beaten",
                          3.2,
                          0.1,
                          {"a second computation, from the raw signals handed in"}}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(RecordingFormats, RinexIsMadeAgainFromTheRunFolder) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    for (const char* file : {"rover.obs", "master.obs", "rover.nav"})
        bring(*data / "rinex_pair" / (std::string("yamatogawa_") + file), folder.path());
    write_file_atomically(
        folder.path() / "attempt.yaml",
        "schema: attempt/1.0\nid: raw\ncraft: {name: walk, class: board}\n"
        "receivers: [{id: primary, recording: yamatogawa_rover.obs, base: yamatogawa_master.obs, "
        "navigation: yamatogawa_rover.nav}]\nprofiles: [nalsa]\n");
    ASSERT_EQ(
        runcert({"keygen", "--out", (folder.path() / "k").string(), "--no-password"}).exit_status,
        0);
    const fs::path run = folder.path() / "run";
    ASSERT_EQ(certify(folder.path() / "attempt.yaml", run,
                      {"--no-render", "--key", (folder.path() / "k.key").string()})
                  .exit_status,
              1);
    for (const char* file : {"rtklib.primary.conf", "forward.primary.pos", "backward.primary.pos",
                             "base.primary.obs", "navigation.primary.nav"})
        EXPECT_TRUE(fs::exists(run / file)) << file;
    const std::vector<std::string> verify{"verify", run.string(), "--pubkey",
                                          (folder.path() / "k.pub").string()};
    std::vector<std::string> recompute = verify;
    recompute.push_back("--recompute");
    const ProcessResult again = runcert(recompute);
    EXPECT_EQ(again.exit_status, 0) << again.output << again.errors;
    // The other pass is evidence too.
    write_file_atomically(run / "backward.primary.pos", "changed");
    const ProcessResult changed = runcert(verify);
    EXPECT_EQ(changed.exit_status, 1);
    EXPECT_NE((changed.output + changed.errors).find("backward.primary.pos"), std::string::npos);
}

/// A recording in two files, cut after some lines of its header and rows.
TEST(RecordingFormats, SeveralFilesAreOneRecording) {
    const TemporaryFolder folder;
    const std::string whole = read_file(examples / "salt_lake" / "recording.pos");
    const std::size_t rows_at = whole.find("\n2026") + 1;
    ASSERT_NE(rows_at, 0U);
    const std::string header = whole.substr(0, rows_at);
    const auto cut = [&](std::size_t rows) {
        std::size_t at = rows_at;
        for (std::size_t row = 0; row < rows; ++row)
            at = whole.find('\n', at) + 1;
        return at;
    };
    write_file_atomically(folder.path() / "a.pos", whole.substr(0, cut(300)));
    write_file_atomically(folder.path() / "b.pos", header + whole.substr(cut(290)));
    write_file_atomically(folder.path() / "c.pos", header + whole.substr(cut(320)));
    write_file_atomically(folder.path() / "d.pos", header + whole.substr(cut(300)));
    const auto certified = [&](const std::string& files) {
        write_file_atomically(
            folder.path() / "attempt.yaml",
            fmt::format("schema: attempt/1.0\nid: parts\ncraft: {{name: y, class: land-yacht}}\n"
                        "receivers: [{{id: primary, recording: {}}}]\nprofiles: [nalsa]\n",
                        files));
        const fs::path run = folder.path() / "run";
        fs::remove_all(run);
        EXPECT_EQ(certify(folder.path() / "attempt.yaml", run, {"--no-render"}).exit_status, 1);
        return read_observations(read_file(run / "1-observations.ecsv"), "f");
    };
    const Observations overlap = certified("[a.pos, b.pos]");
    EXPECT_EQ(overlap.rows.size(), 611U);
    EXPECT_EQ(*overlap.rows[299].source_file, 1);
    EXPECT_EQ(*overlap.rows[300].source_file, 2);
    EXPECT_EQ(overlap.notes.front(), "File 2 overlaps file 1 by 0.900 s.");
    EXPECT_EQ(certified("[a.pos, c.pos]").notes.front(),
              "Between files 1 and 2 2.100 s are missing.");
    EXPECT_EQ(certified("[a.pos, d.pos]").notes.front(), "File 2 follows file 1 without a gap.");
    EXPECT_EQ(certified("[d.pos, a.pos]").notes.front(), "File 2 lies before file 1 in time.");
    EXPECT_TRUE(fs::exists(folder.path() / "run" / "recording.primary.2.pos"));
    // In two files without a gap it is the same run as in one.
    certified("[a.pos, d.pos]");
    const auto speed = [&] {
        return read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"]
            .list()
            .at(0)["speed_km_h"]
            .real();
    };
    const double in_two = speed();
    write_file_atomically(folder.path() / "whole.pos", whole);
    certified("whole.pos");
    EXPECT_EQ(in_two, speed());
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
