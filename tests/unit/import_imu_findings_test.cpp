#include <gtest/gtest.h>

#include <numbers>

#include "core/random.h"
#include "import_imu_support.h"

// What is wrong with an IMU's file: stamps, gaps, units, axes, ranges.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// Stamps of a millisecond counter that lags by 0 or 1 ms, by a clock that runs fast by a share.
std::string jittering(double fast = 0.0, double gap_s = 0.0) {
    RandomGenerator random(7);
    return imu_table(3000, [&](std::size_t i, SampleText& sample) {
        const double time_s = sample[0] * (1.0 + fast) + (i < 1500 ? 0.0 : gap_s);
        sample[0] = std::floor((time_s + 0.002 * random.uniform()) * 1e3 + 1e-6) * 1e-3;
    });
}

Receiver at_100_hz() {
    Receiver receiver = imu_receiver();
    receiver.imu->rate_hz = 100.0;
    return receiver;
}

/// An IMU that turns slowly, with the white noise of a grade, times a factor, rounded to a step.
std::string turning_slowly(double walk_deg_root_hour, double factor, double step = 1e-6) {
    RandomGenerator random(11);
    const double sd_rad_s = walk_deg_root_hour / 60.0 * std::numbers::pi / 180.0 * std::sqrt(100.0);
    return imu_table(3000, [&](std::size_t i, SampleText& sample) {
        const double turning_rad_s = 0.005 * std::sin(0.01 * static_cast<double>(i));
        for (std::size_t axis = 1; axis < 4; ++axis)
            sample[axis] =
                step * std::round(factor * (sd_rad_s * random.normal() + turning_rad_s) / step);
    });
}

// Radians taken for degrees: on a craft that goes straight nothing else shows it. The figures are
// those of the grades' data sheets.
TEST(ImuGyros, ThatAreFarTooQuietForTheirGradeAreNoted) {
    struct Case {
        const char* grade;
        double walk_deg_root_hour;
    };
    for (const auto& [grade, walk] :
         {Case{"tactical", 0.125}, Case{"mems", 0.3}, Case{"consumer", 0.23}, Case{"", 0.23}}) {
        SCOPED_TRACE(grade);
        Receiver receiver = imu_receiver();
        if (*grade) receiver.imu->grade = ImuGrade{.name = grade};
        EXPECT_EQ(said_of_quiet_gyros(receiver, turning_slowly(walk, 1.0)), "");
        // Filtered, or as quiet as any that was recorded.
        EXPECT_EQ(said_of_quiet_gyros(receiver, turning_slowly(walk, 0.25)), "");
        // Read so coarsely that it seldom changes: 0.06 deg/s.
        EXPECT_EQ(said_of_quiet_gyros(receiver, turning_slowly(walk, 0.25, 1e-3)), "");
        receiver.imu->gyro_unit = "deg/s";
        const std::string said = said_of_quiet_gyros(receiver, turning_slowly(walk, 1.0));
        EXPECT_TRUE(has(said, "imu.csv: in their quietest second the gyros scatter by")) << said;
        EXPECT_TRUE(has(said, "Check gyro_unit (rad/s or deg/s)")) << said;
        const std::string dead = said_of_quiet_gyros(receiver, turning_slowly(walk, 0.0));
        EXPECT_TRUE(has(dead, "They do not measure, or hold one value")) << dead;
    }
    // Increments have the noise of a rate times the interval.
    Receiver increments = imu_receiver();
    increments.imu->readings = ImuReadings::increments;
    increments.imu->grade = ImuGrade{.name = "mems"};
    const auto text = [](double factor) {
        RandomGenerator random(12);
        return imu_table(3000, [&](std::size_t, SampleText& sample) {
            for (std::size_t axis = 1; axis < 4; ++axis)
                sample[axis] = factor * 1e-2 * 8.7e-4 * random.normal();
            for (std::size_t axis = 4; axis < 7; ++axis)
                sample[axis] *= 0.01;
        });
    };
    EXPECT_EQ(said_of_quiet_gyros(increments, text(1.0)), "");
}

