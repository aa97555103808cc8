#include <gtest/gtest.h>

#include <numbers>

#include "import_imu_support.h"

// Tables of IMUs with a mapping: units, axes, senses, times.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

constexpr double degree = std::numbers::pi / 180.0;

TEST(ImuTables, EachSampleIsTheMeanOfTheIntervalThatEndsAtItsStamp) {
    const ReadImu read = read_imu_text(imu_receiver(), imu_table(300));
    ASSERT_EQ(read.rows.size(), 300U);
    EXPECT_EQ(read.rows[0].time.nanoseconds, 10'000'000);
    EXPECT_DOUBLE_EQ(read.rows[0].interval_s, 0.01);
    EXPECT_EQ(read.rows[299].time.nanoseconds, 3'000'000'000);
    EXPECT_EQ(read.rows[0].rate_forward_rad_s, 0.01);
    EXPECT_EQ(read.rows[0].rate_right_rad_s, -0.02);
    EXPECT_EQ(read.rows[0].rate_down_rad_s, 0.03);
    EXPECT_EQ(read.rows[0].force_forward_m_s2, 0.1);
    EXPECT_EQ(read.rows[0].force_right_m_s2, -0.2);
    EXPECT_EQ(read.rows[0].force_down_m_s2, -9.79);
    EXPECT_EQ(*read.rows[0].source_line, 2);
    EXPECT_EQ(*read.rows[299].source_line, 301);
    EXPECT_FALSE(read.rows[0].gap_before || read.rows[0].repeated || read.rows[0].saturated);
    EXPECT_EQ(read.head.format, "csv");
    EXPECT_EQ(read.head.records.total, 300);
    EXPECT_NEAR(read.head.clock.rate_hz, 100.0, 1e-9);
}

TEST(ImuTables, AnInstantsMeanIsOfTwoSamplesAndTheFirstHasNone) {
    Receiver receiver = imu_receiver();
    receiver.imu->samples = ImuSampling::instant;
    const std::string text = imu_table(300, [](std::size_t i, SampleText& sample) {
        sample[1] = 0.001 * static_cast<double>(i);
        if (i >= 200) sample[0] += 0.05;
    });
    const ReadImu read = read_imu_text(receiver, text);
    ASSERT_EQ(read.rows.size(), 298U);  // of the second stretch, too
    EXPECT_EQ(read.rows[0].sample, 2);
    EXPECT_EQ(read.rows[0].time.nanoseconds, 20'000'000);
    EXPECT_NEAR(read.rows[0].rate_forward_rad_s, 0.0005, 1e-12);
    EXPECT_EQ(read.rows[199].sample, 202);
    EXPECT_EQ(read.rows[199].gap_before, true);
}

TEST(ImuTables, AnySeparatorAndColumnsByNumber) {
    const ReadImu read = read_imu_text(imu_receiver(), imu_table(300));
    for (const char* separator : {";", "\t", " "}) {
        EXPECT_EQ(read_imu_text(imu_receiver(), imu_table(300, {}, separator)).rows.size(), 300U);
        Receiver numbered = imu_receiver();
        numbered.imu->columns = {
            {"time", "1"},           {"gyro_x", "2"},          {"gyro_y", "3"},
            {"gyro_z", "4"},         {"accelerometer_x", "5"}, {"accelerometer_y", "6"},
            {"accelerometer_z", "7"}};
        const std::string text = imu_table(300, {}, separator);
        const ReadImu with_header = read_imu_text(numbered, text);
        const ReadImu without = read_imu_text(numbered, text.substr(text.find('\n') + 1));
        ASSERT_EQ(with_header.rows.size(), 300U);
        ASSERT_EQ(without.rows.size(), 300U);
        EXPECT_EQ(*without.rows[0].source_line, 1);
        EXPECT_EQ(without.rows[7].force_forward_m_s2, read.rows[7].force_forward_m_s2);
    }
}

TEST(ImuTables, UnitsScalesAndSenseGiveTheSameNumbers) {
    const ReadImu expected = read_imu_text(imu_receiver(), imu_table(300));
    Receiver other = imu_receiver();
    other.imu->gyro_unit = "deg/s";
    other.imu->gyro_scale = 0.5;
    other.imu->accelerometer_unit = "g";
    other.imu->accelerometer_scale = 0.25;
    other.imu->accelerometer_sense = ImuSense::negative;
    other.imu->time_unit = "ms";
    const ReadImu read = read_imu_text(other, imu_table(300, [](std::size_t, SampleText& sample) {
                                           sample[0] *= 1000.0;
                                           for (std::size_t k = 1; k < 4; ++k)
                                               sample[k] /= 0.5 * degree;
                                           for (std::size_t k = 4; k < 7; ++k)
                                               sample[k] /= -0.25 * 9.80665;
                                       }));
    ASSERT_EQ(read.rows.size(), 300U);
    for (const std::size_t i : {0U, 100U, 299U}) {
        EXPECT_EQ(read.rows[i].time.nanoseconds, expected.rows[i].time.nanoseconds);
        // The text has six decimals.
        EXPECT_NEAR(read.rows[i].rate_forward_rad_s, expected.rows[i].rate_forward_rad_s, 1e-6);
        EXPECT_NEAR(read.rows[i].force_down_m_s2, expected.rows[i].force_down_m_s2, 3e-6);
    }
}

TEST(ImuTables, IncrementsOverTheirIntervalAreRates) {
    const ReadImu expected = read_imu_text(imu_receiver(), imu_table(300));
    Receiver other = imu_receiver();
    other.imu->readings = ImuReadings::increments;
    // In milliradians and mm/s, for more decimals.
    other.imu->gyro_scale = other.imu->accelerometer_scale = 1e-3;
    const ReadImu read = read_imu_text(other, imu_table(300, [](std::size_t, SampleText& sample) {
                                           for (std::size_t k = 1; k < 7; ++k)
                                               sample[k] *= 0.01 * 1e3;
                                       }));
    ASSERT_EQ(read.rows.size(), 300U);
    EXPECT_NEAR(read.rows[10].rate_down_rad_s, expected.rows[10].rate_down_rad_s, 1e-7);
    EXPECT_NEAR(read.rows[10].force_forward_m_s2, expected.rows[10].force_forward_m_s2, 1e-7);
}

// An IMU that is turned in the craft gives the same rows once its axes say how.
TEST(ImuTables, AxesAndMountTurnReadingsIntoTheCraftsAxes) {
    const ReadImu expected = read_imu_text(imu_receiver(), imu_table(300));
    Receiver turned = imu_receiver();
    // x points backward, y down, z right: (f, r, d) = (-x, z, y), right-handed.
    turned.imu->axes =
        ImuAxes{.x = CraftAxis::backward, .y = CraftAxis::down, .z = CraftAxis::right};
    const auto turn = [](std::size_t, SampleText& sample) {
        for (const std::size_t first : {1U, 4U}) {
            const SampleText was = sample;
            sample[first] = -was[first];
            sample[first + 1] = was[first + 2];
            sample[first + 2] = was[first + 1];
        }
    };
    const ReadImu read = read_imu_text(turned, imu_table(300, turn));
    for (const std::size_t i : {0U, 123U}) {
        EXPECT_EQ(read.rows[i].rate_forward_rad_s, expected.rows[i].rate_forward_rad_s);
        EXPECT_EQ(read.rows[i].rate_right_rad_s, expected.rows[i].rate_right_rad_s);
        EXPECT_EQ(read.rows[i].rate_down_rad_s, expected.rows[i].rate_down_rad_s);
        EXPECT_EQ(read.rows[i].force_right_m_s2, expected.rows[i].force_right_m_s2);
        EXPECT_EQ(read.rows[i].force_down_m_s2, expected.rows[i].force_down_m_s2);
    }
    // A box that is pitched up by 30 degrees reads gravity along its forward axis, too.
    Receiver pitched = imu_receiver();
    pitched.imu->mount = MountAngles{.roll = 0.0, .pitch = 30.0, .yaw = 0.0};
    const ReadImu level =
        read_imu_text(pitched, imu_table(300, [](std::size_t i, SampleText& sample) {
                          sample[4] = 9.8 * std::sin(30.0 * degree);
                          sample[5] = 0.001 * static_cast<double>(i % 2);
                          sample[6] = -9.8 * std::cos(30.0 * degree);
                      }));
    EXPECT_NEAR(level.rows[0].force_forward_m_s2, 0.0, 1e-6);
    EXPECT_NEAR(level.rows[0].force_down_m_s2, -9.8, 1e-6);
    EXPECT_NEAR(level.head.rest->down_deg, 0.0, 0.01);
}

TEST(ImuTables, LinesThatCannotBeReadAreListed) {
    std::string text = imu_table(300);
    text = replaced(text, "\n0.050000", "\n0.05x");
    const ReadImu read = read_imu_text(imu_receiver(), text);
    EXPECT_EQ(read.head.records.bad, 1);
    EXPECT_EQ(read.head.records.bad_records[0].line, std::optional<std::int64_t>(6));
    EXPECT_TRUE(has(read.head.records.bad_records[0].what, "the time \"0.05x\""));
    EXPECT_EQ(read.head.found.gaps, 1);
}

TEST(ImuTables, NumbersThatNoSensorReadsAreBadRecords) {
    std::string text = imu_table(300);
    text = replaced(text, "-9.790000\n", "-1e300\n");
    const ReadImu read = read_imu_text(imu_receiver(), text);
    EXPECT_EQ(read.head.records.bad, 1);
    EXPECT_TRUE(has(read.head.records.bad_records[0].what, "no sensor reads"));
    text = replaced(text, "\n0.050000", "\n9000000000");
    EXPECT_EQ(read_imu_text(imu_receiver(), text).head.records.bad, 2);
    // Times at the ends of what can be counted share nothing, and wrap nowhere.
    const imu::RecordingSpan late{
        .first_epoch = GpsTime::from_nanoseconds(9'000'000'000'000'000'000), .span_s = 100.0};
    Receiver receiver = imu_receiver();
    const auto shifted = [](double by_s) {
        return imu_table(300, [=](std::size_t, SampleText& sample) { sample[0] += by_s; });
    };
    EXPECT_TRUE(has(imu_failure(receiver, shifted(-3.9e9), late), "share no time"));
    receiver.imu->start_gps = GpsTime::from_nanoseconds(-9'000'000'000'000'000'000);
    EXPECT_NE(imu_failure(receiver, shifted(3.9e9), late), "read");
}

TEST(ImuTables, NamesThatAreNotThereAreRefusedWithTheLine) {
    Receiver receiver = imu_receiver();
    receiver.imu->columns["gyro_x"] = "gyr";
    EXPECT_TRUE(has(imu_failure(receiver, imu_table(300)), "imu.csv:1:1"));
    Receiver numbered = imu_receiver();
    numbered.imu->columns = {
        {"time", "1"},           {"gyro_x", "2"},          {"gyro_y", "3"},
        {"gyro_z", "4"},         {"accelerometer_x", "5"}, {"accelerometer_y", "6"},
        {"accelerometer_z", "8"}};
    EXPECT_TRUE(has(imu_failure(numbered, imu_table(300)),
                    "no column 8 (for accelerometer_z): the line has 7"));
}

// The recording's own count of time, a count since 1970, seconds of the week, seconds from the
// first epoch: the first by which the two share time.
TEST(ImuTimes, AreTakenAsWhatSharesTimeWithTheRecording) {
    const GpsTime first = GpsTime::from_week(2400, 100'000'500'000'000);
    const imu::RecordingSpan span{.first_epoch = first, .span_s = 100.0};
    const auto first_ns = [&](double zero_s, const imu::RecordingSpan& recording) {
        const std::string text =
            imu_table(300, [&](std::size_t, SampleText& sample) { sample[0] += zero_s; });
        return read_imu_text(imu_receiver(), text, recording).rows[0].time.nanoseconds;
    };
    EXPECT_EQ(first_ns(100'000.0, span), -490'000'000);
    EXPECT_EQ(first_ns(0.0, span), 10'000'000);
    imu::RecordingSpan counted = span;
    counted.count_ns = 12'000'000'000;
    EXPECT_EQ(first_ns(12.0, counted), 10'000'000);
    // 315964800 s from 1970 to the GPS epoch, and 18 leap seconds since.
    const double unix_s = 315'964'800.0 + 2400.0 * 604'800.0 + 100'000.5 - 18.0;
    EXPECT_NEAR(static_cast<double>(first_ns(unix_s, span)), 10e6, 1e3);
    // Beyond the end of a week.
    const imu::RecordingSpan late{.first_epoch = GpsTime::from_week(2400, 604'799'000'000'000),
                                  .span_s = 100.0};
    EXPECT_EQ(first_ns(2.0, late), 3'010'000'000);
}

TEST(ImuTimes, StartAndOffsetAreTheAttempts) {
    Receiver receiver = imu_receiver();
    const GpsTime first = GpsTime::from_week(2400, 0);
    receiver.imu->start_gps = first.plus_nanoseconds(1'500'000'000);
    receiver.imu->time_offset_s = -0.125;
    const ReadImu read = read_imu_text(
        receiver, imu_table(300, [](std::size_t, SampleText& sample) { sample[0] += 46408.0; }),
        {.first_epoch = first, .span_s = 100.0});
    EXPECT_EQ(read.rows[0].time.nanoseconds, 1'375'000'000);
    EXPECT_EQ(read.head.clock.offset_s, -0.125);
    EXPECT_TRUE(has(imu_failure(receiver, imu_table(300)), "the recording's times are relative"));
}

TEST(ImuTimes, DatesAreOfTheRecordingsScaleUnlessTheySayUtc) {
    const auto first_ns = [](const char* end, bool utc) {
        std::string text = "t,gx,gy,gz,ax,ay,az\n";
        for (int i = 0; i < 200; ++i)
            text += fmt::format("2026-03-14T03:20:{:02}.{:02}{},0,0,{},0,0,-9.8\n", 18 + i / 100,
                                i % 100, end, 0.001 * (i % 5));
        const imu::RecordingSpan span{
            .first_epoch = GpsTime::from_calendar(
                {.year = 2026, .month = 3, .day = 14, .hour = 3, .minute = 20, .second = 18}),
            .span_s = 100.0,
            .count_ns = std::nullopt,
            .utc = utc};
        return read_imu_text(imu_receiver(), text, span).rows[0].time.nanoseconds;
    };
    EXPECT_EQ(first_ns("", false), 0);
    EXPECT_EQ(first_ns("", true), 18'000'000'000);
    EXPECT_EQ(first_ns("Z", false), 18'000'000'000);
}

TEST(ImuTimes, WithoutATimeColumnTheyAreCounted) {
    Receiver receiver = imu_receiver();
    receiver.imu->columns.erase("time");
    receiver.imu->rate_hz = 200.0;
    const GpsTime first = GpsTime::from_week(2400, 0);
    receiver.imu->start_gps = first;
    const ReadImu read =
        read_imu_text(receiver, imu_table(300), {.first_epoch = first, .span_s = 100.0});
    EXPECT_EQ(read.rows[0].time.nanoseconds, 0);
    EXPECT_EQ(read.rows[299].time.nanoseconds, 299 * 5'000'000);
    EXPECT_EQ(read.head.clock.times, ImuTimes::counted);
}

TEST(ImuTimes, OfAnotherRunAreRefusedWithBothSpans) {
    const GpsTime first = GpsTime::from_week(2400, 0);
    const std::string said =
        imu_failure(imu_receiver(),
                    imu_table(300, [](std::size_t, SampleText& sample) { sample[0] += 5000.0; }),
                    {.first_epoch = first, .span_s = 100.0});
    EXPECT_TRUE(has(said, "share no time with the recording")) << said;
    EXPECT_TRUE(has(said, "attempt.yaml:7:9")) << said;
    EXPECT_TRUE(has(said, to_iso(first, 1))) << said;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
