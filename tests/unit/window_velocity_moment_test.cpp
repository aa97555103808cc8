#include <gtest/gtest.h>

#include <cmath>

#include "stages/window/velocity_moment.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double speed_m_s = 10.0;
constexpr double sigma_m = 0.2, sigma_m_s = 0.1;

/// A circle at constant speed, once a second.
struct Circle {
    double radius_m = 10.0;
    TrajectoryTable trajectory;
    ScreenedTable screened;
    ArcRows arc;
    Profile profile;
    FoundWindow window;

    explicit Circle(double radius = 10.0, double delay_s = 0.0) : radius_m(radius) {
        for (int k = 0; k <= 60; ++k) {
            const double angle = speed_m_s * k / radius_m;
            TrajectoryEpoch& row = trajectory.rows.emplace_back();
            row.epoch = k + 1;
            row.time.nanoseconds = 1'000'000'000LL * k;
            row.arc = 1;
            row.usable = true;
            row.east_m = radius_m * std::cos(angle);
            row.north_m = radius_m * std::sin(angle);
            row.velocity_east_m_s = -speed_m_s * std::sin(angle);
            row.velocity_north_m_s = speed_m_s * std::cos(angle);
            row.sigma_east_m = row.sigma_north_m = sigma_m;
            row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = sigma_m_s;
            ScreenedEpoch& epoch = screened.rows.emplace_back();
            epoch.fix = FixType::fixed;
            epoch.usable = true;
            epoch.time = row.time;
            epoch.recorded_speed_m_s = speed_m_s;
            arc.rows.push_back(static_cast<std::size_t>(k));
        }
        screened.basis.velocity = VelocityComparison{.delay_s = delay_s, .sigma_delay_s = 0.0};
        profile.definition = SpeedDefinition::path_length;
        window.first = 10;
        window.last = 40;
        window.start.nanoseconds = 10'000'000'000;
        window.end.nanoseconds = 40'000'000'000;
    }
    SpeedEstimate speed() const {
        const auto compared = compared_speeds(screened, trajectory, {arc}, profile.dimension);
        const auto first =
            std::ranges::find(compared, window.start.seconds(), &ComparedSpeed::time_s);
        return track_speed(
            screened, trajectory, arc, profile, window,
            {first, first + static_cast<std::ptrdiff_t>(window.last - window.first + 1)});
    }
};

TEST(TrackSpeed, OfATurnIsNotCutShort) {
    const Circle circle;
    // The chords of a radian are 4 % shorter than the arc, the path of the cubics 0.1 %.
    const double chords_m_s = 2.0 * circle.radius_m * std::sin(0.5);
    EXPECT_LT(chords_m_s, 0.96 * speed_m_s);
    EXPECT_NEAR(circle.speed().speed_m_s, speed_m_s, 0.01 * speed_m_s);
    // The rest is in the uncertainty.
    EXPECT_GT(circle.speed().standard_uncertainty_m_s,
              0.9 * (circle.speed().speed_m_s - chords_m_s) / std::sqrt(3.0));
}

TEST(TrackSpeed, OfAStraightWayIsAsSureAsItsEnds) {
    Circle circle(1e6);
    circle.profile.uncertainty.error_floor_m = {{"fixed", 0.4}};
    EXPECT_NEAR(circle.speed().speed_m_s, speed_m_s, 1e-6);
    EXPECT_NEAR(circle.speed().standard_uncertainty_m_s,
                std::sqrt(2.0 * (sigma_m * sigma_m + 0.4 * 0.4)) / 30.0, 1e-6);
}

TEST(TrackSpeed, IsThatOfTheMomentsOfTheSpeeds) {
    // At rest until 20 s, then at 10 m/s: a delay of 5 s moves the window by as much.
    Circle circle(1e6, 5.0);
    for (std::size_t k = 0; k <= 20; ++k) {
        TrajectoryEpoch& row = circle.trajectory.rows[k];
        row.velocity_east_m_s = row.velocity_north_m_s = 0.0;
        row.east_m = circle.trajectory.rows[20].east_m;
        row.north_m = circle.trajectory.rows[20].north_m;
    }
    EXPECT_NEAR(circle.speed().speed_m_s, speed_m_s * 15.0 / 30.0, 0.1);
    circle.profile.definition = SpeedDefinition::mean_n;
    EXPECT_NEAR(circle.speed().speed_m_s, speed_m_s * 15.0 / 30.0, 0.1);
    circle.screened.basis.velocity->delay_s = 0.0;
    EXPECT_NEAR(circle.speed().speed_m_s, speed_m_s * 20.0 / 30.0, 0.1);
    // Where the delay is less sure, the change of the speed is.
    const double sure = circle.speed().standard_uncertainty_m_s;
    circle.screened.basis.velocity->sigma_delay_s = 3.0;
    EXPECT_NEAR(circle.speed().standard_uncertainty_m_s, std::hypot(sure, 3.0 * speed_m_s / 30.0),
                0.01);
}

TEST(MomentsOfSpeeds, MovePositionsAlongTheTrack) {
    SampleSeries series;
    for (int k = 0; k < 40; ++k) {
        ElapsedTime time;
        time.nanoseconds = 500'000'000LL * k;
        series.times.push_back(time);
        series.positions.emplace_back(10.0 * std::cos(0.2 * k), 10.0 * std::sin(0.2 * k), 0.0);
        series.bounds.push_back(true);
    }
    SampleSeries late = series, early = series, none = series;
    move_to_moments(late, 0.75);
    move_to_moments(early, -0.75);
    move_to_moments(none, 0.0);
    for (int k = 3; k < 37; ++k) {
        const auto at = [](double steps) {
            return Eigen::Vector3d(10.0 * std::cos(0.2 * steps), 10.0 * std::sin(0.2 * steps), 0.0);
        };
        const auto i = static_cast<std::size_t>(k);
        EXPECT_NEAR((late.positions[i] - at(k - 1.5)).norm(), 0.0, 0.02);
        EXPECT_NEAR((early.positions[i] - at(k + 1.5)).norm(), 0.0, 0.02);
        EXPECT_EQ(none.positions[i], series.positions[i]);
    }
    EXPECT_FALSE(late.bounds[0] || late.bounds[1]);
    EXPECT_TRUE(late.bounds[2] && late.bounds[39]);
    EXPECT_FALSE(early.bounds[39] || early.bounds[38]);
    EXPECT_TRUE(early.bounds[0] && early.bounds[37]);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
