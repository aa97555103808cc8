#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/angle.h"
#include "core/statistics.h"
#include "simulation/inertial_run.h"
#include "simulation/simulate.h"

// A craft whose antenna swings on a mast, and what an IMU and a wheel on it measure.

namespace runcert::RUNCERT_FILE {
namespace {

SimulationSpec mast_spec() {
    SimulationSpec spec;
    spec.run = {.top_speed_m_s = 60.0,
                .start_speed_m_s = 0.1,
                .half_speed_time_s = 15.0,
                .duration_s = 45.0,
                .rate_hz = 100,
                .bearing_deg = 62.0,
                .start = {.east_m = 30.0, .north_m = -20.0, .up_m = 2.0}};
    spec.place = Geodetic{Angle::from_degrees(-31.6), Angle::from_degrees(136.0), 110.0};
    spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
    spec.craft = {.antenna = {0.5, -0.25, -10.0},
                  .roll = {.amplitude_deg = 10.0, .frequency_hz = 0.5},
                  .pitch = {.amplitude_deg = 5.0, .frequency_hz = 0.4},
                  .leeway_deg = 2.5};
    spec.imu = {.grade = {.name = "mems"}};
    return spec;
}

double degrees(double radians) {
    return radians * degrees_per_radian;
}

/// The craft's axes from its angles, written out: forward, right and down in east, north, up.
Eigen::Matrix3d axes_of(const EulerAngles& a) {
    const Eigen::Vector3d ahead(std::sin(a.heading), std::cos(a.heading), 0.0);
    const Eigen::Vector3d aside(std::cos(a.heading), -std::sin(a.heading), 0.0);
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d forward = std::cos(a.pitch) * ahead + std::sin(a.pitch) * up;
    const Eigen::Vector3d below = std::sin(a.pitch) * ahead - std::cos(a.pitch) * up;
    Eigen::Matrix3d axes;
    axes << forward, std::cos(a.roll) * aside + std::sin(a.roll) * below,
        std::cos(a.roll) * below - std::sin(a.roll) * aside;
    return axes;
}

TEST(SimulatedCraft, MovesAsTheRunSaysAndItsAntennaSwingsAboutIt) {
    const SimulationSpec spec = mast_spec();
    const std::vector<SimulatedEpoch> epochs = simulate(spec);
    ASSERT_EQ(epochs.size(), 4501U);
    const Eigen::Vector3d start(30.0, -20.0, 2.0);
    for (const SimulatedEpoch& epoch : epochs) {
        const CraftTruth& craft = epoch.craft.value();
        // The reference point is the one that runs: [DHD22] in closed form.
        EXPECT_LT(
            (craft.reference_point_m - start - epoch.truth.distance_m * direction_of(spec.run))
                .norm(),
            1e-3);
        EXPECT_NEAR(craft.reference_velocity_m_s.norm(), epoch.truth.speed_m_s, 1e-4);
        const Eigen::Vector3d arm = axes_of(craft.attitude) * Eigen::Vector3d(0.5, -0.25, -10.0);
        EXPECT_LT((epoch.true_enu_m - craft.reference_point_m - arm).norm(), 1e-9);
    }
}

TEST(SimulatedCraft, HasAttitudeOfThatSizeAndFrequencyAndNoneWhereItStands) {
    const std::vector<SimulatedEpoch> epochs = simulate(mast_spec());
    double roll_deg = 0.0, pitch_deg = 0.0, still_deg = 0.0;
    int turns = 0;
    std::vector<double> leeways_deg;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const EulerAngles& attitude = epochs[i].craft->attitude;
        roll_deg = std::max(roll_deg, std::abs(degrees(attitude.roll)));
        pitch_deg = std::max(pitch_deg, std::abs(degrees(attitude.pitch)));
        leeways_deg.push_back(62.0 - degrees(attitude.heading));
        if (epochs[i].time_s() < 1.0)
            still_deg = std::max(still_deg, std::abs(degrees(attitude.roll)));
        if (epochs[i].time_s() > 15.0 && epochs[i - 1].craft->attitude.roll * attitude.roll < 0.0)
            ++turns;
    }
    EXPECT_LE(roll_deg, 10.0);
    EXPECT_GT(roll_deg, 9.5);
    EXPECT_LE(pitch_deg, 5.0);
    EXPECT_GT(pitch_deg, 4.7);
    EXPECT_LT(still_deg, 0.01);
    EXPECT_NEAR(turns, 30, 1);  // 30 s at 0.5 Hz
    EXPECT_NEAR(mean(leeways_deg), 2.5, 0.01);
    EXPECT_NEAR(standard_deviation(leeways_deg), 0.2 * 2.5 / std::sqrt(2.0), 0.01);
}

TEST(SimulatedCraft, StatesTheVelocityAndAccelerationThatPositionsHave) {
    const std::vector<SimulatedEpoch> epochs = simulate(mast_spec());
    constexpr double step_s = 0.01;
    for (std::size_t i = 2; i + 2 < epochs.size(); ++i) {
        const auto place = [&](std::ptrdiff_t k) {
            return epochs[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + k)].true_enu_m;
        };
        // Of fourth order, over a wider step than the simulator's.
        const Eigen::Vector3d velocity =
            (8.0 * (place(1) - place(-1)) - (place(2) - place(-2))) / (12.0 * step_s);
        const Eigen::Vector3d acceleration =
            (16.0 * (place(1) + place(-1)) - (place(2) + place(-2)) - 30.0 * place(0)) /
            (12.0 * step_s * step_s);
        EXPECT_LT((epochs[i].craft->antenna_velocity_m_s - velocity).norm(), 5e-4) << i;
        EXPECT_LT((epochs[i].craft->antenna_acceleration_m_s2 - acceleration).norm(), 0.01) << i;
    }
}

