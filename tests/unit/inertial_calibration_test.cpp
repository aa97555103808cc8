#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "inertial/mount.h"
#include "inertial_test_support.h"

// Lever arm, time offset and mount where the motion shows them, and what is said where it does not.
namespace runcert::RUNCERT_FILE {
namespace {

using test::lake;
using test::oval;

constexpr double rad = radians_per_degree;

bool has(const InertialSolution& solution, InertialFinding finding) {
    return std::ranges::any_of(solution.consistency.doubts, [&](const InertialDoubt& doubt) {
        return doubt.finding == finding;
    });
}

TEST(InertialCalibration, FindsArmAndTimeOffsetUnderAMast) {
    const Eigen::Vector3d wrong(0.10, -0.08, 0.06);
    Eigen::Vector3d squares = Eigen::Vector3d::Zero(), normalised = Eigen::Vector3d::Zero();
    double offset_squares = 0.0, offset_normalised = 0.0;
    constexpr int runs = 8;
    for (int i = 0; i < runs; ++i) {
        InertialRunSpec spec = lake(ImuClass::mems, static_cast<std::uint64_t>(300 + i));
        spec.time_offset_s = 0.02;
        const InertialRun run = simulate_inertial(spec);
        InertialSetup setup = setup_of(spec);
        setup.antenna_m += wrong;
        setup.antenna_sigma_m = 0.2;
        setup.estimate_antenna = true;
        setup.estimate_time_offset = true;
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
        EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
        const Eigen::Vector3d error = solution.antenna_m.value - spec.antenna_m;
        squares += error.cwiseAbs2() / runs;
        normalised += error.cwiseQuotient(solution.antenna_m.sigma).cwiseAbs2() / runs;
        offset_squares += std::pow(solution.time_offset_s.value - 0.02, 2) / runs;
        offset_normalised +=
            std::pow((solution.time_offset_s.value - 0.02) / solution.time_offset_s.sigma, 2) /
            runs;
    }
    const Eigen::Vector3d rms = squares.cwiseSqrt();
    std::printf(
        "arm forward, right, down to %.1f, %.1f, %.1f mm (normalised %.2f %.2f %.2f), time "
        "offset to %.2f ms (%.2f)\n",
        1e3 * rms.x(), 1e3 * rms.y(), 1e3 * rms.z(), normalised.x(), normalised.y(), normalised.z(),
        1e3 * std::sqrt(offset_squares), offset_normalised);
    EXPECT_LT(rms.x(), 0.08);
    EXPECT_LT(rms.y(), 0.02);
    EXPECT_LT(rms.z(), 0.02);
    EXPECT_LT(std::sqrt(offset_squares), 0.001);
    // Mean squares of eight normalised errors: above 2.7 or below 0.2 once in a thousand.
    for (const double each : {normalised.x(), normalised.y(), normalised.z(), offset_normalised}) {
        EXPECT_LT(each, 3.3);
        EXPECT_GT(each, 0.1);
    }
}

TEST(InertialCalibration, TheLikelihoodAsksForTheTimeOffset) {
    InertialRunSpec spec = lake(ImuClass::mems, 11);
    spec.time_offset_s = 0.05;
    const InertialRun run = simulate_inertial(spec);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    EXPECT_TRUE(solution.time_offset_asked_by_innovations);
    EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
    EXPECT_NEAR(solution.time_offset_s.value, 0.05, 4.0 * solution.time_offset_s.sigma);
    EXPECT_LT(solution.time_offset_s.sigma, 1e-3);
    // At the offset the state is that at the positions' times.
    const test::SpeedErrors errors = test::speed_errors(run, solution);
    EXPECT_LT(root_mean_square(errors.errors_m_s), 0.0035);
    // Declared, it asks for nothing.
    InertialSetup declared = setup_of(spec);
    declared.time_offset_s = 0.05;
    const InertialSolution told = smooth_inertial(run.samples, run.fixes, declared);
    EXPECT_FALSE(told.time_offset_asked_by_innovations);
    EXPECT_EQ(told.time_offset_s.sigma, 0.0);
    EXPECT_NEAR(told.consistency.nis, solution.consistency.nis, 0.02);
}

// Scale factors and axes wrong by 0.5 % are no random walk of a data sheet. Found: with data sheet
// noise the 3 s speed errs by 40 mm/s and states 2, at an NIS/3 that looks consistent.
TEST(InertialCalibration, TheLikelihoodRaisesNoiseThatGrowsWithMotion) {
    InertialRunSpec spec = oval(ImuClass::mems, 16);
    spec.scale_sigma = 0.005;
    const InertialRun run = simulate_inertial(spec);
    InertialSetup setup = setup_of(spec);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
    EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
    EXPECT_GT(solution.noise.motion_sqrt_s, 0.0005);
    const test::SpeedErrors fitted = test::speed_errors(run, solution);
    EXPECT_GT(fitted.inside(), 0.85);
    EXPECT_LT(root_mean_square(fitted.errors_m_s), 0.005);
    setup.fit_noise = false;
    const InertialSolution plain = smooth_inertial(run.samples, run.fixes, setup);
    EXPECT_EQ(plain.noise.motion_sqrt_s, 0.0);
    EXPECT_LT(test::speed_errors(run, plain).inside(), 0.8);
    EXPECT_LT(plain.log_likelihood, solution.log_likelihood - 50.0);
    std::printf("scale 0.5 %%: NIS/3 %.2f, inside %.3f; fitted %.2f, %.3f, RMS %.2f mm/s\n",
                plain.consistency.nis, test::speed_errors(run, plain).inside(),
                solution.consistency.nis, fitted.inside(),
                1e3 * root_mean_square(fitted.errors_m_s));
    // An IMU that is as its data sheet keeps it.
    spec.scale_sigma = 0.0;
    const InertialRun good = simulate_inertial(spec);
    EXPECT_LE(smooth_inertial(good.samples, good.fixes, setup_of(spec)).noise.motion_sqrt_s,
              0.0005);
}

TEST(InertialCalibration, AVerticalArmOnAStiffCraftIsDoubted) {
    InertialRunSpec spec = lake(ImuClass::mems, 13);
    spec.roll_deg = spec.pitch_deg = 0.3;
    spec.antenna_m = {0.3, 0.0, -1.0};
    const InertialRun run = simulate_inertial(spec);
    InertialSetup setup = setup_of(spec);
    setup.antenna_sigma_m = 0.5;
    EXPECT_TRUE(smooth_inertial(run.samples, run.fixes, setup).consistency.consistent());
    setup.estimate_antenna = true;
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
    EXPECT_TRUE(has(solution, InertialFinding::vertical_arm_unobservable));
    EXPECT_GT(solution.antenna_m.sigma.z(), 0.02);
}

// [FHB03]'s Balzac: no heading on a straight.
TEST(InertialCalibration, AHeadingOnAStraightIsDoubtedWithAHorizontalArm) {
    InertialRunSpec spec = lake(ImuClass::consumer, 14);
    spec.duration_s = 15.0;
    spec.speed_m_s = 40.0;  // 7 to 15 m/s in that time
    spec.antenna_m = {-4.0, 0.0, -1.0};
    const InertialRun run = simulate_inertial(spec);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    EXPECT_TRUE(has(solution, InertialFinding::heading_unobservable));
    // The same IMU on an oval, and the same run with the arm upright, have no such doubt.
    InertialRunSpec turning = oval(ImuClass::consumer, 14);
    turning.antenna_m = spec.antenna_m;
    const InertialRun turned = simulate_inertial(turning);
    EXPECT_TRUE(
        smooth_inertial(turned.samples, turned.fixes, setup_of(turning)).consistency.consistent());
    spec.antenna_m = {0.0, 0.0, -4.0};
    const InertialRun upright = simulate_inertial(spec);
    EXPECT_FALSE(has(smooth_inertial(upright.samples, upright.fixes, setup_of(spec)),
                     InertialFinding::heading_unobservable));
    double sigma = 0.0;
    for (const InertialEpoch& epoch : solution.epochs)
        sigma = std::max(sigma, epoch.attitude_sigma.heading);
    std::printf("heading known to %.2f deg on a straight\n", sigma / rad);
}

/// A box turned in a craft on the oval, some of its epochs grossly wrong, and the ground below.
struct TurnedBox {
    InertialSolution solution;
    Eigen::Matrix3d mount = rotation_about(rad * Eigen::Vector3d(1.5, -2.0, 3.0));
    std::vector<std::optional<Eigen::Vector3d>> normals;
    std::size_t gross = 0;