TEST(ImuStamps, AreEvenedOutByTheNominalRate) {
    const ReadImu read = read_imu_text(at_100_hz(), jittering());
    ASSERT_EQ(read.rows.size(), 3000U);
    for (std::size_t i = 0; i < 3000; i += 100) {
        // The mean lag, 0.5 ms, stays.
        const double time_s = 0.01 * static_cast<double>(i + 1) + 0.0005;
        EXPECT_NEAR(static_cast<double>(read.rows[i].time.nanoseconds) * 1e-9, time_s, 5e-5);
        EXPECT_NEAR(read.rows[i].interval_s, 0.01, 1e-6);
    }
    EXPECT_EQ(read.head.found.gaps, 0);
    EXPECT_EQ(read.head.clock.times, ImuTimes::even);
    EXPECT_NEAR(read.head.clock.jitter_s, 0.0005, 2e-5);
    EXPECT_NEAR(read.head.clock.drift, 0.0, 5e-6);
    const ReadImu stamped = read_imu_text(imu_receiver(), jittering());
    EXPECT_NEAR(stamped.head.clock.jitter_s, 0.0005, 2e-5);
    EXPECT_TRUE(imu_has_note(stamped, "with rate_hz: 100 the samples are evenly spaced"));
}

TEST(ImuStamps, AClockThatDriftsIsFoundAndAWrongRateRefused) {
    const ReadImu read = read_imu_text(at_100_hz(), jittering(0.002));
    EXPECT_NEAR(read.head.clock.drift, 0.002, 1e-5);
    EXPECT_NEAR(read.head.clock.rate_hz, 100.0 / 1.002, 1e-3);
    EXPECT_TRUE(imu_has_note(read, "drifts"));
    const std::string said = imu_failure(at_100_hz(), jittering(0.05));
    EXPECT_TRUE(has(said, "stamps show 95.2")) << said;
    EXPECT_TRUE(has(said, "imu.csv:2")) << said;
}

TEST(ImuStamps, AGapIsFoundWhereItIs) {
    for (const double gap_s : {0.01, 0.05, 3.0}) {
        SCOPED_TRACE(gap_s);
        for (const bool even : {false, true}) {
            const ReadImu read =
                read_imu_text(even ? at_100_hz() : imu_receiver(), jittering(0.0, gap_s));
            EXPECT_EQ(read.head.found.gaps, 1);
            EXPECT_NEAR(read.head.found.longest_gap_s, gap_s, 0.002);
            ASSERT_EQ(read.rows.size(), 3000U);
            EXPECT_EQ(read.rows[1500].gap_before, true);
            EXPECT_FALSE(read.rows[1499].gap_before || read.rows[1501].gap_before);
            EXPECT_NEAR(read.rows[1500].interval_s, 0.01, 1e-4);
            EXPECT_NEAR(static_cast<double>(read.rows[1500].time.nanoseconds) * 1e-9, 15.01 + gap_s,
                        0.0011);
            EXPECT_TRUE(imu_has_note(read, "imu.csv:1502"));
        }
    }
}

TEST(ImuStamps, ThatAreTooUnevenAskForARate) {
    // In bursts of ten, as over a radio link.
    const std::string bursts = imu_table(3000, [](std::size_t i, SampleText& sample) {
        sample[0] = 0.1 * static_cast<double>(i / 10 + 1) + 0.0001 * static_cast<double>(i % 10);
    });
    const std::string said = imu_failure(imu_receiver(), bursts);
    EXPECT_TRUE(has(said, "rate_hz: 100")) << said;
    const ReadImu read = read_imu_text(at_100_hz(), bursts);
    EXPECT_EQ(read.head.found.gaps, 0);
    EXPECT_NEAR(read.rows[2000].interval_s, 0.01, 1e-6);
    const std::string same = imu_table(3000, [](std::size_t i, SampleText& sample) {
        sample[0] = 0.02 * static_cast<double>(i / 2);
    });
    EXPECT_TRUE(has(imu_failure(imu_receiver(), same), "1500 of 3000 samples")) << same.size();
}

