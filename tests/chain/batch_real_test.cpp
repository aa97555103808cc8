// A day of real recordings, of all formats that there are short ones of, in one folder.
#include "batch_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr const char* real_day = R"(schema: day/1.0
id: real-recordings
defaults:
  officials: [{role: measurer}]
  record: {speed: 45, unit: km/h, source: a figure for this test}
  profiles: [nalsa]
attempts:
  - {id: urban-car, recording: ppk_urban_car/rover.pos, craft: {name: car, class: car}}
  - id: urban-car-reference
    recording: ppk_urban_car/reference.csv
    format: csv
    craft: {name: car, class: car}
    frame: ecef
    columns: {week: GPS Week, time: GPS TOW (s), x: ECEF X (m), y: ECEF Y (m), z: ECEF Z (m)}
    time_format: seconds_of_week
    accuracy: {horizontal_m: 0.02, vertical_m: 0.04}
    solution: fixed
  - {id: tokyo, recording: ppk_tokyo_ecef/rover.pos, craft: {name: car, class: car}}
  - {id: walk-pos, recording: ubx_walk/rover.pos, craft: {name: walk, class: board}}
  - {id: walk-ubx, recording: ubx_walk/rover.ubx, craft: {name: walk, class: board}}
  - {id: race-car, recording: race_car_vbo/run_a.vbo, craft: {name: race car, class: car}, accuracy: {horizontal_m: 0.3, vertical_m: 0.6}}
  - {id: standing-f9p, recording: nmea_gst/static_f9p.nmea, craft: {name: standing still, class: board}}
  - {id: standing-skytraq, recording: nmea_gst/static_skytraq.nmea, craft: {name: standing still, class: board}}
  - {id: walk-rinex, recording: rinex_pair/yamatogawa_rover.obs, base: rinex_pair/yamatogawa_master.obs, navigation: rinex_pair/yamatogawa_rover.nav, craft: {name: walk, class: board}}
  - {id: jump-1_crlf, recording: speed_skydive/flysight1_crlf.csv, craft: {name: jump, class: skydiver}, profiles: [fai-speed-skydiving-2026]}
  - {id: jump-1_bad_header, recording: speed_skydive/flysight1_bad_header.csv, craft: {name: jump, class: skydiver}, profiles: [fai-speed-skydiving-2026]}
)";

TEST(BatchOfRealRecordings, IsProcessedWithAllItsFormats) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const fs::path day = folder.path() / "day";
    for (const char* file :
         {"ppk_urban_car/rover.pos", "ppk_urban_car/reference.csv", "ppk_tokyo_ecef/rover.pos",
          "ubx_walk/rover.pos", "ubx_walk/rover.ubx", "race_car_vbo/run_a.vbo",
          "nmea_gst/static_f9p.nmea", "nmea_gst/static_skytraq.nmea",
          "rinex_pair/yamatogawa_rover.obs", "rinex_pair/yamatogawa_master.obs",
          "rinex_pair/yamatogawa_rover.nav", "speed_skydive/flysight1_crlf.csv",
          "speed_skydive/flysight1_bad_header.csv"}) {
        fs::create_directories((day / file).parent_path());
        fs::copy_file(*data / file, day / file);
    }
    std::ofstream(day / "day.yaml") << real_day;
    const fs::path out = folder.path() / "out";
    const BatchSaid said = batch_json(day, out, {"--no-render"});
    // One has a header that is wrong.
    EXPECT_EQ(said.exit_status, 2);
    EXPECT_EQ(said.states.size(), 11u) << said.text;
    for (const auto& [id, state] : said.states)
        EXPECT_EQ(state, id == "jump-1_bad_header" ? "failed" : "done")
            << id << said.problems.at(id);
    EXPECT_NE(said.problems.at("jump-1_bad_header").find("timeXXX"), std::string::npos);
    // The true best three seconds of the car, by README.md of the recordings.
    const YamlValue verdict = read_yaml(out / "urban-car-reference/6-verdict.yaml");
    EXPECT_NEAR(verdict["profiles"].list().at(0)["speed_km_h"].real(), 50.88, 0.05);
    const std::string page = read_file(out / "day.html");
    for (const auto& [id, state] : said.states)
        EXPECT_NE(page.find(id), std::string::npos) << id;
    const BatchSaid again = batch_json(day, out, {"--no-render"});
    EXPECT_EQ(again.steps_of("walk-rinex"), "") << again.text;
    EXPECT_EQ(again.steps_of("race-car"), "");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
