#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "inertial/alignment.h"
#include "inertial/antenna_baseline.h"
#include "inertial_test_support.h"

// A second antenna on the craft: the heading while it stands, and a check of the inertial one.
namespace runcert::RUNCERT_FILE {
namespace {

constexpr double rad = radians_per_degree;

/// A craft on a lake with a mast amidships and a second antenna at its bow, 2 m ahead of the IMU.
InertialRunSpec with_bow(std::uint64_t seed, double stand_s = 60.0) {
    InertialRunSpec spec = test::lake(ImuClass::mems, seed);
    spec.antenna_m = {0.0, 0.0, -1.0};
    spec.second_antenna_m = Eigen::Vector3d(2.0, 0.3, -0.5);
    spec.stand_s = stand_s;
    spec.duration_s = 40.0;
    return spec;
}

/// The baseline as an attempt would state it, with the second antenna at `second_m`.
AntennaBaseline stated(const InertialRun& run, const InertialRunSpec& spec,
                       const Eigen::Vector3d& second_m) {
    AntennaBaseline baseline{.body_m = second_m - spec.antenna_m};
    for (std::size_t k = 0; k < run.fixes.size(); ++k)
        baseline.fixes.push_back(
            {.time_s = run.fixes[k].time_s,
             .enu_m = run.second_fixes[k].enu_m - run.fixes[k].enu_m,
             .covariance_m2 = run.fixes[k].covariance_m2 + run.second_fixes[k].covariance_m2});
    return baseline;
}

InertialSetup setup_with(const InertialRun& run, const InertialRunSpec& spec,
                         const Eigen::Vector3d& second_m) {
    InertialSetup setup = setup_of(spec);
    setup.baseline = stated(run, spec, second_m);
    return setup;
}

// A MEMS gyro feels nothing of the Earth's rotation. The places of the antennas are exact here, so
// that what is stated of them is not in the errors: 12 mm white and 8 mm correlated over 60 s, each
// antenna, over 2.02 m.
TEST(AntennaBaseline, GivesTheHeadingOfACraftThatStands) {
    double squares = 0.0, tilt_squares = 0.0, sigma_rad = 0.0;
    constexpr int runs = 60;
    for (int i = 0; i < runs; ++i) {
        InertialRunSpec spec = with_bow(static_cast<std::uint64_t>(500 + i), 30.0);
        spec.duration_s = 1.0;
        const InertialRun run = simulate_inertial(spec);
        AntennaBaseline baseline = stated(run, spec, *spec.second_antenna_m);
        baseline.body_sigma_m = 0.0;
        const EarthFrame earth(spec.origin);
        Eigen::Vector3d force = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < 2500; ++k)
            force += run.samples[k].velocity_m_s / 25.0;
        const DirectionPair gravity = StandingMeans{.force_m_s2 = force}.gravity(earth, 0.3 * rad);
        const auto antennas = direction_of(baseline, 0.5, 25.0, gravity, spec.position_error);
        ASSERT_TRUE(antennas);
        const auto start = attitude_by_directions(std::array{gravity, *antennas});
        ASSERT_TRUE(start);
        const Eigen::Vector3d error =
            rotation_vector(start->enu_from_body * run.truth[0].imu.enu_from_body.transpose());
        squares += error.z() * error.z() / runs;
        tilt_squares += error.head<2>().squaredNorm() / 2.0 / runs;
        const Eigen::Matrix3d jacobian = euler_jacobian(start->enu_from_body);
        sigma_rad =
            std::sqrt((jacobian * start->covariance_rad2 * jacobian.transpose()).diagonal().z());
    }
    std::printf("heading to %.3f deg (stated %.3f), tilt to %.3f deg\n", std::sqrt(squares) / rad,
                sigma_rad / rad, std::sqrt(tilt_squares) / rad);
    // 8 mm times the root of 2, of which 0.46 remain over eight correlation times, makes 0.15
    // degrees; and a tilt of 0.3 degrees turns a second antenna that is 0.5 m lower by 0.07.
    EXPECT_NEAR(sigma_rad / rad, 0.167, 0.02);
    EXPECT_NEAR(std::sqrt(squares) / sigma_rad, 1.0, 0.3);
    EXPECT_LT(std::sqrt(tilt_squares) / rad, 0.4);
}

TEST(AntennaBaseline, StartsACraftThatStands) {
    for (const double speed_m_s : {60.0, 3.0}) {
        InertialRunSpec spec = with_bow(4);
        spec.speed_m_s = speed_m_s;
        const InertialRun run = simulate_inertial(spec);
        const InertialSetup setup = setup_with(run, spec, *spec.second_antenna_m);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
        EXPECT_EQ(solution.start, StartMethod::baseline);
        EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
        // Without it: the course, and below 5 m/s a search.
        const InertialSolution without = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        EXPECT_EQ(without.start, speed_m_s > 5.0 ? StartMethod::course : StartMethod::search);
        const std::size_t first = test::first_truth(run, solution);
        const auto error_deg = [&](const InertialSolution& found) {
            return test::attitude_error_deg(found.epochs[200].enu_from_body,
                                            run.truth[first + 200].imu.enu_from_body);
        };
        std::printf("%.0f m/s: while standing to %.3f deg (stated %.3f), without to %.3f (%.3f)\n",
                    speed_m_s, error_deg(solution),
                    solution.epochs[200].attitude_sigma.heading / rad, error_deg(without),
                    without.epochs[200].attitude_sigma.heading / rad);
        EXPECT_LT(error_deg(solution), 1.5);
    }
}

TEST(AntennaBaseline, JudgesTheInertialHeading) {
    double normalised = 0.0;
    constexpr int runs = 12;
    for (int i = 0; i < runs; ++i) {
        const InertialRunSpec spec = with_bow(static_cast<std::uint64_t>(700 + i), 0.0);
        const InertialRun run = simulate_inertial(spec);
        InertialSetup setup = setup_with(run, spec, *spec.second_antenna_m);
        setup.baseline->body_sigma_m = 0.0;
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
        const auto judged = judge_baseline(solution, *setup.baseline, setup.position_error);
        ASSERT_TRUE(judged);
        EXPECT_EQ(judged->headings.size(), solution.epochs.size());
        EXPECT_TRUE(is_stated_length(*setup.baseline, judged->length_m));
        normalised +=
            std::pow(judged->difference_rad.value / judged->difference_rad.sigma, 2) / runs;
        const std::size_t first = test::first_truth(run, solution);
        double epoch_errors = 0.0;
        for (std::size_t k = 0; k < judged->headings.size(); ++k) {
            const BaselineHeading& one = judged->headings[k];
            ASSERT_EQ(one.time_s, solution.epochs[k].time_s);
            const double truth = euler_angles(run.truth[first + k].imu.enu_from_body).heading;
            epoch_errors +=
                std::pow(std::remainder(one.heading_rad - truth, 2.0 * std::numbers::pi), 2);
        }
        // 12 and 8 mm, both antennas, over 2.02 m: 0.58 degrees, and what pitch and roll add.
        EXPECT_NEAR(std::sqrt(epoch_errors / static_cast<double>(judged->headings.size())) / rad,
                    0.58, 0.12);
    }
    // A mean square of twelve normalised differences: above 2.8 once in a thousand.
    std::printf("mean square of the normalised differences %.2f\n", normalised);
    EXPECT_LT(normalised, 2.8);
    EXPECT_GT(normalised, 0.15);
}

TEST(AntennaBaseline, FindsAntennasThatAreStatedWrongly) {
    const InertialRunSpec spec = with_bow(8);
    const InertialRun run = simulate_inertial(spec);
    const auto judged = [&](const Eigen::Vector3d& second_m) {
        const InertialSetup setup = setup_with(run, spec, second_m);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
        const auto found = judge_baseline(solution, *setup.baseline, setup.position_error);
        EXPECT_TRUE(found);
        return std::pair(solution.start, *found);
    };
    // At the stern, or to port: the length is right, and the course tells.
    const auto [stern_start, stern] = judged({-2.0, -0.3, -0.5});
    EXPECT_FALSE(stern.agrees);
    EXPECT_NEAR(std::abs(stern.difference_rad.value) / rad, 180.0, 1.0);
    const auto [port_start, port] = judged({0.3, -2.0, -0.5});
    EXPECT_FALSE(port.agrees);
    EXPECT_NEAR(port.difference_rad.value / rad, 90.0, 1.0);
    EXPECT_EQ(stern_start, StartMethod::course);
    EXPECT_EQ(port_start, StartMethod::course);
    // Half as far, or higher: nothing is taken from it for a start.
    const auto [near_start, near] = judged({1.0, 0.3, -0.5});
    EXPECT_EQ(near_start, StartMethod::course);
    EXPECT_FALSE(is_stated_length({.body_m = {1.0, 0.3, 0.5}}, near.length_m));
    EXPECT_NEAR(near.length_m.value, Eigen::Vector3d(2.0, 0.3, 0.5).norm(), 0.03);
    const auto [high_start, high] = judged({2.0, 0.3, -1.5});
    EXPECT_EQ(high_start, StartMethod::course);
    // One above the other shows no heading.
    AntennaBaseline mast = stated(run, spec, {0.1, 0.0, -6.0});
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    EXPECT_FALSE(judge_baseline(solution, mast, {}));
    mast.fixes.clear();
    EXPECT_FALSE(judge_baseline(solution, mast, {}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
