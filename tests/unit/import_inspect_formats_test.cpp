#include <algorithm>
#include <cmath>

#include "import_inspect_support.h"
#include "import_test_support.h"

// What inspection says beyond counts: how late recorded velocities are, vertical speeds, records
// that cannot be read, local time; and the figures that the README of the recorded data gives.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A craft that swings at 10 Hz along a line to the east, its recorded velocity that of `delay_s`
/// before.
Observations swinging(double delay_s) {
    Observations observations;
    observations.format = "csv";
    observations.time_scale = "relative";
    observations.facts.nominal_interval_s = 0.1;
    for (int i = 0; i < 600; ++i) {
        const double t_s = 0.1 * i;
        Observation row;
        row.epoch = i + 1;
        row.time.nanoseconds = 100'000'000LL * i;
        row.plane_east_m = 20.0 * std::sin(0.5 * t_s) + 10.0 * t_s;
        row.plane_north_m = 3.0 * std::cos(0.3 * t_s);
        row.recorded_velocity_east_m_s = 10.0 * std::cos(0.5 * (t_s - delay_s)) + 10.0;
        row.recorded_velocity_north_m_s = -0.9 * std::sin(0.3 * (t_s - delay_s));
        observations.rows.push_back(row);
    }
    return observations;
}

TEST(VelocityDelay, IsFoundToAHundredth) {
    for (const double delay_s : {0.0, 0.22, -0.15}) {
        const auto found = raw_velocity_delay_s(swinging(delay_s));
        ASSERT_TRUE(found) << delay_s;
        EXPECT_NEAR(*found, delay_s, 0.01);
    }
}

TEST(VelocityDelay, IsNotToldByVelocitiesThatNeverChange) {
    Observations observations = swinging(0.0);
    for (Observation& row : observations.rows)
        row.recorded_velocity_east_m_s = row.recorded_velocity_north_m_s = 0.0;
    EXPECT_FALSE(raw_velocity_delay_s(observations));
    for (Observation& row : observations.rows)
        row.recorded_velocity_east_m_s.reset();
    EXPECT_FALSE(raw_velocity_delay_s(observations));
}

struct RealFormat {
    const char* file;
    const char* format;
    std::size_t epochs, without_position, gaps;
    double longest_gap_s;
    std::size_t repeated;
    double best_position_kmh, best_velocity_kmh, delay_s, delay_tolerance_s;
};

class RealFormats : public testing::TestWithParam<RealFormat> {};

// Figures of the README of the recorded data; delays that it does not give were measured by this
// program and stay as they are.
TEST_P(RealFormats, Figures) {
    const RealFormat& expected = GetParam();
    const auto bytes = recorded(expected.file);
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes, expected.file);
    const Inspection it = inspect(read);
    EXPECT_EQ(read.format, expected.format);
    EXPECT_EQ(it.epochs, expected.epochs);
    EXPECT_EQ(it.without_position, expected.without_position);
    EXPECT_EQ(it.gaps, expected.gaps);
    EXPECT_NEAR(it.longest_gap_s, expected.longest_gap_s, 0.05);
    EXPECT_EQ(it.repeated_times, expected.repeated);
    EXPECT_EQ(read.records.bad, 0);
    ASSERT_TRUE(it.best_by_position && it.best_by_velocity);
    EXPECT_NEAR(it.best_by_position->speed_m_s * 3.6, expected.best_position_kmh, 0.06);
    // The README takes 75 samples for 3 s at 25 Hz, inspection both ends.
    EXPECT_NEAR(it.best_by_velocity->speed_m_s * 3.6, expected.best_velocity_kmh, 0.15);
    ASSERT_TRUE(it.velocity_delay_s);
    EXPECT_NEAR(*it.velocity_delay_s, expected.delay_s, expected.delay_tolerance_s);
    const std::string text = inspection_text(read);
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 48) << text;
}

INSTANTIATE_TEST_SUITE_P(
    All, RealFormats,
    testing::Values(
        RealFormat{"race_car_vbo/run_a.vbo", "vbo", 5675, 0, 1, 0.08, 1, 246.5, 246.2, 0.22, 0.03},
        RealFormat{"race_car_vbo/run_b.vbo", "vbo", 5586, 0, 0, 0.0, 0, 261.7, 261.2, 0.30, 0.04},
        RealFormat{"windsurf_loggers/head_left.oao", "oao", 56055, 0, 0, 0.0, 0, 63.64, 63.74, 0.07,
                   0.03},
        RealFormat{"windsurf_loggers/head_right.oao", "oao", 55937, 0, 0, 0.0, 0, 63.72, 63.72,
                   0.18, 0.03},
        RealFormat{"windsurf_loggers/boom_left.oao", "oao", 55779, 2950, 5, 0.2, 0, 93.2, 63.77,
                   0.13, 0.03},
        RealFormat{"speed_skydive/flysight1_bad_accuracy_gaps.csv", "flysight", 6731, 0, 46, 407.2,
                   0, 273.8, 255.6, 0.04, 0.03},
        RealFormat{"rtk_imu_drive/rover.pos", "rtklib-pos", 2197, 0, 0, 0.0, 0, 58.5, 58.5, 0.12,
                   0.02}),
    [](const auto& instance) { return "Number" + std::to_string(instance.index); });

TEST(RealVertical, ASpeedSkydive) {
    const auto bytes = recorded("speed_skydive/flysight1_good.csv");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes, "f");
    const Inspection it = inspect(read);
    ASSERT_TRUE(it.best_vertical_by_position && it.best_vertical_by_velocity);
    EXPECT_NEAR(it.best_vertical_by_position->speed_m_s * 3.6, 444.61, 0.02);
    EXPECT_NEAR(it.best_vertical_by_velocity->speed_m_s * 3.6, 443.46, 0.02);
    const std::string text = inspection_text(read);
    EXPECT_NE(text.find("Vertical, by height    444.6 km/h"), std::string::npos) << text;
}

TEST(InspectionText, SaysWhatCannotBeReadAndTheLocalTime) {
    std::string text =
        "%  GPST          latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   "
        "sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
    for (int i = 0; i < 50; ++i)
        text += "2270 " + std::to_string(194670 + i) +
                ".000 35.1 136.9 100.0 1 14 0.004 0.003 0.01 0 0 0 0 5\n";
    const std::string bad = replaced(text, "194680.000 35.1", "194680.000 35.1.1");
    const Observations read = import_text(pos_receiver(), bad);
    EXPECT_EQ(read.rows.size(), 49U);
    EXPECT_EQ(read.records.total, 50);
    ASSERT_EQ(read.records.bad_records.size(), 1U);
    EXPECT_EQ(read.records.bad_records[0].line, std::optional<std::int64_t>(12));
    EXPECT_EQ(read.records.bad_records[0].epoch, 10);
    const std::string said = inspection_text(read);
    EXPECT_NE(said.find("More than 1 % of its records cannot be read"), std::string::npos) << said;
    EXPECT_NE(
        said.find("1 of 50 records cannot be read; the first, line 12, column 17: the latitude"),
        std::string::npos)
        << said;
    EXPECT_NE(said.find("Local time  2023-07-11 15:04:12 to 2023-07-11 15:05:01, if UTC+9"),
              std::string::npos)
        << said;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
