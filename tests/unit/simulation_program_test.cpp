#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

// `runcert simulate` as people type it: the specs of the examples, and specs that are refused.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    EXPECT_TRUE(stream) << file;
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

class SimulateProgram : public testing::Test {
  protected:
    void SetUp() override {
        program_ = fs::read_symlink("/proc/self/exe").parent_path().parent_path() / "bin/runcert";
        if (!fs::exists(program_)) GTEST_SKIP() << program_ << " is not built";
        std::string name = (fs::temp_directory_path() / "runcert-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Runs `runcert simulate SPEC --out OUT`; returns the exit status.
    int simulate(const fs::path& spec, const fs::path& out) {
        std::ostringstream command;  // a path streams in double quotes
        command << program_ << " simulate " << spec << " --out " << out << " >" << folder_ / "said"
                << " 2>" << folder_ / "errors";
        const int status = std::system(command.str().c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    std::string errors() { return text_of(folder_ / "errors"); }

    fs::path write_spec(const std::string& text) {
        std::ofstream(folder_ / "spec.yaml") << text;
        return folder_ / "spec.yaml";
    }

    /// A spec that must be refused, with a message that holds each of these.
    void expect_refused(const std::string& spec, const std::vector<std::string>& parts) {
        EXPECT_EQ(simulate(write_spec(spec), folder_ / "out"), 2) << spec;
        const std::string message = errors();
        for (const std::string& part : parts)
            EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
        EXPECT_FALSE(fs::exists(folder_ / "out")) << spec;
    }

    fs::path program_;
    fs::path folder_;
};

const std::string minimal =
    "schema: simulation/1.0\n"
    "run: {top_speed_m_s: 60, half_speed_time_s: 15, duration_s: 45, rate_hz: 10}\n";

TEST_F(SimulateProgram, MakesTheExamplesByteForByte) {
    const std::vector<std::string> files{"recording.pos", "truth.csv", "attempt.yaml"};
    for (const char* example : {"salt_lake", "rejected", "mast", "oval"}) {
        const fs::path committed = fs::path(RUNCERT_SOURCE_DIR "/examples") / example;
        const fs::path made = folder_ / example;
        ASSERT_EQ(simulate(committed / "spec.yaml", made), 0) << errors();
        for (const std::string& file : files)
            EXPECT_TRUE(text_of(made / file) == text_of(committed / file)) << example << file;
        for (const char* beside : {"imu.csv", "surface.xml"}) {
            ASSERT_EQ(fs::exists(made / beside), fs::exists(committed / beside)) << example;
            if (!fs::exists(made / beside)) continue;
            EXPECT_TRUE(text_of(made / beside) == text_of(committed / beside)) << example;
        }
    }
}

TEST_F(SimulateProgram, NeedsOnlyTheRunItself) {
    ASSERT_EQ(simulate(write_spec(minimal), folder_ / "out"), 0) << errors();
    const std::string attempt = text_of(folder_ / "out/attempt.yaml");
    EXPECT_NE(attempt.find("id: simulated-run\n"), std::string::npos) << attempt;
    EXPECT_NE(attempt.find("frame: local_plane\n"), std::string::npos) << attempt;
    EXPECT_NE(attempt.find("horizontal_m: 0.0001\n"), std::string::npos) << attempt;
    EXPECT_TRUE(fs::exists(folder_ / "out/recording.csv"));
    EXPECT_TRUE(fs::exists(folder_ / "out/truth.csv"));
}

TEST_F(SimulateProgram, ClaimsTheAccuracyThatTheErrorHas) {
    const std::string errors_part =
        "white_noise: {horizontal_m: 0.003}\n"
        "correlated_error: {horizontal_m: 0.004, correlation_time_s: 1}\n"
        "recording: {up: false}\n";
    ASSERT_EQ(simulate(write_spec(minimal + errors_part), folder_ / "out"), 0) << errors();
    const std::string attempt = text_of(folder_ / "out/attempt.yaml");
    EXPECT_NE(attempt.find("horizontal_m: 0.005\n"), std::string::npos) << attempt;
    EXPECT_NE(attempt.find("up: null\n"), std::string::npos) << attempt;
    EXPECT_EQ(attempt.find("vertical_m"), std::string::npos) << attempt;
}

TEST_F(SimulateProgram, OverwritesNothing) {
    fs::create_directory(folder_ / "out");
    std::ofstream(folder_ / "out/truth.csv") << "mine";
    EXPECT_EQ(simulate(write_spec(minimal), folder_ / "out"), 2);
    EXPECT_NE(errors().find("exists already"), std::string::npos);
    EXPECT_EQ(text_of(folder_ / "out/truth.csv"), "mine");
    EXPECT_FALSE(fs::exists(folder_ / "out/recording.csv"));
}

TEST_F(SimulateProgram, SaysWhereASpecIsWrong) {
    expect_refused("run: {}\n", {"spec.yaml:1:1", "simulation/1.0"});
    expect_refused(minimal + "sed: 2\n", {"spec.yaml:3:1", "seed"});
    expect_refused(minimal + "seed: -1\n", {"spec.yaml:3:7", "below 0"});
    expect_refused(
        "schema: simulation/1.0\n"
        "run: {top_speed_m_s: fast, half_speed_time_s: 15, duration_s: 45, rate_hz: 10}\n",
        {"spec.yaml:2:22", "not a number"});
    expect_refused(
        "schema: simulation/1.0\n"
        "run: {top_speed_m_s: 60, half_speed_time_s: 15, duration_s: 45, rate_hz: 3}\n",
        {"spec.yaml:2:74", "is not one of 1, 2, 4"});
    expect_refused(
        "schema: simulation/1.0\n"
        "run: {top_speed_m_s: 60, start_speed_m_s: 31, half_speed_time_s: 15, duration_s: 45, "
        "rate_hz: 10}\n",
        {"spec.yaml:2:6", "half the top speed"});
    expect_refused(minimal + "place: {latitude_deg: 1, longitude_deg: 2, height_m: 3}\n",
                   {"spec.yaml:3:8", "start_gps"});
    expect_refused(minimal + "start_gps: \"2026-02-30T00:00:00\"\n", {"spec.yaml:3:12"});
}

TEST_F(SimulateProgram, SaysWhichFaultWouldNotShow) {
    expect_refused(minimal + "faults:\n  outliers:\n    - {east_m: 1}\n",
                   {"spec.yaml:5:7", "epoch or by time_s"});
    expect_refused(minimal + "faults:\n  outliers:\n    - {time_s: 4.05, east_m: 1}\n",
                   {"spec.yaml:5:16", "no epoch at 4.05 s"});
    expect_refused(minimal + "faults:\n  outliers:\n    - {epoch: 452, east_m: 1}\n",
                   {"spec.yaml:5:15", "451 epochs"});
    expect_refused(minimal + "faults:\n  steps:\n    - {time_s: 45.1, east_m: 1}\n",
                   {"spec.yaml:5:16", "after the end"});
    expect_refused(minimal + "faults:\n  gaps:\n    - {from_s: 5, to_s: 4}\n",
                   {"spec.yaml:5:25", "ends before it begins"});
}

const std::string on_the_earth =
    "place: {latitude_deg: -31.6, longitude_deg: 136, height_m: 110}\n"
    "start_gps: \"2026-03-14T03:20:18.000\"\n";
const std::string mast = "craft: {antenna_m: {forward: 0, right: 0, down: -10}}\n";

TEST_F(SimulateProgram, SaysWhatACraftAndItsImuCannotBe) {
    const std::string run = minimal + on_the_earth;
    expect_refused(minimal + mast, {"spec.yaml:3:8", "no place is given", "Add place"});
    expect_refused(run + "imu: {grade: mems}\n", {"spec.yaml:5:6", "Add craft"});
    expect_refused(run + "craft: {roll: {amplitude_deg: 5, frequency_hz: 1}}\n",
                   {"spec.yaml:5:8", "antenna_m"});
    expect_refused(run + "craft: {antenna_m: {forward: 0, right: 0, down: -1000}}\n",
                   {"spec.yaml:5:20", "beyond any craft"});
    expect_refused(run +
                       "craft: {antenna_m: {forward: 0, right: 0, down: -1}, roll: "
                       "{amplitude_deg: 90, frequency_hz: 1}}\n",
                   {"spec.yaml:5:76", "above 60"});
    expect_refused(run +
                       "craft: {antenna_m: {forward: 0, right: 0, down: -1}, roll: "
                       "{amplitude_deg: 9}}\n",
                   {"spec.yaml:5:60", "frequency_hz"});
    expect_refused(run + "craft: {course: ring, antenna_m: {forward: 0, right: 0, down: -1}}\n",
                   {"spec.yaml:5:17", "straight", "oval"});
    expect_refused(
        run + "craft: {start_on_oval_m: 9, antenna_m: {forward: 0, right: 0, down: 0}}\n",
        {"spec.yaml:5:26", "course: oval"});
    expect_refused(run +
                       "craft: {course: oval, leeway_deg: 2, antenna_m: {forward: 0, right: 0, "
                       "down: 0}}\n",
                   {"spec.yaml:5:35", "course: straight"});
    expect_refused(run + mast + "imu: {grade: best}\n",
                   {"spec.yaml:6:14", "\"best\" is no grade of an IMU", "tactical"});
    expect_refused(run + mast + "imu: {rate_hz: 100}\n", {"spec.yaml:6:6", "grade"});
    expect_refused(run + mast + "imu: {grade: mems, rate_hz: 125}\n",
                   {"spec.yaml:6:29", "\"125\" is not one of", "50, 80, 100, 200, 400"});
    expect_refused(run + mast + "imu: {grade: mems, late_s: soon}\n",
                   {"spec.yaml:6:28", "not a number"});
    expect_refused(run + "surface: {width_m: 20}\n", {"spec.yaml:5:10", "Add craft"});
    expect_refused(run + mast + "surface: {width_m: 5, spacing_m: 10}\n",
                   {"spec.yaml:6:10", "at most width_m"});
    expect_refused(run + "wheel: {scale: 0}\n", {"spec.yaml:5:16", "below 0.5"});
    expect_refused(run + "wheel: {stated_scale: 1}\n",
                   {"spec.yaml:5:8", "Give both stated_scale and expanded_uncertainty_scale"});
}

TEST_F(SimulateProgram, WritesWhatATapeFoundAndTheImuBesideIt) {
    const std::string craft =
        minimal + on_the_earth +
        "craft: {antenna_m: {forward: 0.5, right: 0, down: -10}, reference_point_m: {forward: 0, "
        "right: 0.25, down: 0.5}, tape_error_m: {forward: 0, right: 0, down: 0.125}, roll: "
        "{amplitude_deg: 10, frequency_hz: 0.5}}\n";
    const std::string imu =
        "imu: {grade: {gyro_bias_deg_h: 5, angle_random_walk_deg_sqrt_h: 0.25, "
        "gyro_bias_walk_deg_h_sqrt_h: 1, accelerometer_bias_mg: 2, "
        "velocity_random_walk_m_s_sqrt_h: 0.125, accelerometer_bias_walk_mg_sqrt_h: 0.5}}\n"
        "wheel: {noise_m_s: 0, stated_scale: 1.5, expanded_uncertainty_scale: 0.01}\n"
        "surface: {below_m: 0.5}\n";
    ASSERT_EQ(simulate(write_spec(craft + imu), folder_ / "imu"), 0) << errors();
    const std::string attempt = text_of(folder_ / "imu/attempt.yaml");
    for (const char* part :
         {"file: imu.csv\n", "grade:\n        gyro_bias_deg_h: 5.0\n",
          "antenna_m:\n        forward: 0.5\n        right: 0.0\n        down: -9.875\n",
          "antenna_height_m: 10.375\n",
          "reference_point_m:\n        forward: 0.0\n        right: 0.25\n        down: 0.5\n",
          "wheel:\n  file: wheel.csv\n  source: \"a wheel, simulated\"\n  scale: 1.5\n  "
          "expanded_uncertainty_scale: 0.01\n"})
        EXPECT_NE(attempt.find(part), std::string::npos) << part << attempt;
    EXPECT_EQ(attempt.find("lever_arm_m"), std::string::npos);
    const std::string samples = text_of(folder_ / "imu/imu.csv");
    EXPECT_TRUE(
        samples.starts_with("# runcert simulate (no receiver: this recording is simulated)"
                            "\ntime_s,gx,gy,gz,ax,ay,az\n530418.0100,"))
        << samples.substr(0, 200);
    // The same again is the same, byte for byte.
    ASSERT_EQ(simulate(write_spec(craft + imu), folder_ / "again"), 0) << errors();
    for (const char* file :
         {"recording.pos", "truth.csv", "attempt.yaml", "imu.csv", "wheel.csv", "surface.xml"})
        EXPECT_TRUE(text_of(folder_ / "imu" / file) == text_of(folder_ / "again" / file)) << file;
    // Without an IMU the antenna's height is stated, and bounds of the attitude.
    ASSERT_EQ(simulate(write_spec(craft), folder_ / "none"), 0) << errors();
    const std::string without = text_of(folder_ / "none/attempt.yaml");
    EXPECT_NE(without.find("antenna_motion:\n      height_m: 10.375\n      roll_deg: 10.0\n      "
                           "pitch_deg: 0.0\n      roll_period_s: 2.0\n      leeway_deg: 0.0\n"),
              std::string::npos)
        << without;
    EXPECT_EQ(without.find(" imu:"), std::string::npos);
    EXPECT_TRUE(text_of(folder_ / "none/recording.pos") == text_of(folder_ / "imu/recording.pos"));
}

TEST_F(SimulateProgram, RefusesAnAttemptThatCouldNotBeCertified) {
    expect_refused(minimal + "attempt:\n  id: a/b\n", {"spec.yaml:4:3", "cannot be an id"});
    expect_refused(minimal + "attempt:\n  date: \"14 March\"\n", {"spec.yaml:4:3", "not a date"});
    expect_refused(minimal + "attempt:\n  crew: me\n", {"spec.yaml:4:3", "unknown key \"crew\""});
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