TEST(ImuStamps, ThatGoBackForGoodAreRefusedWithTheLine) {
    const std::string said = imu_failure(at_100_hz(), jittering(0.0, -5.0));
    EXPECT_TRUE(has(said, "goes back by 5.0")) << said;
    EXPECT_TRUE(has(said, "imu.csv:1502")) << said;
}

// A logger that reads the sensor more often than it measures.
TEST(ImuStamps, ReadingsThatAreOnlyHeldCountOnce) {
    std::string text = "t,gx,gy,gz,ax,ay,az\n";
    for (int i = 0; i < 3000; ++i)  // at 150 Hz, of a sensor at 100 Hz
        text += fmt::format("{:.6f},{:.6f},0,0,0,0,-9.8\n", i / 150.0, 1e-5 * std::floor(i / 1.5));
    const ReadImu stamped = read_imu_text(imu_receiver(), text);
    EXPECT_EQ(stamped.head.found.repeated, 1000);
    EXPECT_EQ(stamped.rows[2].repeated, std::nullopt);
    EXPECT_EQ(stamped.rows[1].repeated, true);
    EXPECT_TRUE(imu_has_note(stamped, "with rate_hz: 100 each measurement counts once"));
    const ReadImu read = read_imu_text(at_100_hz(), text);
    EXPECT_EQ(read.head.found.held, 1000);
    EXPECT_EQ(read.head.found.repeated, 0);
    ASSERT_EQ(read.rows.size(), 2000U);
    EXPECT_NEAR(read.rows[1000].interval_s, 0.01, 1e-5);
    EXPECT_EQ(read.head.found.gaps, 0);
}

/// A table at rest whose readings are changed by a factor: of the gyros, of the accelerometers.
std::string scaled(double gyros, double accelerometers) {
    return imu_table(300, [=](std::size_t, SampleText& sample) {
        for (std::size_t k = 1; k < 4; ++k)
            sample[k] *= gyros;
        for (std::size_t k = 4; k < 7; ++k)
            sample[k] *= accelerometers;
    });
}

TEST(ImuUnits, ThatAreWrongAreNamed) {
    const auto expect = [](const Receiver& receiver, const std::string& text, const char* what,
                           const char* remedy) {
        const std::string said = imu_failure(receiver, text);
        EXPECT_TRUE(has(said, what)) << said;
        EXPECT_TRUE(has(said, remedy)) << said;
        EXPECT_TRUE(has(said, "attempt.yaml:7:9")) << said;
    };
    expect(imu_receiver(), scaled(1.0, 1.0 / 9.80665), "gravity reads 0.9986 m/s2",
           "accelerometer_unit: g");
    Receiver in_g = imu_receiver();
    in_g.imu->accelerometer_unit = "g";
    expect(in_g, scaled(1.0, 1.0), "that is gravity in m/s2", "accelerometer_unit: m/s2");
    expect(imu_receiver(), scaled(0.01, 0.01), "the numbers are increments",
           "readings: increments");
    Receiver increments = imu_receiver();
    increments.imu->readings = ImuReadings::increments;
    expect(increments, scaled(1.0, 1.0), "no increments", "readings: rates");
    expect(imu_receiver(), scaled(1.0, 100.0), "gravity reads 979.3 m/s2", "accelerometer_scale");
    expect(imu_receiver(), scaled(180.0 / std::numbers::pi, 1.0), "in the quietest second",
           "gyro_unit: deg/s");
    std::string spinning = imu_table(300, [](std::size_t i, SampleText& sample) {
        if (i == 200) sample[3] = 300.0;
    });
    expect(imu_receiver(), spinning, "300 rad/s at most", "gyro_unit: deg/s");
}

