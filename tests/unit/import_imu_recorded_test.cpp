#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "import_imu_support.h"

// Real IMUs as attempts name them. What is expected was counted in the files.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// The receiver of an attempt with this IMU.
Receiver receiver_with(const std::string& imu) {
    return read_attempt(
               "schema: attempt/1.0\nid: a\ncraft: {name: x, class: car}\n"
               "receivers: [{id: primary, recording: r.pos, imu: " +
                   imu + "}]\nprofiles: [nalsa]\n",
               "attempt.yaml")
        .receivers.front();
}

GpsTime at(int year, int month, int day, int hour, int minute, int second, int ms) {
    return GpsTime::from_calendar({.year = year,
                                   .month = month,
                                   .day = day,
                                   .hour = hour,
                                   .minute = minute,
                                   .second = second,
                                   .nanosecond = ms * 1'000'000});
}

constexpr const char* logger_columns =
    "columns: {time: 7, gyro_x: 4, gyro_y: 5, gyro_z: 6, accelerometer_x: 1, accelerometer_y: 2, "
    "accelerometer_z: 3}, gyro_unit: deg/s, accelerometer_unit: g, time_unit: ms, "
    "antenna_m: {forward: 0, right: 0, down: 0}";

TEST(ImuRecorded, ADriveAt100Hz) {
    const auto text = recorded("rtk_imu_drive/imu.csv");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Receiver receiver = receiver_with(
        std::string("{file: imu.csv, rate_hz: 100, axes: {x: -forward, y: right, z: -down}, "
                    "start_gps: \"2025-07-08T19:34:21.854\", ") +
        logger_columns + "}");
    const imu::RecordingSpan span{.first_epoch = at(2025, 7, 8, 19, 34, 18, 499), .span_s = 549.0};
    const ReadImu read = read_imu_text(receiver, *text, span);
    ASSERT_EQ(read.rows.size(), 54860U);
    EXPECT_EQ(read.head.records.bad, 0);
    EXPECT_EQ(read.head.found.gaps, 0);
    EXPECT_EQ(read.head.found.saturated, 0);
    EXPECT_EQ(read.head.found.repeated, 1138);
    // The logger's counter ticks exactly once in 10 ms, give or take one.
    EXPECT_NEAR(read.head.clock.rate_hz, 100.0, 1e-4);
    EXPECT_LT(read.head.clock.jitter_s, 0.001);
    EXPECT_NEAR(static_cast<double>(read.rows[0].time.nanoseconds) * 1e-9, 3.355, 0.002);
    EXPECT_NEAR(static_cast<double>(read.rows.back().time.nanoseconds) * 1e-9, 3.355 + 548.59,
                0.002);
    EXPECT_NEAR(read.head.rest->specific_force_m_s2, 9.8, 0.2);
    // Its box is pitched by 6.79 degrees.
    EXPECT_NEAR(read.head.rest->down_deg, 6.8, 5.0);
    EXPECT_LT(read.head.rest->gyro_rad_s, 0.02);
    for (const char* grade : {"tactical", "mems", "consumer"}) {
        Receiver graded = receiver;
        graded.imu->grade = ImuGrade{.name = grade};
        EXPECT_EQ(said_of_quiet_gyros(graded, *text, span), "") << grade;
    }
    Receiver upside_down = receiver;
    upside_down.imu->axes =
        ImuAxes{.x = CraftAxis::backward, .y = CraftAxis::left, .z = CraftAxis::down};
    EXPECT_TRUE(has(imu_failure(upside_down, *text, span), "-z axis points down; by axes: z does"));
    Receiver without_g = receiver;
    without_g.imu->accelerometer_unit = "m/s2";
    EXPECT_TRUE(has(imu_failure(without_g, *text, span), "accelerometer_unit: g"));
    Receiver another_day = receiver;
    another_day.imu->start_gps = at(2025, 7, 9, 19, 34, 21, 854);
    EXPECT_TRUE(has(imu_failure(another_day, *text, span), "share no time with the recording"));
}

