#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "inertial/alignment.h"
#include "inertial_test_support.h"

// How a solution starts: standing, from the course, by search; and what it refuses.
namespace runcert::RUNCERT_FILE {
namespace {

using test::attitude_error_deg;
using test::lake;
using test::oval;

constexpr double rad = radians_per_degree;

InertialRunSpec standing(ImuClass grade, std::uint64_t seed) {
    InertialRunSpec spec = lake(grade, seed);
    spec.stand_s = 60.0;
    spec.duration_s = 60.0;
    return spec;
}

TEST(StartMethod, StandingGivesWhatGravityAndTheEarthCan) {
    double tilt = 0.0, heading = 0.0;
    StandingMeans last;
    constexpr int runs = 60;
    for (int i = 0; i < runs; ++i) {
        InertialRunSpec spec = standing(ImuClass::tactical, static_cast<std::uint64_t>(i));
        spec.duration_s = 1.0;
        const InertialRun run = simulate_inertial(spec);
        const EarthFrame earth(spec.origin);
        const StandingMeans found = standing_means(run.samples, 1.0, 55.0, earth, spec.noise);
        const std::array pairs{found.gravity(earth, found.tilt_sigma_rad),
                               found.rotation(earth, found.heading_sigma_rad)};
        const auto start = attitude_by_directions(pairs);
        ASSERT_TRUE(start);
        const Eigen::Vector3d error =
            rotation_vector(start->enu_from_body * run.truth[0].imu.enu_from_body.transpose());
        EXPECT_NEAR(std::sqrt(start->covariance_rad2(2, 2)), found.heading_sigma_rad, 1e-9);
        tilt += error.head<2>().squaredNorm() / 2.0 / runs;
        heading += error.z() * error.z() / runs;
        last = found;
    }
    // 1 mg; 1 degree/h and as much of noise over 54 s, at 31.6 degrees of latitude.
    EXPECT_NEAR(last.tilt_sigma_rad / rad, 0.058, 0.003);
    EXPECT_NEAR(last.heading_sigma_rad / rad, 6.4, 0.2);
    EXPECT_NEAR(std::sqrt(tilt) / last.tilt_sigma_rad, 1.0, 0.25);
    EXPECT_NEAR(std::sqrt(heading) / last.heading_sigma_rad, 1.0, 0.3);
    std::printf("standing: tilt to %.3f deg, heading to %.2f deg (stated %.3f, %.2f)\n",
                std::sqrt(tilt) / rad, std::sqrt(heading) / rad, last.tilt_sigma_rad / rad,
                last.heading_sigma_rad / rad);
}

TEST(StartMethod, AHeadingThatTheGyrosCannotTellIsSaidToBeNone) {
    const InertialRunSpec spec = standing(ImuClass::mems, 3);
    const InertialRun run = simulate_inertial(spec);
    const EarthFrame earth(spec.origin);
    const StandingMeans found = standing_means(run.samples, 1.0, 55.0, earth, spec.noise);
    EXPECT_GT(found.heading_sigma_rad, 1.0);
    EXPECT_LT((found.rate_rad_s - run.truth[0].bias.gyro_rad_s).norm(), 4e-4);
    const DirectionPair gravity = found.gravity(earth, found.tilt_sigma_rad);
    EXPECT_FALSE(attitude_by_directions(std::span(&gravity, 1)));
    EXPECT_LT(
        (run.truth[0].imu.enu_from_body * gravity.body.normalized() - gravity.enu.normalized())
            .norm(),
        6.0 * found.tilt_sigma_rad);
}

TEST(StartMethod, AccelerometersInOtherUnitsAreRefused) {
    const InertialRunSpec spec = standing(ImuClass::mems, 3);
    InertialRun run = simulate_inertial(spec);
    for (ImuSample& sample : run.samples)
        sample.velocity_m_s /= 9.8;
    try {
        smooth_inertial(run.samples, run.fixes, setup_of(spec));
        ADD_FAILURE();
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), "IMU");
        EXPECT_NE(failure.remedy().find("unit"), std::string::npos);
    }
}

TEST(StartMethod, ACraftThatStandsFirstIsSmoothedFromItsFirstPosition) {
    for (const ImuClass grade : {ImuClass::tactical, ImuClass::mems, ImuClass::consumer}) {
        const InertialRunSpec spec = standing(grade, 4);
        const InertialRun run = simulate_inertial(spec);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        EXPECT_EQ(solution.start, StartMethod::course);
        EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
        const std::size_t first = test::first_truth(run, solution);
        EXPECT_LE(first, 6U);
        const std::size_t moving = 800;
        EXPECT_LT(attitude_error_deg(solution.epochs[moving].enu_from_body,
                                     run.truth[first + moving].imu.enu_from_body),
                  0.3)
            << static_cast<int>(grade);
        const test::SpeedErrors errors = test::speed_errors(run, solution, 30, 1, 750);
        EXPECT_LT(root_mean_square(errors.errors_m_s), 0.0025);
    }
}

