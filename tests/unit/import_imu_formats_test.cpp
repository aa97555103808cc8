#include <gtest/gtest.h>

#include <numbers>

#include "import_imu_support.h"
#include "import_ubx_test_support.h"
#include "stages/import/novatel/log.h"

// KF-GINS text, NovAtel RAWIMU, u-blox ESF. Of the latter two no recorded log is at hand.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

constexpr double degree = std::numbers::pi / 180.0;

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

/// A reading of ESF with its type.
std::uint32_t esf_data(int type, double value, double unit) {
    return static_cast<std::uint32_t>(type) << 24U |
           (static_cast<std::uint32_t>(std::lround(value / unit)) & 0xffffffU);
}

/// Rates (deg/s) and specific force (m/s^2).
std::vector<std::uint32_t> esf_readings(int i) {
    return {esf_data(14, 0.5, 1.0 / 4096),
            esf_data(13, -1.5, 1.0 / 4096),
            esf_data(5, 2.5 + 0.01 * (i % 9), 1.0 / 4096),
            esf_data(16, 0.25, 1.0 / 1024),
            esf_data(17, -0.5, 1.0 / 1024),
            esf_data(18, -9.75, 1.0 / 1024)};
}

/// A log of 5 s: NAV-PVT each second, between them 100 samples whose tags count 1/25600 s from
/// shortly before the 32 bits begin anew.
std::string esf_log(bool raw) {
    std::string log;
    for (int i = 0; i < 500; ++i) {
        if (i % 100 == 0) log += ubx_test::pvt_frame(i * 10);
        const auto tag = static_cast<std::int64_t>(static_cast<std::uint32_t>(0xffffff00U) +
                                                   256U * static_cast<unsigned>(i));
        const std::vector<std::uint32_t> readings = esf_readings(i);
        ubx_test::Payload payload(raw ? 4 + 8 * 6 : 8 + 4 * 6);
        for (std::size_t k = 0; k < 6; ++k)
            if (raw)
                payload.put(4 + 8 * k, readings[k], 4).put(8 + 8 * k, tag & 0xffffffff, 4);
            else
                payload.put(8 + 4 * k, readings[k], 4);
        if (!raw) payload.put(0, tag & 0xffffffff, 4).put(4, 6 << 11, 2);
        log += ubx_test::frame(0x10, raw ? 0x03 : 0x02, payload.bytes());
    }
    return log + ubx_test::pvt_frame(5000);
}

TEST(Esf, ReadingsOfOneTagAreASampleAndTagsAreTiedByNavPvt) {
    const GpsTime first =
        import_text(pos_receiver(), ubx_test::pvt_frame(0)).facts.first_epoch.value();
    for (const bool raw : {true, false}) {
        SCOPED_TRACE(raw);
        const ReadImu read = read_imu_text(receiver_of_format(), esf_log(raw),
                                           {.first_epoch = first, .span_s = 5.0});
        EXPECT_EQ(read.head.format, "ubx");
        ASSERT_EQ(read.rows.size(), 500U);
        EXPECT_NEAR(read.rows[3].rate_forward_rad_s, 0.5 * degree, 1e-9);
        EXPECT_NEAR(read.rows[3].rate_right_rad_s, -1.5 * degree, 1e-9);
        EXPECT_NEAR(read.rows[3].rate_down_rad_s, 2.53 * degree, 0.5 / 4096 * degree);
        EXPECT_EQ(read.rows[3].force_forward_m_s2, 0.25);
        EXPECT_EQ(read.rows[3].force_right_m_s2, -0.5);
        EXPECT_EQ(read.rows[3].force_down_m_s2, -9.75);
        // The first of a hundred ends a hundredth of a second after its NAV-PVT.
        EXPECT_NEAR(static_cast<double>(read.rows[0].time.nanoseconds) * 1e-9, 0.01, 1e-6);
        EXPECT_NEAR(static_cast<double>(read.rows[499].time.nanoseconds) * 1e-9, 5.0, 1e-6);
        EXPECT_FALSE(read.rows[0].source_line);
        EXPECT_EQ(*read.rows[0].source_byte,
                  static_cast<std::int64_t>(ubx_test::pvt_frame().size()));
        EXPECT_TRUE(imu_has_note(read, "no recorded log was at hand"));
    }
}

TEST(Esf, WithoutNavPvtARateAndAStartAreNeeded) {
    const std::string pvt = ubx_test::pvt_frame(0);
    std::string log = esf_log(true);
    for (int i = 0; i <= 500; i += 100) {
        const std::string one = ubx_test::pvt_frame(i * 10);
        log.erase(log.find(one), one.size());
    }
    const GpsTime first = GpsTime::from_week(2270, 0);
    Receiver receiver = receiver_of_format();
    EXPECT_TRUE(has(imu_failure(receiver, log, {.first_epoch = first, .span_s = 5.0}),
                    "cannot be tied to GPS time"));
    receiver.imu->rate_hz = 100.0;
    receiver.imu->start_gps = first.plus_nanoseconds(250'000'000);
    const ReadImu read = read_imu_text(receiver, log, {.first_epoch = first, .span_s = 5.0});
    EXPECT_EQ(read.rows[0].time.nanoseconds, 250'000'000);
    EXPECT_EQ(read.rows[499].time.nanoseconds, 5'240'000'000);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
