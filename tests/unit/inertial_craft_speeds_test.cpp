#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "inertial_test_support.h"
#include "stages/window/craft_speeds.h"

// The speed of the point beside the antenna, where a rule counts the antenna's.

namespace runcert::RUNCERT_FILE {
namespace {

// Both distances from the IMU were measured, with 5 cm, and its clock may be late unseen. The joint
// covariance, which was all that counted, holds one of the distances.
TEST(InertialCraftSpeeds, HoldTheTruthWhereBothDistancesAreMeasured) {
    constexpr double tape_m = 0.05;
    constexpr std::size_t first = 300, last = 330;
    Profile profile;
    profile.duration_s = 3.0;
    int inside = 0;
    double squares = 0.0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        InertialRunSpec spec = test::lake(ImuClass::tactical, seed);
        spec.duration_s = 45.0;
        const InertialRun run = simulate_inertial(spec);
        InertialSetup setup = setup_of(spec);
        RandomGenerator random(1000 + seed);
        for (Eigen::Vector3d* const arm : {&setup.antenna_m, &setup.reference_point_m})
            for (int k = 0; k < 3; ++k)
                (*arm)(k) += tape_m * random.normal();
        setup.antenna_sigma_m = tape_m;
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup);
        const std::size_t offset = test::first_truth(run, solution);
        const double from_s = solution.epochs[first].time_s, to_s = solution.epochs[last].time_s;
        WindowSpan span;
        span.start.nanoseconds = std::llround(1e9 * from_s);
        span.duration.nanoseconds = std::llround(1e9 * (to_s - from_s));
        const CraftSpeeds found = craft_speeds(solution, profile, span, 60.0, 0.1);
        const double truth_m_s = (run.truth[offset + last].reference_point_m -
                                  run.truth[offset + first].reference_point_m)
                                     .head<2>()
                                     .norm() /
                                 (to_s - from_s);
        const double error_m_s = found.reference_point_speed_m_s.value() - truth_m_s;
        const PointDisplacement moved =
            solution.displacement(first, last, CraftPoint::reference_point);
        const Eigen::Vector2d way = moved.enu_m.head<2>().normalized();
        const double alone_m_s =
            2.0 * std::sqrt(way.dot(moved.covariance_m2.topLeftCorner<2, 2>() * way)) /
            (to_s - from_s);
        EXPECT_GT(*found.reference_point_expanded_uncertainty_m_s, 1.001 * alone_m_s);
        inside += std::abs(error_m_s) <= *found.reference_point_expanded_uncertainty_m_s;
        squares += std::pow(2.0 * error_m_s / *found.reference_point_expanded_uncertainty_m_s, 2);
    }
    EXPECT_GE(inside, 38);
    // A mean square of 40: between 0.45 and 1.8 but once in a thousand.
    EXPECT_GT(squares / 40.0, 0.45);
    EXPECT_LT(squares / 40.0, 1.8);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