TEST(StartMethod, WithoutACourseTheLikeliestHeadingIsFound) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        InertialRunSpec spec = lake(ImuClass::mems, seed);
        spec.speed_m_s = 4.0;
        spec.antenna_m = {0.0, 0.0, -1.0};
        const InertialRun run = simulate_inertial(spec);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        EXPECT_EQ(solution.start, StartMethod::search);
        const std::size_t first = test::first_truth(run, solution);
        const double error = attitude_error_deg(solution.epochs[500].enu_from_body,
                                                run.truth[first + 500].imu.enu_from_body);
        EXPECT_LT(error, 4.0 * solution.epochs[500].attitude_sigma.heading / rad + 0.1) << seed;
        std::printf("search: error %.2f deg, stated %.2f, NIS/3 %.2f\n", error,
                    solution.epochs[500].attitude_sigma.heading / rad, solution.consistency.nis);
    }
}

// A craft that runs backwards, or an IMU with its axes turned: the course is no heading.
TEST(StartMethod, ACourseThatIsNoHeadingIsCorrected) {
    const InertialRunSpec spec = lake(ImuClass::mems, 6);
    InertialRun run = simulate_inertial(spec);
    const Eigen::DiagonalMatrix<double, 3> about_down(-1.0, -1.0, 1.0);
    for (ImuSample& sample : run.samples) {
        sample.angle_rad = about_down * sample.angle_rad;
        sample.velocity_m_s = about_down * sample.velocity_m_s;
    }
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
    const std::size_t first = test::first_truth(run, solution);
    const Eigen::Matrix3d found = solution.epochs[500].enu_from_body * about_down.toDenseMatrix();
    EXPECT_LT(attitude_error_deg(found, run.truth[first + 500].imu.enu_from_body), 0.4);
}

// The surface of another place, one that is banked to the other side, one turned by 5 degrees, and
// the right one: each starts the solution, which comes out as without it.
TEST(StartMethod, ASurfaceStartsTheSolutionAndNeverMovesIt) {
    InertialRunSpec spec = test::oval(ImuClass::mems, 21);
    spec.duration_s = 40.0;
    const InertialRun run = simulate_inertial(spec);
    const InertialSetup setup = setup_of(spec);
    const InertialSolution without = smooth_inertial(run.samples, run.fixes, setup);
    EXPECT_EQ(without.start, StartMethod::course);
    const Eigen::Matrix3d tilt =
        rotation_about(5.0 * radians_per_degree * Eigen::Vector3d(0.6, 0.8, 0.0));
    enum class Ground { right, turned_over, tilted, elsewhere };
    for (const Ground ground :
         {Ground::right, Ground::turned_over, Ground::tilted, Ground::elsewhere}) {
        std::vector<PositionFix> fixes = run.fixes;
        for (std::size_t k = 0; k < fixes.size(); ++k) {
            const Eigen::Vector3d& normal = run.truth[k].ground_normal;
            const std::size_t other = (k + fixes.size() / 2) % fixes.size();
            fixes[k].ground_normal = ground == Ground::right ? normal
                                     : ground == Ground::turned_over
                                         ? Eigen::Vector3d(-normal.x(), -normal.y(), normal.z())
                                     : ground == Ground::tilted ? Eigen::Vector3d(tilt * normal)
                                                                : run.truth[other].ground_normal;
        }
        const InertialSolution solution = smooth_inertial(run.samples, fixes, setup);
        ASSERT_EQ(solution.epochs.size(), without.epochs.size());
        EXPECT_EQ(solution.start, StartMethod::surface);
        double most = 0.0;
        for (std::size_t s = 0; s + 30 < solution.epochs.size(); s += 10) {
            const auto speed = [&](const InertialSolution& of) {
                return of.displacement(s, s + 30, CraftPoint::reference_point).enu_m.norm();
            };
            const double sigma_m = std::sqrt(
                without.displacement(s, s + 30, CraftPoint::reference_point).covariance_m2.trace());
            most = std::max(most, std::abs(speed(solution) - speed(without)) / sigma_m);
        }
        std::printf("ground %d: start %d, chords moved by %.1e of their sigma at most\n",
                    static_cast<int>(ground), static_cast<int>(solution.start), most);
        EXPECT_LT(most, 3e-3);
    }
}

