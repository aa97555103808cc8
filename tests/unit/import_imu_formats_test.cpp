#include <gtest/gtest.h>

#include "import_imu_support.h"
#include "stages/import/novatel/log.h"

// KF-GINS text, NovAtel RAWIMU. Of the latter no recorded log is at hand.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver receiver_of_format() {
    Receiver receiver = imu_receiver();
    receiver.imu->columns.clear();
    receiver.imu->axes.reset();
    return receiver;
}

TEST(KfGins, IncrementsOfTheWeekAreRatesForwardRightDown) {
    std::string text;
    for (int i = 0; i < 400; ++i)
        text +=
            fmt::format("{:.9f} {:.12f} {:.12f} {:.12f} {:.9f} {:.9f} {:.9f}\n",
                        456'300.0 + 0.005 * i, 0.005 * 0.01, -0.005 * 0.02,
                        0.005 * (0.03 + 1e-4 * (i % 9)), 0.005 * 0.1, -0.005 * 0.2, -0.005 * 9.79);
    const imu::RecordingSpan span{.first_epoch = GpsTime::from_week(2017, 456'300'500'000'000),
                                  .span_s = 100.0};
    const ReadImu read = read_imu_text(receiver_of_format(), text, span);
    EXPECT_EQ(read.head.format, "kf-gins");
    ASSERT_EQ(read.rows.size(), 400U);
    EXPECT_EQ(read.rows[0].time.nanoseconds, -500'000'000);
    EXPECT_EQ(read.rows[300].time.nanoseconds, 1'000'000'000);
    EXPECT_NEAR(read.rows[5].rate_forward_rad_s, 0.01, 1e-9);
    EXPECT_NEAR(read.rows[5].rate_right_rad_s, -0.02, 1e-9);
    EXPECT_NEAR(read.rows[5].rate_down_rad_s, 0.0305, 1e-9);
    EXPECT_NEAR(read.rows[5].force_forward_m_s2, 0.1, 1e-6);
    EXPECT_NEAR(read.rows[5].force_right_m_s2, -0.2, 1e-6);
    EXPECT_NEAR(read.rows[5].force_down_m_s2, -9.79, 1e-6);
    EXPECT_EQ(read.head.axes, (std::vector<std::string>{"forward", "right", "down"}));
    // In another week nothing is shared; without columns another table is no IMU's.
    EXPECT_TRUE(has(imu_failure(receiver_of_format(), text), "of the GPS week"));
    EXPECT_TRUE(has(imu_failure(receiver_of_format(), imu_table(300)), "names no columns"));
}

/// A log of RAWIMUSA with its checksum.
std::string rawimu(double seconds, int z, int minus_y, int x, int gyro_z, int gyro_minus_y,
                   int gyro_x) {
    const std::string body =
        fmt::format("RAWIMUSA,1815,{0:.3f};1815,{0:.9f},00000077,{1},{2},{3},{4},{5},{6}", seconds,
                    z, minus_y, x, gyro_z, gyro_minus_y, gyro_x);
    return fmt::format("%{}*{:08x}\r\n", body, novatel::crc32(body));
}

/// A KVH CPT at 100 Hz: 0.1 / (3600 x 256) rad and 0.05 / 2^15 m/s a count (NovAtel, "OEM6 Family
/// Firmware Reference Manual", RAWIMU).
Receiver cpt_receiver() {
    Receiver receiver = receiver_of_format();
    receiver.imu->gyro_scale = 0.1 / (3600.0 * 256.0);
    receiver.imu->accelerometer_scale = 0.05 / 32768.0;
    return receiver;
}

TEST(RawImu, TheOrderIsZMinusYXAndAxesAreThoseOfTheVehicle) {
    // The first line is a receiver's, whose checksum holds: it stands still, and reads 9.83 m/s^2.
    std::string text =
        "%RAWIMUSA,1815,407772.000;1815,407771.985103333,00000077,63811,-6290,6253,7,-31,14"
        "*2d2a4cff\r\n";
    for (int i = 1; i < 300; ++i)
        text += rawimu(407771.985103333 + 0.01 * i, 63811 + i % 7, -6290, 6253, 7, -31, 14);
    const imu::RecordingSpan span{.first_epoch = GpsTime::from_week(1815, 407'771'000'000'000),
                                  .span_s = 100.0};
    const ReadImu read = read_imu_text(cpt_receiver(), text, span);
    EXPECT_EQ(read.head.format, "novatel");
    EXPECT_EQ(read.head.records.bad, 0);
    ASSERT_EQ(read.rows.size(), 300U);
    const ImuRow& row = read.rows[0];
    EXPECT_EQ(row.time.nanoseconds, 985'103'333);
    constexpr double velocity = 0.05 / 32768.0 / 0.01, angle = 0.1 / (3600.0 * 256.0) / 0.01;
    // x right, y forward, z up.
    EXPECT_NEAR(row.force_right_m_s2, 6253 * velocity, 1e-6);
    EXPECT_NEAR(row.force_forward_m_s2, 6290 * velocity, 1e-6);
    EXPECT_NEAR(row.force_down_m_s2, -63811 * velocity, 1e-6);
    EXPECT_NEAR(row.rate_right_rad_s, 14 * angle, 1e-9);
    EXPECT_NEAR(row.rate_forward_rad_s, 31 * angle, 1e-9);
    EXPECT_NEAR(row.rate_down_rad_s, -7 * angle, 1e-9);
    EXPECT_NEAR(read.head.rest->specific_force_m_s2, 9.83, 0.01);
    EXPECT_TRUE(imu_has_note(read, "none that was recorded was at hand"));
    // A line that was changed is listed.
    const ReadImu damaged = read_imu_text(cpt_receiver(), replaced(text, ",6253,", ",6254,"), span);
    EXPECT_EQ(damaged.head.records.bad, 1);
}

TEST(RawImu, NeedsItsScale) {
    EXPECT_TRUE(has(imu_failure(receiver_of_format(), rawimu(1.0, 1, 1, 1, 1, 1, 1)),
                    "do not say what a count is"));
    Receiver wrong = cpt_receiver();
    wrong.imu->accelerometer_scale = 0.05;
    std::string text;
    for (int i = 0; i < 300; ++i)
        text += rawimu(100.0 + 0.01 * i, 63811 + i % 7, 0, 0, 7, -31, 14);
    EXPECT_TRUE(has(imu_failure(wrong, text), "accelerometer_scale"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
