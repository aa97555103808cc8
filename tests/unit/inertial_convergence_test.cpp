#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "draws.h"
#include "inertial_test_support.h"

// How soon the filter's attitude is right, by the start it is given: [FHB03] table 3. A converged
// covariance is not convergence, so the time counts from which the true error stays below 1 degree.
namespace runcert::RUNCERT_FILE {
namespace {

constexpr double rad = radians_per_degree;
constexpr double duration_s = 100.0;

struct Converged {
    std::vector<double> seconds;  ///< of those that converged
    int failed = 0;
    int failed_unseen = 0;  ///< whose NIS/3 is 2 or less

    double mean_s() const { return seconds.empty() ? duration_s : mean(seconds); }
};

StartAttitude start_with(const Eigen::Matrix3d& c, double pitch_deg, double roll_deg,
                         double heading_deg) {
    const Eigen::Matrix3d axes = euler_jacobian(c).inverse();
    const Eigen::Vector3d sigma = rad * Eigen::Vector3d(roll_deg, pitch_deg, heading_deg);
    return {.enu_from_body = c,
            .covariance_rad2 = axes * sigma.cwiseAbs2().asDiagonal() * axes.transpose()};
}

enum class Method { track, course, blind };

StartAttitude start_of(Method method, const InertialTruth& truth, RandomGenerator& random) {
    const EulerAngles angles = euler_angles(truth.imu.enu_from_body);
    const Eigen::Vector3d& v = truth.imu.velocity_m_s;
    switch (method) {
        case Method::track:
            return start_with(
                rotation_of({.roll = angles.roll + rad * random.normal(),
                             .pitch = angles.pitch + rad * random.normal(),
                             .heading = angles.heading + 1.5 * rad * random.normal()}),
                1.0, 1.0, 1.5);
        case Method::course:
            return start_with(rotation_of({.heading = std::atan2(v.x(), v.y())}), 4.0, 9.0, 3.0);
        case Method::blind:
            break;
    }
    return start_with(rotation_of({.heading = 2.0 * std::numbers::pi * random.uniform()}), 8.0,
                      10.0, 100.0);
}

void add_run(Method method, std::uint64_t seed, Converged& result) {
    InertialRunSpec spec = test::oval(ImuClass::tactical, seed);
    spec.duration_s = duration_s;
    const InertialRun run = simulate_inertial(spec);
    InertialSetup setup = setup_of(spec);
    RandomGenerator random(seed);
    constexpr std::size_t first = 5;  // the samples must reach half a second before it
    setup.start = start_of(method, run.truth[first], random);
    const auto attitudes = filter_attitude(run.samples, run.fixes, setup);
    ASSERT_EQ(attitudes[0].time_s, run.truth[first].time_s);
    double since_s = 0.0, nis = 0.0;
    for (std::size_t k = 0; k < attitudes.size(); ++k) {
        nis += attitudes[k].nis / 3.0 / static_cast<double>(attitudes.size());
        if (test::attitude_error_deg(attitudes[k].enu_from_body,
                                     run.truth[first + k].imu.enu_from_body) >= 1.0)
            since_s = attitudes[k].time_s - attitudes[0].time_s + 0.1;
    }
    if (since_s < 0.9 * duration_s) {
        result.seconds.push_back(since_s);
        return;
    }
    ++result.failed;
    if (nis <= 2.0) ++result.failed_unseen;
}

TEST(InertialConvergence, TrackBeforeCourseBeforeBlind) {
    Converged found[3];
    for (int method = 0; method < 3; ++method)
        for (std::uint64_t seed = 1; seed <= 20; ++seed)
            add_run(static_cast<Method>(method), seed, found[method]);
    const auto& [track, course, blind] = found;
    for (const Converged& each : found)
        std::printf("converged after %.2f s on average, %d of 20 not at all, unseen %d\n",
                    each.mean_s(), each.failed, each.failed_unseen);
    EXPECT_EQ(track.failed, 0);
    EXPECT_EQ(course.failed, 0);
    EXPECT_LE(track.mean_s(), 2.0);
    EXPECT_LE(course.mean_s(), 4.0);
    EXPECT_LT(track.mean_s(), course.mean_s());
    EXPECT_LT(course.mean_s(), blind.mean_s());
    EXPECT_EQ(blind.failed_unseen, 0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
