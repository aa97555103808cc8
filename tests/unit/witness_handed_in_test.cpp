#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "core/random.h"
#include "core/uncertainty.h"
#include "inertial/joint_covariance.h"
#include "witness/antenna_swing.h"
#include "witness/kinds/gates.h"
#include "witness/kinds/wheel.h"
#include "witness/recorded_velocities.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Vector2d;

/// A car that goes faster and slower on a wide curve, at 10 Hz.
Vector2d place_at(double time_s) {
    const double way_m = 20.0 * time_s - 30.0 * std::cos(0.3 * time_s);
    return 2000.0 * Vector2d(std::sin(way_m / 2000.0), 1.0 - std::cos(way_m / 2000.0));
}
double speed_at(double time_s) {
    return 20.0 + 9.0 * std::sin(0.3 * time_s);
}

struct Recorded {
    ScreenedTable screened;
    TrajectoryTable trajectory;

    explicit Recorded(double length_s) {
        RandomGenerator random(5);
        screened.facts.nominal_interval_s = trajectory.facts.nominal_interval_s = 0.1;
        trajectory.facts.first_epoch = parse_gps_iso("2026-03-14T03:20:18.000");
        for (int k = 0; k <= std::lround(10.0 * length_s); ++k) {
            const double time_s = 0.1 * k;
            const Vector2d velocity = (place_at(time_s + 1e-4) - place_at(time_s - 1e-4)) / 2e-4;
            const Vector2d place = place_at(time_s);
            ScreenedEpoch& row = screened.rows.emplace_back();
            row.epoch = k + 1;
            row.time = {std::llround(time_s * 1e9)};
            row.east_m = place.x() + 0.01 * random.normal();
            row.north_m = place.y() + 0.01 * random.normal();
            row.sigma_east_m = row.sigma_north_m = 0.01;
            row.usable = true;
            row.arc = 1;
            TrajectoryEpoch& smoothed = trajectory.rows.emplace_back();
            smoothed.epoch = row.epoch;
            smoothed.time = row.time;
            smoothed.usable = true;
            smoothed.arc = 1;
            smoothed.east_m = place.x();
            smoothed.north_m = place.y();
            smoothed.velocity_east_m_s = velocity.x();
            smoothed.velocity_north_m_s = velocity.y();
            smoothed.acceleration_east_m_s2 = smoothed.acceleration_north_m_s2 = 0.0;
            smoothed.speed_m_s = velocity.norm();
            smoothed.sigma_east_m = smoothed.sigma_north_m = 0.005;
        }
    }
};

std::vector<TimedValue> wheel(double length_s, double scale, double delay_s, double noise_m_s) {
    RandomGenerator random(9);
    std::vector<TimedValue> speeds;
    for (double time_s = 0.0; time_s <= length_s; time_s += 0.05)
        speeds.push_back(
            {.time_s = time_s,
             .value = speed_at(time_s - delay_s) / scale + noise_m_s * random.normal()});
    return speeds;
}

TEST(WheelWitness, FindsItsScaleAndItsDelay) {
    const Recorded run(120.0);
    const auto found =
        wheel_witness({.m_s = wheel(120.0, 1.013, 0.24, 0.05)},
                      timed_positions<2>(run.screened.rows), track_of(run.trajectory), 0.6);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->scale, 1.013, 4.0 * found->sigma_scale);
    EXPECT_LT(found->sigma_scale, 0.002);
    EXPECT_NEAR(found->delay_s, 0.24, 0.02);
    double statistics = 0.0;
    int count = 0;
    for (double from_s = 5.0; from_s < 110.0; from_s += 5.0) {
        const auto moved = found->motion.between(from_s, from_s + 3.0);
        ASSERT_TRUE(moved);
        const Vector2d error = moved->displacement_m - (place_at(from_s + 3.0) - place_at(from_s));
        EXPECT_LT(error.norm(), 0.3);
        statistics += error.squaredNorm() / moved->covariance_m2.trace();
        ++count;
    }
    EXPECT_LT(statistics / count, 2.0);
}