    TurnedBox(std::uint64_t seed, double gross_share) {
        const InertialRunSpec spec = oval(ImuClass::tactical, seed);
        const InertialRun run = simulate_inertial(spec);
        solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        const std::size_t first = test::first_truth(run, solution);
        RandomGenerator random(seed);
        for (std::size_t k = 0; k < solution.epochs.size(); ++k) {
            InertialEpoch& epoch = solution.epochs[k];
            normals.emplace_back(run.truth[first + k].ground_normal);
            // Rates along the turned axes, as the box would give them.
            epoch.rate_rad_s = mount.transpose() * epoch.rate_rad_s;
            epoch.enu_from_body = epoch.enu_from_body * mount;
            if (random.uniform() > gross_share) continue;
            ++gross;
            epoch.enu_from_body =
                rotation_about(15.0 * rad * Eigen::Vector3d::Unit(static_cast<int>(gross % 3))) *
                epoch.enu_from_body;
        }
    }
    /// What a mount errs by about forward, right and down, in degrees.
    Eigen::Vector3d error_deg(const MountEstimate& found) const {
        return rotation_vector(found.craft_from_body * mount.transpose()) / rad;
    }
};

constexpr MountGate straights{.most_lateral_m_s2 = 4.9};

TEST(InertialCalibration, FindsTheMountFromSurfaceAndCourse) {
    double most_deg = 0.0;
    for (std::uint64_t seed = 15; seed < 18; ++seed)
        for (const double share : {0.0, 0.05}) {
            const TurnedBox box(seed, share);
            const auto found = estimate_mount(box.solution, straights, box.normals);
            ASSERT_TRUE(found);
            const Eigen::Vector3d error = box.error_deg(*found);
            std::printf("mount to %.3f %.3f %.3f deg, %zu of %zu epochs\n", error.x(), error.y(),
                        error.z(), found->retained, found->epochs);
            most_deg = std::max(most_deg, error.cwiseAbs().maxCoeff());
            if (share > 0.0) {
                EXPECT_LT(found->retained, found->epochs - box.gross / 4);
            }
        }
    EXPECT_LT(most_deg, 0.2);
}

// In turns the body leans and slips to one side, and editing keeps that.
TEST(InertialCalibration, WithoutTheGateTheMountTakesUpLeanAndSlip) {
    const TurnedBox box(15, 0.05);
    const auto found = estimate_mount(box.solution, {.most_lateral_m_s2 = 1e3}, box.normals);
    ASSERT_TRUE(found);
    const Eigen::Vector3d error = box.error_deg(*found);
    std::printf("without the gate to %.3f %.3f %.3f deg, %zu of %zu epochs\n", error.x(), error.y(),
                error.z(), found->retained, found->epochs);
    EXPECT_GT(std::abs(error.x()), 0.4);
    EXPECT_LT(std::abs(error.y()), 0.2);
    EXPECT_GT(std::abs(error.z()), 0.2);
}

TEST(InertialCalibration, WithoutASurfaceTheBankIsInTheMount) {
    TurnedBox box(15, 0.05);
    const auto found = estimate_mount(box.solution, straights);
    ASSERT_TRUE(found);
    const Eigen::Vector3d error = box.error_deg(*found);
    // On a straight the ground is banked by 3 degrees.
    EXPECT_NEAR(error.x(), -3.0, 0.35);
    EXPECT_NEAR(error.y(), 0.0, 0.2);
    EXPECT_NEAR(error.z(), 0.0, 0.2);
    EXPECT_FALSE(estimate_mount(box.solution, {.least_speed_m_s = 200.0}));
    // Where the surface ends, epochs do not count; a surface of another run is refused.
    std::ranges::fill(box.normals, std::nullopt);
    EXPECT_FALSE(estimate_mount(box.solution, straights, box.normals));
    box.normals.pop_back();
    EXPECT_THROW(estimate_mount(box.solution, straights, box.normals), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