TEST(StartMethod, RefusesWhatCannotBeSmoothed) {
    const InertialRunSpec spec = lake(ImuClass::mems, 7);
    const InertialRun run = simulate_inertial(spec);
    const auto problem = [&](const std::vector<ImuSample>& samples,
                             const std::vector<PositionFix>& fixes) -> std::string {
        try {
            smooth_inertial(samples, fixes, setup_of(spec));
        } catch (const Failure& failure) {
            EXPECT_FALSE(failure.remedy().empty());
            return failure.where() + ": " + failure.problem();
        }
        return "";
    };
    auto fixes = run.fixes;
    for (PositionFix& fix : fixes)
        fix.time_s += 5000.0;
    EXPECT_NE(problem(run.samples, fixes).find("0 positions lie within"), std::string::npos);
    fixes = run.fixes;
    fixes[100].time_s = fixes[99].time_s;
    EXPECT_EQ(problem(run.samples, fixes).rfind("positions, time 9.9", 0), 0U);
    fixes = run.fixes;
    fixes[100].enu_m.y() = std::nan("");
    EXPECT_NE(problem(run.samples, fixes).find("finite"), std::string::npos);
    fixes = run.fixes;
    fixes[100].covariance_m2(1, 1) = -1.0;
    EXPECT_NE(problem(run.samples, fixes).find("covariance"), std::string::npos);
    EXPECT_NE(problem({}, run.fixes).find("no samples"), std::string::npos);
}

// White acceleration of 0.8 m/s^2 an axis while the craft stands, growing to 9 at its top speed.
TEST(InertialShaking, AnEngineAndVibrationThatGrowsWithSpeedAreTold) {
    InertialRunSpec spec = standing(ImuClass::mems, 12);
    spec.stand_s = 20.0;
    InertialRun run = simulate_inertial(spec);
    RandomGenerator random(3);
    for (ImuSample& sample : run.samples) {
        const std::size_t epoch =
            std::min(run.truth.size() - 1, static_cast<std::size_t>(10.0 * sample.time_s));
        const double size_m_s2 =
            0.8 + 8.2 * run.truth[epoch].imu.velocity_m_s.norm() / spec.speed_m_s;
        for (double& each : sample.velocity_m_s)
            each += sample.interval_s * size_m_s2 * random.normal();
    }
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    ASSERT_FALSE(solution.consistency.consistent());
    const Shaking& shaking = solution.consistency.shaking;
    EXPECT_NEAR(shaking.standing_m_s2, 0.8 * std::sqrt(3.0), 0.1);
    EXPECT_GT(shaking.slow_m_s2, shaking.standing_m_s2);
    EXPECT_GT(shaking.fast_m_s2, 2.0 * shaking.slow_m_s2);
    EXPECT_LT(shaking.fast_m_s2, 9.0 * std::sqrt(3.0) + 1.0);
}

TEST(InertialGaps, SpansThatOnlyTheImuBridgesAreNamed) {
    const InertialRunSpec spec = oval(ImuClass::mems, 8);
    InertialRun run = simulate_inertial(spec);
    const InertialSolution whole = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    EXPECT_TRUE(whole.bridged.empty());
    run.fixes.erase(run.fixes.begin() + 400, run.fixes.begin() + 450);  // 40.0 to 44.9 s
    run.truth.erase(run.truth.begin() + 400, run.truth.begin() + 450);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    ASSERT_EQ(solution.bridged.size(), 1U);
    EXPECT_NEAR(solution.bridged[0].from_s, 39.9, 1e-9);
    EXPECT_NEAR(solution.bridged[0].to_s, 45.0, 1e-9);
    EXPECT_FALSE(solution.bridged[0].imu_missing);
    const std::size_t before = 399 - test::first_truth(run, solution);
    EXPECT_FALSE(solution.bridged_between(before - 30, before));
    EXPECT_TRUE(solution.bridged_between(before, before + 1));
    EXPECT_TRUE(solution.bridged_between(before - 30, before + 30));
    EXPECT_FALSE(solution.bridged_between(before + 1, before + 31));
    const auto across = solution.displacement(before, before + 1, CraftPoint::reference_point);
    const Eigen::Vector3d error =
        across.enu_m - (run.truth[400].reference_point_m - run.truth[399].reference_point_m);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_LT(std::abs(error(axis)), 4.0 * std::sqrt(across.covariance_m2(axis, axis)));
}

TEST(InertialGaps, MissingSamplesAreNamedAndSurvived) {
    for (const std::ptrdiff_t missing : {3, 200}) {
        const InertialRunSpec spec = lake(ImuClass::mems, 9);
        InertialRun run = simulate_inertial(spec);
        run.samples.erase(run.samples.begin() + 5000, run.samples.begin() + 5000 + missing);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        ASSERT_GE(solution.bridged.size(), 1U) << missing;
        for (const BridgedStretch& span : solution.bridged) {
            EXPECT_TRUE(span.imu_missing);
            EXPECT_GE(span.to_s, 50.0);
            EXPECT_LE(span.from_s, 50.0 + 0.01 * static_cast<double>(missing));
        }
        const std::size_t first = test::first_truth(run, solution);
        EXPECT_LT(attitude_error_deg(solution.epochs[900].enu_from_body,
                                     run.truth[first + 900].imu.enu_from_body),
                  0.3);
        EXPECT_LT(solution.consistency.nis, 1.2);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