// The logger reads the sensor at 152 Hz, which measures at 100.5.
TEST(ImuRecorded, AWalkWhoseSensorIsReadMoreOftenThanItMeasures) {
    const auto text = recorded("ubx_walk/imu.csv");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const auto receiver = [](const std::string& rate) {
        return receiver_with("{file: imu.csv, " + rate +
                             "axes: {x: forward, y: -right, z: -down}, "
                             "start_gps: \"2025-08-28T17:30:40.961\", " +
                             logger_columns + "}");
    };
    const imu::RecordingSpan span{.first_epoch = at(2025, 8, 28, 17, 30, 39, 749),
                                  .span_s = 133.75};
    const ReadImu read = read_imu_text(receiver("rate_hz: 100, "), *text, span);
    EXPECT_EQ(read.head.found.held, 6958);
    EXPECT_EQ(read.rows.size(), 20455U - 6958U);
    EXPECT_NEAR(read.head.clock.rate_hz, 100.5, 0.1);
    EXPECT_LT(read.head.clock.jitter_s, 0.005);
    EXPECT_EQ(read.head.found.saturated, 0);
    EXPECT_EQ(read.head.found.gaps, 0);
    for (const char* grade : {"tactical", "mems", "consumer"}) {
        Receiver graded = receiver("rate_hz: 100, ");
        graded.imu->grade = ImuGrade{.name = grade};
        EXPECT_EQ(said_of_quiet_gyros(graded, *text, span), "") << grade;
        // As if the file had radians: it was held still for its first seconds.
        graded.imu->gyro_scale = std::numbers::pi / 180.0;
        EXPECT_NE(said_of_quiet_gyros(graded, *text, span), "") << grade;
    }
    // The file begins and ends within a line.
    EXPECT_EQ(read.head.records.bad, 1);
    const ReadImu stamped = read_imu_text(receiver(""), *text, span);
    EXPECT_EQ(stamped.rows.size(), 20455U);
    EXPECT_EQ(stamped.head.found.gaps, 0);
    EXPECT_TRUE(imu_has_note(stamped, "read more often than it measured; with rate_hz: 100.5"));
}

TEST(ImuRecorded, APhoneOnTheFreeway) {
    const auto text = recorded("freeway_pose/imu.csv");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Receiver receiver = receiver_with(
        "{file: imu.csv, columns: {time: host_time_s, gyro_x: gx_rad_s, gyro_y: gy_rad_s, gyro_z: "
        "gz_rad_s, accelerometer_x: ax_mps2, accelerometer_y: ay_mps2, accelerometer_z: az_mps2}, "
        "axes: {x: forward, y: right, z: down}, start_gps: \"2018-08-02T16:15:06.4295\", "
        "grade: consumer, antenna_m: {forward: 0, right: 0, down: 0}}");
    const imu::RecordingSpan span{.first_epoch = at(2018, 8, 2, 16, 15, 6, 299), .span_s = 57.8};
    const ReadImu read = read_imu_text(receiver, *text, span);
    EXPECT_EQ(said_of_quiet_gyros(receiver, *text, span), "");
    ASSERT_EQ(read.rows.size(), 6256U);
    EXPECT_NEAR(read.head.clock.rate_hz, 104.26, 0.1);
    EXPECT_EQ(read.head.found.gaps, 0);
    EXPECT_EQ(read.head.found.saturated, 0);
    // Its gyros are biased by 4 degrees a second.
    EXPECT_NEAR(read.head.rest->gyro_rad_s, 0.07, 0.01);
    EXPECT_LT(read.head.rest->down_deg, 10.0);
    EXPECT_EQ(read.rows[0].force_down_m_s2, -9.544968);
    EXPECT_EQ(*read.rows[0].source_line, 2);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
