#include <gtest/gtest.h>

#include "late_speeds.h"
#include "stages/screen/velocity_check.h"

// Recorded velocities that are not of the moments of their positions, or not of these positions.

namespace runcert::RUNCERT_FILE {
namespace {

using late_speeds::always;
using late_speeds::Board;

struct Recorded {
    Board board = {.longer_s = 3.0, .sails_s = 3600.0};
    std::function<double(double)> delay_s = always(0.0);
    std::function<double(double)> factor = always(1.0);
    bool course = true;
    double duration_s = 1800.0;

    std::vector<ScreenedEpoch> rows() const {
        constexpr double noise_m = 0.02, noise_m_s = 0.05;
        RandomGenerator random(11);
        std::vector<ScreenedEpoch> rows;
        for (int k = 0; 0.5 * k < duration_s; ++k) {
            const double time_s = 0.5 * k;
            const Board::Motion here = board.at(time_s), then = board.at(time_s - delay_s(time_s));
            ScreenedEpoch& row = rows.emplace_back();
            row.epoch = k + 1;
            row.time.nanoseconds = 500'000'000LL * k;
            row.east_m = here.east_m + noise_m * random.normal();
            row.north_m = here.north_m + noise_m * random.normal();
            row.sigma_east_m = row.sigma_north_m = noise_m;
            const double speed = factor(time_s) * then.speed_m_s + noise_m_s * random.normal();
            const double heading = then.course_deg * std::numbers::pi / 180.0;
            if (this->course) {
                row.recorded_velocity_east_m_s = speed * std::sin(heading);
                row.recorded_velocity_north_m_s = speed * std::cos(heading);
            } else {
                row.recorded_speed_m_s = std::max(0.0, speed);
            }
            row.usable = true;
            row.arc = 1;
        }
        return rows;
    }
    /// Where the board changes its motion at once, neighbours are half way.
    Motion motion() const {
        Motion motion;
        for (int k = 0; 0.5 * k < duration_s; ++k) {
            const auto velocity = [&](double time_s) -> Eigen::Vector2d {
                const Board::Motion at = board.at(time_s);
                const double heading = at.course_deg * std::numbers::pi / 180.0;
                return {at.speed_m_s * std::sin(heading), at.speed_m_s * std::cos(heading)};
            };
            const Eigen::Vector2d before = velocity(0.5 * k - 0.25),
                                  after = velocity(0.5 * k + 0.25);
            EpochMotion& one = motion.emplace_back().emplace();
            one.velocity = 0.5 * (before + after);
            one.acceleration = (after - before) / 0.5;
            one.velocity_covariance = 1e-4 * Eigen::Matrix2d::Identity();
            one.acceleration_covariance = 1e-2 * Eigen::Matrix2d::Identity();
        }
        return motion;
    }
};

struct Checked {
    std::vector<ScreenedEpoch> rows;
    VelocityFindings found;
    std::ptrdiff_t marked() const {
        return std::ranges::count(rows, Reason::velocity, &ScreenedEpoch::reason);
    }
};

Checked checked(const Recorded& recorded, double share_max = 0.05) {
    Checked result{.rows = recorded.rows(), .found = {}};
    result.found =
        check_velocities(result.rows, recorded.motion(),
                         {.share_max = share_max, .nominal_interval_s = 0.5, .test_size = 1e-9});
    return result;
}

TEST(VelocityDelays, LateVelocitiesMarkNothingAndAreNoWitness) {
    for (const bool course : {true, false})
        for (const double delay_s : {5.0, 43.0, -20.0}) {
            SCOPED_TRACE(delay_s);
            const Checked late = checked({.delay_s = always(delay_s), .course = course});
            const VelocityComparison& comparison = *late.found.comparison;
            EXPECT_TRUE(comparison.unfit);
            EXPECT_GT(comparison.contradicted_share, 0.9);
            ASSERT_EQ(comparison.delays.size(), 1U);
            EXPECT_NEAR(comparison.delays[0].delay_s, delay_s, 0.51);
            EXPECT_TRUE(comparison.delays[0].beyond);
            EXPECT_TRUE(late.found.errors.empty());
            EXPECT_EQ(late.marked(), 0);
        }
}

/// Which of the two is wrong is not known: what they contradict stays left out.
TEST(VelocityDelays, OtherSpeedsStillMark) {
    const Checked other =
        checked({.factor = [](double t) { return t > 1000.0 && t < 1300.0 ? 1.4 : 1.0; }});
    EXPECT_TRUE(other.found.comparison->unfit);
    EXPECT_GT(other.marked(), 300);
    EXPECT_FALSE(other.found.errors.empty());
    const Checked none = checked({});
    EXPECT_FALSE(none.found.comparison->unfit);
    EXPECT_LT(none.found.comparison->contradicted_share, 0.02);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
