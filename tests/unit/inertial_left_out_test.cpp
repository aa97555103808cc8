#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "inertial_test_support.h"

// What the IMU alone says of a span, and solving about a solution found before.

namespace runcert::RUNCERT_FILE {
namespace {

using test::lake;

constexpr std::size_t first_out = 300;
constexpr std::size_t last_out = 330;

/// Solved once more, about the solution, with other positions.
InertialSolution solved_about(const InertialSolution& solution, const InertialRun& run,
                              const std::vector<PositionFix>& fixes, InertialSetup setup) {
    setup.noise = solution.noise;
    setup.estimate_time_offset = solution.time_offset_s.sigma > 0.0;
    SolvedBefore& before = setup.before.emplace();
    before.time_offset_s = solution.time_offset_s.value;
    for (const InertialEpoch& epoch : solution.epochs) {
        ImuState& state = before.states.emplace_back();
        state.bias = epoch.bias;
        state.motion.enu_from_body = epoch.enu_from_body;
        // The reference point is at the IMU.
        state.motion.position_m = epoch.reference_point.position_m;
        state.motion.velocity_m_s = epoch.reference_point.velocity_m_s;
    }
    return smooth_inertial(run.samples, fixes, setup);
}

TEST(InertialSolvedBefore, OnePassGivesTheSame) {
    for (const double late_s : {0.0, 0.03}) {
        InertialRunSpec spec = lake(ImuClass::mems, 31);
        spec.time_offset_s = late_s;
        const InertialRun run = simulate_inertial(spec);
        const InertialSolution whole = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        const InertialSolution again = solved_about(whole, run, run.fixes, setup_of(spec));
        EXPECT_EQ(again.passes, 1);
        EXPECT_GT(whole.passes, 1);
        ASSERT_EQ(again.epochs.size(), whole.epochs.size());
        for (std::size_t k = 0; k < whole.epochs.size(); k += 7) {
            const PointMotion& point = whole.epochs[k].reference_point;
            const Eigen::Vector3d moved =
                again.epochs[k].reference_point.position_m - point.position_m;
            EXPECT_LT(moved.cwiseQuotient(point.position_covariance_m2.diagonal().cwiseSqrt())
                          .cwiseAbs()
                          .maxCoeff(),
                      0.02)
                << k;
        }
        EXPECT_NEAR(again.time_offset_s.value, whole.time_offset_s.value,
                    0.02 * whole.time_offset_s.sigma + 1e-12);
    }
}

TEST(InertialSolvedBefore, OfOtherPositionsIsRefused) {
    const InertialRunSpec spec = lake(ImuClass::mems, 31);
    const InertialRun run = simulate_inertial(spec);
    const InertialSolution whole = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    const std::vector<PositionFix> fewer(run.fixes.begin(), run.fixes.end() - 20);
    EXPECT_THROW(solved_about(whole, run, fewer, setup_of(spec)), Failure);
}

/// A position that states 1 km says nothing: the same as to leave it out.
void leave_out(std::vector<PositionFix>& fixes, double from_s, double to_s) {
    for (PositionFix& fix : fixes)
        if (fix.time_s > from_s - 1e-6 && fix.time_s < to_s + 1e-6)
            fix.covariance_m2 = 1e6 * Eigen::Matrix3d::Identity();
}

// A displacement of all later positions moves nothing; what they say of velocity and attitude
// counts: more than nothing, and less than where they are known to be displaced by nothing.
TEST(InertialLeftOut, LaterPositionsMayBeDisplaced) {
    for (const double late_s : {0.0, 0.03}) {
        InertialRunSpec spec = lake(ImuClass::mems, 33);
        spec.time_offset_s = late_s;
        InertialRun run = simulate_inertial(spec);
        InertialSetup setup = setup_of(spec);
        setup.antenna_sigma_m = 0.0;
        const InertialSolution whole = smooth_inertial(run.samples, run.fixes, setup);
        const double begin_s = whole.epochs[first_out].time_s;
        const double end_s = whole.epochs[last_out].time_s;
        const auto found = whole.displacement_by_imu(first_out, last_out);
        const Eigen::Vector3d sigma = found.covariance_m2.diagonal().cwiseSqrt();

        std::vector<PositionFix> fixes = run.fixes;
        leave_out(fixes, begin_s, end_s);
        const auto sigma_of = [&] {
            const PointDisplacement moved =
                solved_about(whole, run, fixes, setup)
                    .displacement(first_out, last_out, CraftPoint::antenna);
            return Eigen::Vector3d(moved.covariance_m2.diagonal().cwiseSqrt());
        };
        const Eigen::Vector3d with_later = sigma_of();
        leave_out(fixes, begin_s, 1e9);
        const Eigen::Vector3d without_later = sigma_of();
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GT(sigma(axis), 1.01 * with_later(axis)) << axis;
            EXPECT_LT(sigma(axis), 0.99 * without_later(axis)) << axis;
        }
        std::printf("3 s by the IMU, sd: %.1f mm; positions after it known: %.1f, left out: %.1f\n",
                    1e3 * sigma.x(), 1e3 * with_later.x(), 1e3 * without_later.x());

        for (PositionFix& fix : run.fixes)
            if (fix.time_s > end_s + 1e-6) fix.enu_m += Eigen::Vector3d(0.1, -0.05, 0.1);
        const auto displaced =
            smooth_inertial(run.samples, run.fixes, setup).displacement_by_imu(first_out, last_out);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(displaced.enu_m(axis), found.enu_m(axis), 0.25 * sigma(axis)) << axis;
    }
}

// A drift of the positions in the span is one of theirs alone; 6 runs, 5 spans of 3 s each.
TEST(InertialLeftOut, ErrsAsStatedAndShowsADrift) {
    double squares = 0.0, count = 0.0;
    for (std::uint64_t seed = 70; seed < 76; ++seed) {
        InertialRunSpec spec = lake(ImuClass::mems, seed);
        InertialRun run = simulate_inertial(spec);
        const InertialSolution whole = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        const std::size_t first = test::first_truth(run, whole);
        for (std::size_t s = 60; s + 30 < whole.epochs.size() && s < 400; s += 70) {
            const auto found = whole.displacement_by_imu(s, s + 30);
            const Eigen::Vector2d error = (found.enu_m - (run.truth[first + s + 30].antenna_m -
                                                          run.truth[first + s].antenna_m))
                                              .head<2>();
            squares += error.dot(found.covariance_m2.topLeftCorner<2, 2>().inverse() * error);
            count += 2.0;
        }
        if (seed != 70) continue;
        for (std::size_t k = 200; k < run.fixes.size(); ++k)
            run.fixes[k].enu_m.x() += 0.02 * std::min(30.0, static_cast<double>(k - 200));
        const InertialSolution drifted = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        const double from_s = run.fixes[200].time_s;
        const auto at = drifted.enclosing(from_s, from_s + 3.0);
        ASSERT_TRUE(at);
        const auto found = drifted.displacement_by_imu(at->first, at->second);
        const double shown_m =
            run.fixes[230].enu_m.x() - run.fixes[200].enu_m.x() - found.enu_m.x();
        EXPECT_GT(shown_m, 0.3);
        EXPECT_GT(shown_m, 5.0 * std::sqrt(found.covariance_m2(0, 0)));
        std::printf("a drift of 0.6 m in 3 s: positions and IMU differ by %.3f m, sd %.3f m\n",
                    shown_m, std::sqrt(found.covariance_m2(0, 0)));
    }
    EXPECT_GT(squares / count, 0.6);
    EXPECT_LT(squares / count, 1.5);
    std::printf("left out: mean square of normalised errors %.2f of %.0f\n", squares / count,
                count);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
