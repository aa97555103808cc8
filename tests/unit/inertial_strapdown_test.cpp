#include <gtest/gtest.h>

#include <GeographicLib/NormalGravity.hpp>
#include <cmath>

#include "core/failure.h"
#include "inertial/attitude.h"
#include "inertial/strapdown.h"
#include "simulation/inertial_run.h"

namespace runcert::RUNCERT_FILE {
namespace {

Geodetic place(double latitude_deg, double height_m) {
    return {.latitude = Angle::from_degrees(latitude_deg),
            .longitude = Angle::from_degrees(17.0),
            .height_m = height_m};
}

TEST(Gravity, HasThePublishedSize) {
    const auto size = [](double latitude_deg, double height_m) {
        return EarthFrame(place(latitude_deg, height_m))
            .gravity_m_s2(Eigen::Vector3d::Zero())
            .norm();
    };
    EXPECT_NEAR(size(0.0, 0.0), 9.7803253, 1e-6);
    EXPECT_NEAR(size(90.0, 0.0), 9.8321849, 1e-6);
    EXPECT_NEAR(size(45.0, 0.0), 9.8061977, 1e-6);
    EXPECT_NEAR(size(40.0, 1280.0), 9.7977481, 1e-6);
}

// The plumb line turns with the place: the same frame, 5 km on, is not level by 785 micro-g.
TEST(Gravity, TurnsWithThePlace) {
    const EarthFrame earth(place(-31.6, 110.0));
    const Eigen::Vector3d here = earth.gravity_m_s2(Eigen::Vector3d::Zero());
    const Eigen::Vector3d there = earth.gravity_m_s2({5000.0, 0.0, 0.0});
    EXPECT_LT(here.head<2>().norm(), 1e-6 * here.norm());
    EXPECT_NEAR(-there.x() / here.norm(), 785e-6, 2e-6);
    // Down the frame's own vertical it is that of GeographicLib at the height.
    double across = 0.0, along = 0.0;
    GeographicLib::NormalGravity::WGS84().Gravity(-31.6, 610.0, across, along);
    EXPECT_NEAR(earth.gravity_m_s2({0.0, 0.0, 500.0}).norm(), std::hypot(across, along), 1e-9);
}

TEST(Gravity, GradientIsThatOfDifferences) {
    for (const double latitude_deg : {0.0, 40.0, -75.0}) {
        const EarthFrame earth(place(latitude_deg, 300.0));
        const Eigen::Matrix3d& analytic = earth.gravity_gradient();
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3d step = 200.0 * Eigen::Vector3d::Unit(axis);
            const Eigen::Vector3d numeric =
                (earth.gravity_m_s2(step) - earth.gravity_m_s2(-step)) / 400.0;
            EXPECT_LT((numeric - analytic.col(axis)).norm(), 0.01 * analytic(2, 2))
                << latitude_deg << " " << axis;
        }
    }
}

TEST(EarthFrame, RotatesOnceASiderealDay) {
    const EarthFrame earth(place(50.0, 0.0));
    EXPECT_NEAR(earth.rotation_rad_s().norm(), 7.292115e-5, 1e-11);
    EXPECT_NEAR(std::atan2(earth.rotation_rad_s().z(), earth.rotation_rad_s().y()),
                50.0 * radians_per_degree, 1e-12);
}

InertialRunSpec oval_at(int imu_hz) {
    InertialRunSpec spec;
    spec.course = InertialCourse::oval;
    spec.duration_s = 60.0;
    spec.start_m = 400.0;
    spec.roll_deg = 1.0;
    spec.pitch_deg = 0.5;
    spec.roll_hz = 1.0;
    spec.pitch_hz = 1.3;  // with tones to 1.7 of it
    spec.imu_hz = imu_hz;
    return spec;
}

/// Greatest errors of position (m) and attitude (deg) over a run without noise.
std::pair<double, double> mechanisation_errors(int imu_hz) {
    const InertialRunSpec spec = oval_at(imu_hz);
    const InertialRun run = simulate_inertial(spec);
    const EarthFrame earth(spec.origin);
    NavigationState state = run.truth.front().imu;
    SampleReader reader(run.samples);
    double position = 0.0, attitude = 0.0;
    for (const InertialTruth& truth : run.truth) {
        while (const auto piece = reader.next(truth.time_s))
            state = strapdown_step(state, piece->sample, {}, earth).state;
        position = std::max(position, (state.position_m - truth.imu.position_m).norm());
        attitude = std::max(
            attitude,
            rotation_vector(state.enu_from_body * truth.imu.enu_from_body.transpose()).norm() *
                degrees_per_radian);
    }
    return {position, attitude};
}

TEST(Strapdown, FollowsAnOvalWithoutNoise) {
    const auto [coarse_m, coarse_deg] = mechanisation_errors(50);
    const auto [position_m, attitude_deg] = mechanisation_errors(100);
    EXPECT_LT(position_m, 0.010);
    EXPECT_LT(attitude_deg, 1e-4);
    EXPECT_GT(coarse_m, 2.0 * position_m);  // of second order in the interval
    EXPECT_LT(mechanisation_errors(200).first, 0.5 * position_m);
    // At the simulator's own rate it goes the simulator's way.
    const auto [own_m, own_deg] = mechanisation_errors(400);
    EXPECT_LT(own_m, 1e-6);
    EXPECT_LT(own_deg, 1e-9);
    RecordProperty("position_m", std::to_string(position_m));
}

// What a craft feels that lies still on the Earth: gravity and the Earth's rotation, and no more.
TEST(Strapdown, StandsStillWithTheEarth) {
    const EarthFrame earth(place(35.0, 50.0));
    const NavigationState start{.enu_from_body = rotation_of({0.1, -0.2, 1.0}),
                                .position_m = {300.0, -200.0, 5.0}};
    const Eigen::Matrix3d body_from_enu = start.enu_from_body.transpose();
    const ImuSample still{
        .interval_s = 0.01,
        .angle_rad = 0.01 * body_from_enu * earth.rotation_rad_s(),
        .velocity_m_s = -0.01 * body_from_enu * earth.gravity_m_s2(start.position_m)};
    NavigationState state = start;
    for (int i = 0; i < 6'000; ++i)
        state = strapdown_step(state, still, {}, earth).state;
    EXPECT_LT(state.velocity_m_s.norm(), 1e-9);
    EXPECT_LT((state.position_m - start.position_m).norm(), 1e-7);
    EXPECT_LT((state.enu_from_body - start.enu_from_body).norm(), 1e-10);
}

std::vector<ImuSample> ramp(std::size_t count) {
    std::vector<ImuSample> samples(count);
    for (std::size_t k = 0; k < count; ++k)
        samples[k] = {.time_s = 0.01 * static_cast<double>(k + 1),
                      .interval_s = 0.01,
                      .angle_rad = Eigen::Vector3d::Constant(1e-3 * static_cast<double>(k)),
                      .velocity_m_s = Eigen::Vector3d::Constant(1e-2 * static_cast<double>(k))};
    return samples;
}

TEST(SampleReader, SplitsSamplesInProportionToTime) {
    const auto samples = ramp(10);
    SampleReader reader(samples);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double time_s = 0.0;
    for (const double until_s : {0.0135, 0.0135, 0.047, 0.05, 0.1}) {
        while (const auto piece = reader.next(until_s)) {
            EXPECT_EQ(piece->gap_s, 0.0);
            sum += piece->sample.angle_rad;
            time_s += piece->sample.interval_s;
        }
        EXPECT_NEAR(time_s, until_s, 1e-12);
        if (until_s == 0.0135) {
            EXPECT_NEAR(sum.x(), 0.35e-3, 1e-12);
        }
    }
    EXPECT_NEAR(sum.x(), 45e-3, 1e-12);
    EXPECT_FALSE(reader.next(0.2).has_value());
}

TEST(SampleReader, FillsMissingSamplesAndSaysSo) {
    auto samples = ramp(10);
    samples.erase(samples.begin() + 4, samples.begin() + 6);  // those that end at 0.05 and 0.06
    SampleReader reader(samples);
    double missing_s = 0.0, time_s = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    while (const auto piece = reader.next(0.1)) {
        time_s += piece->sample.interval_s;
        sum += piece->sample.angle_rad;
        if (piece->gap_s == 0.0) continue;
        missing_s += piece->sample.interval_s;
        EXPECT_NEAR(piece->gap_s, 0.02, 1e-9);
    }
    EXPECT_NEAR(time_s, 0.1, 1e-12);
    EXPECT_NEAR(missing_s, 0.02, 1e-9);
    EXPECT_NEAR(sum.x(), 45e-3, 1e-12);  // the ramp's mean is its middle
}

TEST(SampleReader, StampsThatJitterLoseNothing) {
    auto samples = ramp(10);
    for (std::size_t k = 1; k < 9; ++k)
        samples[k].time_s += k % 2 == 0 ? 0.002 : -0.002;
    SampleReader reader(samples);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    while (const auto piece = reader.next(0.1)) {
        EXPECT_EQ(piece->gap_s, 0.0);
        sum += piece->sample.angle_rad;
    }
    EXPECT_NEAR(sum.x(), 45e-3, 1e-12);
}

TEST(SampleReader, RefusesWhatCannotBe) {
    const auto problem = [](const std::vector<ImuSample>& samples) -> std::string {
        try {
            SampleReader reader(samples);
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.where().rfind("IMU", 0), 0U);
            return failure.problem();
        }
        return "";
    };
    EXPECT_EQ(problem(ramp(3)), "");
    EXPECT_NE(problem({}).find("no samples"), std::string::npos);
    auto repeated = ramp(3);
    repeated[2].time_s = repeated[1].time_s;
    EXPECT_NE(problem(repeated).find("not after"), std::string::npos);
    auto nothing = ramp(3);
    nothing[1].angle_rad.y() = std::nan("");
    EXPECT_NE(problem(nothing).find("finite"), std::string::npos);
    auto interval = ramp(3);
    interval[0].interval_s = 0.0;
    EXPECT_NE(problem(interval).find("interval"), std::string::npos);
    SampleReader reader(interval = ramp(3));
    EXPECT_THROW(reader.seek(1.0), Failure);
}

TEST(SampleReader, RatesAreReadBetweenTheMiddlesOfSamples) {
    const auto samples = ramp(10);  // the rate at t is 10 t - 0.05
    for (const double time_s : {0.01, 0.0321, 0.05, 0.0949})
        EXPECT_NEAR(measured_rate_rad_s(samples, time_s).z(), 10.0 * time_s - 0.05, 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
