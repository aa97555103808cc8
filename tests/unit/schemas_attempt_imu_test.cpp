#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "schemas/attempt/attempt.h"
#include "schemas_attempt_support.h"
#include "store_test_support.h"

// The keys of an IMU beside a receiver.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

std::string attempt_with(const std::string& receiver_keys) {
    return "schema: attempt/1.0\nid: a\ncraft: {name: x, class: car}\nreceivers:\n"
           "  - id: primary\n    recording: run.csv\n" +
           receiver_keys + "profiles: [nalsa]\n";
}

/// As the documentation has it.
constexpr const char* whole = R"(    imu:
      file: imu.csv
      columns: {time: time_s, gyro_x: gx, gyro_y: gy, gyro_z: gz, accelerometer_x: ax, accelerometer_y: ay, accelerometer_z: az}
      axes: {x: forward, y: right, z: down}
      gyro_unit: rad/s
      accelerometer_unit: m/s2
      samples: interval_end
      grade: mems
      antenna_m: {forward: 0.0, right: 0.0, down: -5.0}
      reference_point_m: {forward: 0.0, right: 0.5, down: 0.0}
)";

Attempt read(const std::string& receiver_keys) {
    return read_attempt(attempt_with(receiver_keys), "attempt.yaml");
}

TEST(ImuKeys, AreReadAndHaveDefaults) {
    const Attempt attempt = read(whole);
    ASSERT_TRUE(has_imu(attempt.receivers[0]));
    const Imu& imu = *attempt.receivers[0].imu;
    EXPECT_EQ(imu.file, "imu.csv");
    EXPECT_EQ(imu.columns.at("accelerometer_z"), "az");
    EXPECT_EQ(imu.axes->z, CraftAxis::down);
    EXPECT_EQ(imu.grade, (ImuGrade{.name = "mems"}));
    EXPECT_EQ(imu.antenna, (LeverArm{0.0, 0.0, -5.0}));
    EXPECT_EQ(imu.reference_point, (LeverArm{0.0, 0.5, 0.0}));
    EXPECT_EQ(imu.time_unit, "s");
    EXPECT_EQ(imu.time_offset_s, 0.0);
    EXPECT_EQ(imu.samples, ImuSampling::interval_end);
    EXPECT_EQ(imu.readings, ImuReadings::rates);
    EXPECT_EQ(imu.accelerometer_sense, ImuSense::specific_force);
    EXPECT_FALSE(imu.rate_hz || imu.start_gps || imu.gyro_scale || imu.mount);
    EXPECT_EQ(imu.place, "attempt.yaml:8:13");
    // How the positions are read does not hang on it.
    EXPECT_FALSE(reading_of(attempt.written("primary"))->contains("imu"));
    EXPECT_EQ(reading_of(attempt.written("primary"), "imu")->at("imu").at("grade"), "mems");
    EXPECT_FALSE(has_imu(read("").receivers[0]));
}

TEST(ImuKeys, AGradeIsAWordOrFigures) {
    const Attempt attempt = read(
        "    imu: {file: i.csv, antenna_m: {forward: 0, right: 0, down: 0}, grade: {"
        "gyro_bias_deg_h: 1, angle_random_walk_deg_sqrt_h: 0.125, gyro_bias_walk_deg_h_sqrt_h: "
        "0.5, accelerometer_bias_mg: 1, velocity_random_walk_m_s_sqrt_h: 0.06, "
        "accelerometer_bias_walk_mg_sqrt_h: 0.1}}\n");
    ASSERT_TRUE(attempt.receivers[0].imu->grade->errors);
    EXPECT_EQ(attempt.receivers[0].imu->grade->errors->angle_random_walk_deg_sqrt_h, 0.125);
    EXPECT_EQ(attempt.receivers[0].imu->grade->errors->accelerometer_bias_walk_mg_sqrt_h, 0.1);
    const auto said = failure_of([] {
        (void)read(
            "    imu: {file: i.csv, antenna_m: {forward: 0, right: 0, down: 0}, grade: good}\n");
    });
    EXPECT_TRUE(said.contains("\"good\" is no grade of an IMU"));
    EXPECT_TRUE(said.contains("tactical, mems or consumer"));
}

