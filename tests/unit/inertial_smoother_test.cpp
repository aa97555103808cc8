#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "inertial_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::attitude_error_deg;
using test::lake;
using test::oval;

constexpr double rad = radians_per_degree;

/// The attitude's smoothed error a second after the start.
double error_after_a_second_deg(const InertialRunSpec& spec, int* passes = nullptr) {
    const InertialRun run = simulate_inertial(spec);
    const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
    if (passes) *passes = solution.passes;
    EXPECT_EQ(solution.start, InertialStart::course);
    EXPECT_TRUE(solution.consistency.consistent()) << solution.consistency.nis;
    const std::size_t first = test::first_truth(run, solution);
    return attitude_error_deg(solution.epochs[10].enu_from_body,
                              run.truth[first + 10].imu.enu_from_body);
}

TEST(InertialSmoother, FindsTheAttitudeAtTheStartFromTheCourse) {
    std::vector<double> tactical, mems;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        tactical.push_back(error_after_a_second_deg(oval(ImuGrade::tactical, seed)));
        mems.push_back(error_after_a_second_deg(lake(ImuGrade::mems, seed)));
    }
    EXPECT_LT(median(tactical), 0.05);
    EXPECT_LT(median(mems), 0.1);
    std::printf("attitude error at 1 s, deg: tactical %.4f, MEMS %.4f\n", median(tactical),
                median(mems));
}

TEST(InertialSmoother, CorrectsTheSpeedUnderAMast) {
    double squares = 0.0, inside = 0.0, best = 0.0, count = 0.0, nis = 0.0;
    constexpr int runs = 8;
    for (int i = 0; i < runs; ++i) {
        const InertialRunSpec spec = lake(ImuGrade::mems, static_cast<std::uint64_t>(100 + i));
        const InertialRun run = simulate_inertial(spec);
        const InertialSolution solution = smooth_inertial(run.samples, run.fixes, setup_of(spec));
        const test::SpeedErrors errors = test::speed_errors(run, solution);
        for (const double error : errors.errors_m_s)
            squares += error * error;
        count += static_cast<double>(errors.errors_m_s.size());
        inside += errors.inside() / runs;
        best += errors.best_error_m_s / runs;
        nis += solution.consistency.nis / runs;
    }
    const double rms = std::sqrt(squares / count);
    EXPECT_LE(rms, 0.0025);
    EXPECT_LE(std::abs(best), 0.0012);
    EXPECT_GE(inside, 0.92);
    EXPECT_LE(inside, 0.99);
    EXPECT_NEAR(nis, 1.0, 0.1);
    std::printf("lake, MEMS: RMS %.2f mm/s, best %.2f mm/s, inside %.3f, NIS/3 %.3f\n", 1e3 * rms,
                1e3 * best, inside, nis);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