/// A wheel's motion at 30 m/s towards east, and the runs that its scale is known from.
WheelMotion rolling(std::vector<WheelRun> runs, double sigma_scale, bool calibrated) {
    VelocityErrorModel model;
    model.density = 0.0;
    std::vector<TimedVelocity<2>> samples;
    for (int k = 0; k < 100; ++k)
        samples.push_back({.time_s = 0.1 * k, .velocity = Vector2d(30.0, 0.0)});
    return {VelocityWitness<2>(samples, model, 0.0), std::move(runs), sigma_scale, calibrated};
}

WheelRun run_at(double from_s, double scale, double towards = 1.0) {
    return {.span = {.first_s = from_s, .last_s = from_s + 10.0},
            .direction = towards * Vector2d(300.0, 0.0),
            .scale = scale};
}

// 10 m up, pitch of 5 and roll of 10 degrees every 2 s, leeway of 3: by hand 0.8716 m of pitch,
// 0.0909 of roll with leeway, 0.3350 of roll over 90 m, and 0.2505 m/s that the path is longer by.
TEST(WitnessOfCraft, IsLessCertainByWhatTheAntennaMaySwing) {
    const AntennaMotion motion{.height_m = 10.0,
                               .roll_deg = 10.0,
                               .pitch_deg = 5.0,
                               .roll_period_s = 2.0,
                               .leeway_deg = 3.0};
    EXPECT_NEAR(swing_bound_m_s(motion, 30.0, 3.0, false), 2.0 * 0.9960 / 3.0, 1e-4);
    EXPECT_NEAR(swing_bound_m_s(motion, 30.0, 3.0, true), 2.0 * 0.9960 / 3.0 + 0.2505, 1e-4);
    const auto wheel = std::make_shared<const WheelMotion>(rolling({}, 0.01, true));
    const WitnessOfCraft of_craft(wheel, {.bound = motion});
    const auto alone = wheel->between(1.0, 4.0), swung = of_craft.between(1.0, 4.0);
    ASSERT_TRUE(alone && swung);
    EXPECT_EQ(swung->displacement_m, alone->displacement_m);
    const double bound_m = 3.0 * swing_bound_m_s(motion, 30.0, 3.0, true);
    const Eigen::Matrix2d more = swung->covariance_m2 - alone->covariance_m2;
    EXPECT_NEAR(more(0, 0), bound_m * bound_m / 3.0, 1e-9);
    EXPECT_NEAR(more(1, 1), bound_m * bound_m / 3.0, 1e-9);
    EXPECT_EQ(of_craft.path_between(1.0, 4.0), wheel->path_between(1.0, 4.0));
    // Where nothing bounds the swing, the antenna is taken to be the craft.
    const std::vector<TimedPosition<2>> positions{{.time_s = 1.0, .sigma_m = 0.01}};
    EXPECT_EQ(positions_of_craft(positions, {}).front().sigma_m, 0.01);
    EXPECT_NEAR(positions_of_craft(positions, {.bound = motion}).front().sigma_m,
                0.9625 / std::sqrt(3.0), 1e-4);
}