TEST(ImuKeys, ALeverArmBesideItNamesTheTwoKeysInItsPlace) {
    const auto said = failure_of([] {
        (void)read(std::string(whole) + "    lever_arm_m: {forward: 0, right: 0, down: 1}\n");
    });
    EXPECT_TRUE(said.contains("antenna_m")) << said.problem;
    EXPECT_TRUE(said.contains("reference_point_m")) << said.problem;
    EXPECT_TRUE(said.contains("attempt.yaml:17:")) << said.problem;
}

TEST(ImuKeys, ABoundOfTheAntennasMotionStandsForAnImuThatIsMissing) {
    const std::string bound =
        "    antenna_motion: {height_m: 5, roll_deg: 10, pitch_deg: 2, roll_period_s: 2}\n";
    const Attempt attempt = read(bound);
    ASSERT_TRUE(attempt.receivers[0].antenna_motion);
    EXPECT_EQ(attempt.receivers[0].antenna_motion->leeway_deg, 5.0);
    const auto said = failure_of([&] { (void)read(std::string(whole) + bound); });
    EXPECT_TRUE(said.contains("known from imu already")) << said.problem;
    EXPECT_TRUE(failure_of([&] {
                    (void)read("    lever_arm_m: {forward: 0, right: 0, down: 1}\n" + bound);
                }).contains("known from lever_arm_m already"));
}

TEST(ImuKeys, AxesAreRightHandedAndEachOnce) {
    const auto axes = [](const std::string& text) {
        return failure_of([&] {
            (void)read("    imu: {file: i.csv, antenna_m: {forward: 0, right: 0, down: 0}, axes: " +
                       text + "}\n");
        });
    };
    EXPECT_TRUE(axes("{x: forward, y: right, z: -down}").contains("left-handed"));
    EXPECT_TRUE(axes("{x: forward, y: right, z: -down}").contains("z is down"));
    EXPECT_TRUE(axes("{x: right, y: forward, z: down}").contains("z is -down"));
    EXPECT_TRUE(axes("{x: forward, y: -forward, z: down}").contains("along one axis"));
    EXPECT_TRUE(axes("{x: forward, y: right, z: below}").contains("below"));
    for (const char* right_handed :
         {"{x: -forward, y: -right, z: down}", "{x: right, y: forward, z: -down}",
          "{x: down, y: forward, z: right}", "{x: -down, y: right, z: forward}"})
        EXPECT_NO_THROW((void)read(
            std::string(
                "    imu: {file: i.csv, antenna_m: {forward: 0, right: 0, down: 0}, axes: ") +
            right_handed + "}\n"))
            << right_handed;
}

TEST(ImuKeys, SamplesNeedTimesOrARateAndAStart) {
    const std::string head =
        "    imu: {file: i.csv, antenna_m: {forward: 0, right: 0, down: 0}, columns: {gyro_x: 1, "
        "gyro_y: 2, gyro_z: 3, accelerometer_x: 4, accelerometer_y: 5, accelerometer_z: 6}";
    EXPECT_TRUE(failure_of([&] { (void)read(head + ", rate_hz: 100}\n"); }).contains("start_gps"));
    EXPECT_NO_THROW((void)read(head + ", rate_hz: 100, start_gps: \"2026-03-14T03:20:18\"}\n"));
}

TEST(ImuKeys, OfTheAttemptAStageReadsWhetherThereIsOne) {
    const Attempt attempt = read(whole);
    for (const char* stage : {"smooth", "window"}) {
        const Attempt part = part_read_by(attempt, stage);
        ASSERT_TRUE(has_imu(part.receivers[0])) << stage;
        EXPECT_FALSE(part.receivers[0].imu->grade);
    }
    EXPECT_FALSE(has_imu(part_read_by(attempt, "screen").receivers.at(0)));
    EXPECT_TRUE(part_read_by(attempt, "import").receivers[0].imu->grade);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