TEST(SimulatedCraft, TurnsAndLeansOnAnOval) {
    SimulationSpec spec = mast_spec();
    spec.run.duration_s = 60.0;
    spec.run.rate_hz = 10;
    spec.craft->course = CraftCourse::oval;
    spec.craft->roll.amplitude_deg = spec.craft->pitch.amplitude_deg = 0.0;
    spec.craft->leeway_deg = 0.0;
    for (const SimulatedEpoch& epoch : simulate(spec)) {
        const CraftTruth& craft = epoch.craft.value();
        EXPECT_NEAR(craft.reference_velocity_m_s.norm(), epoch.truth.speed_m_s, 2e-3);
        EXPECT_NEAR(craft.reference_point_m.z(), 2.0, 1e-6);
        const double at_m = epoch.truth.distance_m;
        if (at_m < 600.0) {
            EXPECT_NEAR(degrees(craft.attitude.heading), 62.0, 1e-6);
            EXPECT_NEAR(degrees(craft.attitude.roll), -3.0, 1e-6);
        } else if (at_m > 750.0 && at_m < 1605.0) {
            // In the turn the acceleration is v^2 / r, to the left of the course. The body leans
            // out by half a degree for each g of it, and the ground by 14 degrees into it.
            const double lateral = epoch.truth.speed_m_s * epoch.truth.speed_m_s / 320.0;
            EXPECT_NEAR(degrees(craft.attitude.roll), -14.0 + 0.5 * lateral / 9.81, 1e-3);
            const Eigen::Vector3d& v = craft.reference_velocity_m_s;
            const double course = std::atan2(v.x(), v.y());
            EXPECT_NEAR(std::remainder(degrees(craft.attitude.heading - course), 360.0), 0.4, 0.02);
        }
    }
    // Half a turn later it goes back.
    const auto back = simulate(spec);
    const auto found = std::ranges::find_if(
        back, [](const SimulatedEpoch& one) { return one.truth.distance_m > 1780.0; });
    ASSERT_NE(found, back.end());
    EXPECT_NEAR(degrees(found->craft->attitude.heading), 62.0 + 180.0, 0.5);
}

/// Figures of an IMU: constant biases and white noise.
ImuNoise white_noise() {
    return {.gyro_bias_rad_s = 1e-3,
            .angle_walk_rad_sqrt_s = 1e-4,
            .accelerometer_bias_m_s2 = 0.05,
            .velocity_walk_m_s_sqrt_s = 2e-3};
}

TEST(SimulatedImu, WithoutErrorsLeadsToWhereTheCraftIs) {
    SimulationSpec spec = mast_spec();
    spec.imu->rate_hz = 400;
    const std::vector<SimulatedEpoch> epochs = simulate(spec);
    const std::vector<ImuSample> samples = simulate_imu(spec, {});
    const EarthFrame earth(*spec.place);
    const CraftTruth& first = epochs.front().craft.value();
    NavigationState state{.enu_from_body = axes_of(first.attitude),
                          .velocity_m_s = first.reference_velocity_m_s,
                          .position_m = first.reference_point_m};
    SampleReader reader(samples);
    for (const SimulatedEpoch& epoch : epochs) {
        while (const auto piece = reader.next(epoch.time_s()))
            state = strapdown_step(state, piece->sample, {}, earth).state;
        EXPECT_LT((state.position_m - epoch.craft->reference_point_m).norm(), 2e-3);
    }
}