/// A craft at 30 m/s towards east, 10 epochs a second for 10 s, whose antenna swings by half a
/// metre along it and by a metre across, every 2 s. Its attitude is known without error, its two
/// arms to a centimetre each, and only the IMU carries across the eighth second.
InertialSolution swinging() {
    InertialSolution solution;
    auto joint = std::make_shared<JointCovariance>();
    JointErrors& errors = joint->errors;
    joint->antenna_sigma_m = 0.01;
    for (int k = 0; k <= 100; ++k) {
        const double time_s = 0.1 * k, phase = std::numbers::pi * time_s;
        InertialEpoch& epoch = solution.epochs.emplace_back();
        epoch.time_s = time_s;
        epoch.enu_from_body =
            Eigen::AngleAxisd(0.1 * std::sin(phase), Eigen::Vector3d::UnitX()).toRotationMatrix();
        epoch.reference_point.position_m = {30.0 * time_s, 0.0, 0.0};
        epoch.reference_point.velocity_m_s = {30.0, 0.0, 0.0};
        epoch.antenna.position_m = epoch.reference_point.position_m +
                                   Eigen::Vector3d(0.5 * std::sin(phase), std::cos(phase), 0.0);
        epoch.antenna.velocity_m_s =
            epoch.reference_point.velocity_m_s +
            std::numbers::pi * Eigen::Vector3d(0.5 * std::cos(phase), -std::sin(phase), 0.0);
        errors.covariance.emplace_back(ErrorMatrix::Zero());
        errors.gain.emplace_back(ErrorMatrix::Identity());
    }
    solution.joint = joint;
    solution.bridged = {{.from_s = 7.0, .to_s = 8.0}};
    return solution;
}

TEST(WitnessOfCraft, MovesAsTheAntennaDoesByTheImu) {
    const AntennaSwing swing{.solution = std::make_shared<const InertialSolution>(swinging())};
    const auto wheel = std::make_shared<const WheelMotion>(rolling({}, 1e-3, true));
    const WitnessOfCraft of_craft(wheel, swing);
    const auto antenna_at = [](double time_s) {
        const double phase = std::numbers::pi * time_s;
        return Vector2d(30.0 * time_s + 0.5 * std::sin(phase), std::cos(phase));
    };
    for (const auto& [from_s, to_s] : {std::pair(0.5, 3.5), std::pair(1.23, 4.57)}) {
        const auto moved = of_craft.between(from_s, to_s);
        ASSERT_TRUE(moved);
        // The cubic between epochs is good to a tenth of a millimetre.
        EXPECT_LT((moved->displacement_m - (antenna_at(to_s) - antenna_at(from_s))).norm(), 2e-4);
        double path_m = 0.0;
        constexpr int steps = 3000;
        for (int i = 0; i < steps; ++i)
            path_m += (antenna_at(from_s + (to_s - from_s) * (i + 1) / steps) -
                       antenna_at(from_s + (to_s - from_s) * i / steps))
                          .norm();
        // The chords of a tenth of a second are shorter than the path by a millimetre.
        EXPECT_NEAR(*of_craft.path_between(from_s, to_s), path_m, 3e-3);
        EXPECT_GT(path_m, moved->displacement_m.norm() + 0.1);
    }
    // Half a swing apart: 2 x 0.01 m of both arms turned by 0.2 rad, and 2 ms of 3.1 m/s along.
    const auto moved = of_craft.between(0.5, 1.5), alone = wheel->between(0.5, 1.5);
    const Eigen::Matrix2d more = moved->covariance_m2 - alone->covariance_m2;
    EXPECT_NEAR(
        more(1, 1),
        std::pow(0.002 * 2.0 * std::numbers::pi, 2) + 2.0 * 1e-4 * std::pow(2.0 * std::sin(0.1), 2),
        1e-6);
    EXPECT_NEAR(more(0, 0), 0.0, 1e-6);
    EXPECT_FALSE(of_craft.between(6.5, 7.5));
    EXPECT_FALSE(of_craft.path_between(6.5, 7.5));
    EXPECT_TRUE(of_craft.between(8.0, 9.0));
    EXPECT_FALSE(of_craft.between(9.5, 10.5));
}