TEST(ImuAxesCheck, GravityThatIsNotDownSaysWhichAxisItIsOn) {
    Receiver upside_down = imu_receiver();
    upside_down.imu->axes =
        ImuAxes{.x = CraftAxis::forward, .y = CraftAxis::left, .z = CraftAxis::up};
    std::string said = imu_failure(upside_down, imu_table(300));
    EXPECT_TRUE(has(said, "the IMU's z axis points down; by axes: -z does")) << said;
    EXPECT_TRUE(has(said, "signs in axes")) << said;
    EXPECT_TRUE(has(said, "accelerometer_sense: negative")) << said;
    Receiver swapped = imu_receiver();
    swapped.imu->axes =
        ImuAxes{.x = CraftAxis::down, .y = CraftAxis::right, .z = CraftAxis::backward};
    said = imu_failure(swapped, imu_table(300));
    EXPECT_TRUE(has(said, "the IMU's z axis points down; by axes: x does")) << said;
    EXPECT_TRUE(has(said, "Exchange the axes")) << said;
}

// Where the craft never rests, the mean of the run shows it.
TEST(ImuAxesCheck, AnIMUThatNeverRestsIsJudgedByItsMean) {
    RandomGenerator random(3);
    const std::string text = imu_table(3000, [&](std::size_t, SampleText& sample) {
        for (std::size_t k = 4; k < 7; ++k)
            sample[k] += 8.0 * (random.uniform() - 0.5);
    });
    EXPECT_EQ(imu_failure(imu_receiver(), text), "read");
    Receiver upside_down = imu_receiver();
    upside_down.imu->axes =
        ImuAxes{.x = CraftAxis::forward, .y = CraftAxis::left, .z = CraftAxis::up};
    EXPECT_TRUE(has(imu_failure(upside_down, text), "z axis points down"));
}

TEST(ImuRanges, ReadingsAtTheEndOfTheirRangeAreMarked) {
    const double range_rad_s = 250.0 * std::numbers::pi / 180.0;
    const ReadImu read = read_imu_text(
        imu_receiver(), imu_table(1000, [&](std::size_t i, SampleText& sample) {
            if (i >= 500 && i < 600)  // 300 deg/s, where the gyro ends at 250
                sample[3] = std::min(
                    300.0 * std::numbers::pi / 180.0 *
                        std::sin(std::numbers::pi * (static_cast<double>(i) - 500.0) / 100.0),
                    range_rad_s);
        }));
    EXPECT_NEAR(*read.head.found.gyro_range_rad_s, range_rad_s, 1e-6);
    EXPECT_FALSE(read.head.found.accelerometer_range_m_s2);
    // sin >= 250/300 for asin(5/6) <= x <= pi - asin(5/6): samples 532 to 568.
    EXPECT_EQ(read.head.found.saturated, 37);
    EXPECT_EQ(read.rows[532].saturated, true);
    EXPECT_FALSE(read.rows[531].saturated || read.rows[569].saturated);
    EXPECT_TRUE(imu_has_note(read, "gyros at 250.0 deg/s"));
    // The largest reading of a run that does not saturate is there once.
    const ReadImu peak =
        read_imu_text(imu_receiver(), imu_table(1000, [](std::size_t i, SampleText& sample) {
                          if (i == 500) sample[3] = 4.0;
                      }));
    EXPECT_EQ(peak.head.found.saturated, 0);
}

TEST(ImuRest, TheQuietestSecondSaysGravityAndBias) {
    const ReadImu read =
        read_imu_text(imu_receiver(), imu_table(1000, [](std::size_t i, SampleText& sample) {
                          if (i < 300 || i >= 500)
                              sample[4] += 2.0 * std::sin(0.9 * static_cast<double>(i));
                      }));
    ASSERT_TRUE(read.head.rest);
    EXPECT_GE(read.head.rest->start_s, 3.0);
    EXPECT_LE(read.head.rest->start_s, 4.02);
    EXPECT_NEAR(read.head.rest->duration_s, 1.0, 1e-9);
    EXPECT_NEAR(read.head.rest->specific_force_m_s2, std::sqrt(0.1 * 0.1 + 0.2 * 0.2 + 9.79 * 9.79),
                2e-4);
    EXPECT_NEAR(read.head.rest->gyro_rad_s, std::sqrt(0.01 * 0.01 + 0.02 * 0.02 + 0.03 * 0.03),
                2e-4);
    EXPECT_NEAR(read.head.rest->down_deg,
                std::atan2(std::hypot(0.1, 0.2), 9.79) * 180.0 / std::numbers::pi, 0.01);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