TEST(SimulatedImu, HasTheErrorsOfItsFigures) {
    const SimulationSpec spec = mast_spec();
    const std::vector<ImuSample> exact = simulate_imu(spec, {});
    const std::vector<ImuSample> samples = simulate_imu(spec, white_noise());
    ASSERT_EQ(samples.size(), 4600U);  // 46 s at 100 Hz
    ASSERT_EQ(exact.size(), samples.size());
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> rates, forces;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            EXPECT_EQ(samples[i].time_s, exact[i].time_s);
            rates.push_back((samples[i].angle_rad - exact[i].angle_rad)[axis] / 0.01);
            forces.push_back((samples[i].velocity_m_s - exact[i].velocity_m_s)[axis] / 0.01);
        }
        // A standard deviation of 4500 values is known to 1 %, a bias to 2 % of its size.
        EXPECT_NEAR(standard_deviation(rates), 1e-4 / std::sqrt(0.01), 5e-5);
        EXPECT_NEAR(standard_deviation(forces), 2e-3 / std::sqrt(0.01), 1e-3);
        EXPECT_GT(std::abs(mean(rates)), 3.0 * 1.5e-5);
        EXPECT_LT(std::abs(mean(rates)), 4.0 * 1e-3);
        EXPECT_LT(std::abs(mean(forces)), 4.0 * 0.05);
    }
}

TEST(SimulatedImu, IsLateByWhatIsAskedAndChangesNothingElse) {
    SimulationSpec spec = mast_spec();
    const std::vector<ImuSample> in_time = simulate_imu(spec, white_noise());
    const std::vector<SimulatedEpoch> epochs = simulate(spec);
    spec.imu->late_s = 0.020;
    spec.craft->tape_error = {0.1, 0.0, 0.0};
    const std::vector<ImuSample> late = simulate_imu(spec, white_noise());
    ASSERT_EQ(late.size(), in_time.size());
    for (std::size_t i = 0; i < late.size(); ++i) {
        EXPECT_NEAR(late[i].time_s, in_time[i].time_s + 0.020, 1e-12);
        EXPECT_EQ(late[i].angle_rad, in_time[i].angle_rad);
        EXPECT_EQ(late[i].velocity_m_s, in_time[i].velocity_m_s);
    }
    // Neither does an IMU, or another, change the positions.
    spec.imu->grade = {.name = "consumer"};
    spec.imu->rate_hz = 200;
    const std::vector<SimulatedEpoch> others = simulate(spec);
    spec.imu = std::nullopt;
    const std::vector<SimulatedEpoch> none = simulate(spec);
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        EXPECT_EQ(epochs[i].measured_enu_m, others[i].measured_enu_m);
        EXPECT_EQ(epochs[i].measured_enu_m, none[i].measured_enu_m);
    }
}

TEST(SimulatedWheel, TurnsWithTheCraftAndNotWithItsAntenna) {
    const SimulationSpec spec = mast_spec();
    const std::vector<SimulatedEpoch> epochs = simulate(spec);
    const std::vector<double> speeds =
        simulate_wheel({.noise_m_s = 0.05, .scale = 1.25}, 7, epochs);
    std::vector<double> errors_m_s;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        EXPECT_GE(speeds[i], 0.0);
        if (epochs[i].truth.speed_m_s > 0.3)  // where no noise turns it back
            errors_m_s.push_back(1.25 * speeds[i] - epochs[i].truth.speed_m_s);
    }
    ASSERT_GT(errors_m_s.size(), 4000U);
    EXPECT_NEAR(mean(errors_m_s), 0.0, 4.0 * 0.05 / std::sqrt(4000.0));
    EXPECT_NEAR(standard_deviation(errors_m_s), 0.05, 0.002);
    EXPECT_EQ(speeds, simulate_wheel({.noise_m_s = 0.05, .scale = 1.25}, 7, epochs));
    EXPECT_NE(speeds, simulate_wheel({.noise_m_s = 0.05, .scale = 1.25}, 8, epochs));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