TEST(WitnessOfCraft, IsFittedToTheTrackOfTheReferencePoint) {
    const AntennaSwing swing{.solution = std::make_shared<const InertialSolution>(swinging())};
    Track antenna;
    antenna.nominal_interval_s = 0.1;
    std::vector<TimedPosition<2>> positions;
    for (int k = -5; k <= 105; ++k) {
        const double time_s = 0.1 * k, phase = std::numbers::pi * time_s;
        const double rate = std::numbers::pi;
        TrackEpoch& epoch = antenna.epochs.emplace_back();
        epoch.time_s = time_s;
        epoch.position_m = {30.0 * time_s + 0.5 * std::sin(phase), std::cos(phase), 0.0};
        epoch.velocity_m_s = {30.0 + 0.5 * rate * std::cos(phase), -rate * std::sin(phase), 0.0};
        epoch.acceleration_m_s2 = {-0.5 * rate * rate * std::sin(phase),
                                   -rate * rate * std::cos(phase), 0.0};
        positions.push_back({.time_s = time_s, .position = epoch.position_m.head<2>()});
    }
    const Track craft = track_of_craft(antenna, swing);
    const auto of_craft = positions_of_craft(positions, swing);
    // Five epochs at either end lie beyond it.
    ASSERT_EQ(craft.epochs.size(), 101U);
    ASSERT_EQ(of_craft.size(), 101U);
    for (std::size_t k = 0; k < craft.epochs.size(); ++k) {
        const Vector2d place(30.0 * craft.epochs[k].time_s, 0.0);
        EXPECT_LT((craft.epochs[k].position_m.head<2>() - place).norm(), 1e-9);
        EXPECT_LT((of_craft[k].position - place).norm(), 1e-9);
        EXPECT_LT((craft.epochs[k].velocity_m_s - Eigen::Vector3d(30.0, 0.0, 0.0)).norm(), 1e-9);
        // From the velocities of neighbouring epochs, where the swing has up to 10 m/s^2.
        EXPECT_LT(craft.epochs[k].acceleration_m_s2.norm(), 1.7);
    }
}

// A scale that is not known well makes every way uncertain in proportion.
TEST(WheelMotion, TheScalesUncertaintyCountsAlongTheWay) {
    const auto moved = rolling({}, 0.01, true).between(1.0, 4.0);
    ASSERT_TRUE(moved);
    EXPECT_TRUE(moved->confirms);
    EXPECT_NEAR(std::sqrt(moved->covariance_m2(0, 0)), 0.9, 1e-6);
    EXPECT_NEAR(moved->covariance_m2(1, 1), 0.0, 1e-12);
}

TEST(WheelMotion, ItsScaleIsThatOfTheOtherRuns) {
    // The window's own run, and one within a minute of it, say nothing, whatever they show.
    const std::vector<WheelRun> runs{run_at(-500.0, 1.010), run_at(-300.0, 1.012),
                                     run_at(-60.0, 1.5), run_at(0.0, 1.7), run_at(400.0, 1.011)};
    const WheelMotion wheel = rolling(runs, 1e-4, false);
    const auto moved = wheel.between(1.0, 4.0);
    ASSERT_TRUE(moved);
    EXPECT_TRUE(moved->confirms);
    EXPECT_NEAR(moved->displacement_m.x(), 90.0 * 1.011, 1e-9);
    EXPECT_NEAR(wheel.path_between(1.0, 4.0).value(), 90.0 * 1.011, 1e-9);
    // Three that differ by 0.001: 2.195 times, by Student's t, and for the run itself.
    const double sigma = std::hypot(0.001, 0.001 * std::sqrt(4.0 / 3.0) * 4.3027 / 1.95996);
    EXPECT_NEAR(std::sqrt(moved->covariance_m2(0, 0)), sigma * 90.0 * 1.011, 1e-3);
}

TEST(WheelMotion, RunsOfBothDirectionsCountAlike) {
    const WheelMotion wheel = rolling(
        {run_at(-500.0, 1.02), run_at(-300.0, 1.02), run_at(400.0, 1.00, -1.0)}, 1e-4, false);
    EXPECT_NEAR(wheel.scale_for(1.0, 4.0, {1.0, 0.0}).value, 1.01, 1e-12);
}

TEST(WheelMotion, WithFewerThanTwoOtherRunsItConfirmsNothing) {
    for (const auto& runs :
         {std::vector<WheelRun>{}, {run_at(0.0, 1.0)}, {run_at(0.0, 1.0), run_at(300.0, 1.0)}}) {
        const auto moved = rolling(runs, 1e-4, false).between(1.0, 4.0);
        ASSERT_TRUE(moved);
        EXPECT_FALSE(moved->confirms);
        EXPECT_NEAR(moved->displacement_m.x(), 90.0, 1e-9);
    }
}

TEST(WheelWitness, SaysNothingOfAnotherTimeOrOfStandstill) {
    const Recorded run(60.0);
    std::vector<TimedValue> later = wheel(60.0, 1.0, 0.0, 0.05);
    for (TimedValue& one : later)
        one.time_s += 1000.0;
    EXPECT_FALSE(wheel_witness({.m_s = later}, timed_positions<2>(run.screened.rows),
                               track_of(run.trajectory), 0.6));
    std::vector<TimedValue> nothing = wheel(60.0, 1.0, 0.0, 0.0);
    for (TimedValue& one : nothing)
        one.value = 0.0;
    EXPECT_FALSE(wheel_witness({.m_s = nothing}, timed_positions<2>(run.screened.rows),
                               track_of(run.trajectory), 0.6));
    EXPECT_FALSE(
        wheel_witness({}, timed_positions<2>(run.screened.rows), track_of(run.trajectory), 0.6));
}

TEST(GateWitness, GivesTheDistanceBetweenTheNearestGates) {
    const Recorded run(60.0);
    const auto way = [](double time_s) { return 20.0 * time_s - 30.0 * std::cos(0.3 * time_s); };
    const std::vector<TimedValue> passages{
        {10.0, 0.0}, {20.0, way(20.0) - way(10.0)}, {23.0, way(23.0) - way(10.0)}};
    const auto found = gate_witness(passages, {.sigma_distance_m = 0.01, .sigma_time_s = 0.0005},
                                    track_of(run.trajectory));
    ASSERT_TRUE(found);
    const auto moved = found->between(20.0, 23.0);
    ASSERT_TRUE(moved);
    EXPECT_NEAR(moved->displacement_m.norm(), way(23.0) - way(20.0), 1e-9);
    const Vector2d along = moved->displacement_m.normalized();
    const double speed = std::hypot(speed_at(20.0), speed_at(23.0));
    EXPECT_NEAR(std::sqrt(along.dot(moved->covariance_m2 * along)),
                std::hypot(0.01, 0.0005 * speed), 1e-5);
    // WitnessRecords the gates: the speed there takes it further.
    const auto beside = found->between(20.1, 23.2);
    ASSERT_TRUE(beside);
    EXPECT_NEAR(beside->displacement_m.norm(), way(23.2) - way(20.1), 0.1);
    EXPECT_GT(along.dot(beside->covariance_m2 * along), along.dot(moved->covariance_m2 * along));
    EXPECT_FALSE(found->between(12.0, 20.0));
    EXPECT_FALSE(found->between(20.0, 20.2));
    // The passages that enclose other instants.
    EXPECT_EQ(found->enclosing(11.0, 12.0)->first_s, 10.0);
    EXPECT_EQ(found->enclosing(11.0, 12.0)->last_s, 20.0);
    EXPECT_EQ(found->enclosing(20.0, 21.0)->first_s, 20.0);
    EXPECT_EQ(found->enclosing(19.0, 22.0)->last_s, 23.0);
    EXPECT_FALSE(found->enclosing(9.0, 12.0));
    EXPECT_FALSE(found->enclosing(22.0, 24.0));
    EXPECT_EQ(found->covered().first_s, 10.0);
    // One gate, or gates of another time, say nothing.
    EXPECT_FALSE(gate_witness(std::vector<TimedValue>{{10.0, 0.0}}, {}, track_of(run.trajectory)));
    EXPECT_FALSE(gate_witness(std::vector<TimedValue>{{1000.0, 0.0}, {1003.0, 60.0}}, {},
                              track_of(run.trajectory)));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
