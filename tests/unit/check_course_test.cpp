#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "stages/check/course.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double sigma_m = 0.01, sigma_up_m = 0.02, sigma_m_s = 0.05;

struct Motion {
    double east_m = 0.0, north_m = 0.0, up_m = 0.0;
    double velocity_east_m_s = 0.0, velocity_north_m_s = 0.0, velocity_up_m_s = 0.0;
};

/// Rows at 10 Hz of one arc, the motion a function of time (s), with the sigmas above.
std::vector<TrajectoryEpoch> rows_of(double duration_s,
                                     const std::function<Motion(double)>& motion_at) {
    std::vector<TrajectoryEpoch> rows;
    for (std::int64_t k = 0; k <= std::llround(10.0 * duration_s); ++k) {
        const Motion motion = motion_at(0.1 * static_cast<double>(k));
        TrajectoryEpoch& row = rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = motion.east_m;
        row.north_m = motion.north_m;
        row.up_m = motion.up_m;
        row.velocity_east_m_s = motion.velocity_east_m_s;
        row.velocity_north_m_s = motion.velocity_north_m_s;
        row.velocity_up_m_s = motion.velocity_up_m_s;
        row.sigma_east_m = row.sigma_north_m = sigma_m;
        row.sigma_up_m = sigma_up_m;
        row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = sigma_m_s;
        row.sigma_velocity_up_m_s = sigma_m_s;
        row.arc = 1;
        row.usable = true;
    }
    return rows;
}

/// Straight along a heading from a place, at constant acceleration from a speed.
struct Straight {
    double heading_deg = 60.0;
    double speed_m_s = 20.0;
    double acceleration_m_s2 = 0.0;
    double east_m = 0.0, north_m = 0.0;
    double slope = 0.0;

    Motion operator()(double time_s) const {
        const double speed = speed_m_s + acceleration_m_s2 * time_s;
        const double path = speed_m_s * time_s + 0.5 * acceleration_m_s2 * time_s * time_s;
        const double e = std::sin(heading_deg * degree), n = std::cos(heading_deg * degree);
        return {east_m + e * path, north_m + n * path, slope * path,
                e * speed,         n * speed,          slope * speed};
    }
};

CraftRun whole(const std::vector<TrajectoryEpoch>& rows) {
    return {.first_row = 0,
            .last_row = rows.size() - 1,
            .began = RunEdge::recording,
            .ended = RunEdge::recording};
}

CourseFacts facts_of(const std::vector<TrajectoryEpoch>& rows, std::size_t first, std::size_t last,
                     const CourseErrors& errors = {}) {
    return course_facts(rows, whole(rows), first, last, errors);
}

TEST(Course, HeightDifferenceOfAHillIsFoundWithinItsUncertainty) {
    for (const double hill_m : {0.8, 1.2}) {
        RandomGenerator random(3);
        auto rows = rows_of(100.0, [&](double t) {
            Motion motion = Straight{}(t);
            const double path_m = 20.0 * t;
            // On a sphere: at the end of the 2 km it lies 0.31 m below the plane.
            motion.up_m = std::sqrt(6.371e6 * 6.371e6 - path_m * path_m) - 6.371e6 + 7.0 +
                          0.5 * hill_m * std::sin(2.0 * std::numbers::pi * t / 100.0);
            return motion;
        });
        // Smoothed heights: their errors last for some seconds.
        double error_m = 0.0;
        for (TrajectoryEpoch& row : rows) {
            error_m = 0.98 * error_m + std::sqrt(1.0 - 0.98 * 0.98) * sigma_up_m * random.normal();
            *row.up_m += error_m;
        }
        const auto height = facts_of(rows, 500, 530).height_difference_m;
        ASSERT_TRUE(height.has_value());
        EXPECT_NEAR(*height->expanded_uncertainty, 2.0 * std::sqrt(2.0) * sigma_up_m, 1e-12);
        EXPECT_NEAR(height->value, hill_m, *height->expanded_uncertainty + 2.0 * sigma_up_m);
        EXPECT_EQ(height->value > 1.0, hill_m > 1.0);
    }
}

TEST(Course, NoiseOnlyRaisesTheHeightDifference) {
    RandomGenerator random(5);
    auto rows = rows_of(100.0, Straight{});
    for (TrajectoryEpoch& row : rows)
        *row.up_m += sigma_up_m * random.normal();
    // The expected range of 1001 independent normal values is 6.48 sigma (Tippett 1925: 6.48 for
    // 1000), its standard deviation about 0.5 sigma.
    const CourseErrors plane{.tangent_plane = false};
    EXPECT_NEAR(facts_of(rows, 0, 30, plane).height_difference_m->value / sigma_up_m, 6.48, 1.5);
}

TEST(Course, SlowErrorsCountAtBothPlaces) {
    const auto rows = rows_of(20.0, Straight{.slope = 0.02});
    const CourseErrors errors{.slow_horizontal_m = 0.03, .slow_vertical_m = 0.05};
    const CourseFacts facts = facts_of(rows, 100, 130, errors);
    const double up = 2.0 * std::sqrt(2.0 * (0.02 * 0.02 + 0.05 * 0.05));
    EXPECT_NEAR(*facts.height_difference_m->expanded_uncertainty, up, 1e-12);
    const double along = 2.0 * std::sqrt(2.0 * (0.01 * 0.01 + 0.03 * 0.03));
    // 60 m between the ends.
    EXPECT_NEAR(*facts.slope->expanded_uncertainty, std::hypot(up, 0.02 * along) / 60.0, 1e-6);
    EXPECT_NEAR(*facts.heading_deg.expanded_uncertainty, along / 60.0 / degree, 1e-9);
}

TEST(Course, AFlatCourseOnTheRoundEarthIsFlat) {
    // 16 km east of the origin to 20 km, always 100 m above the ellipsoid, whose plane is 20 m to
    // 31 m above it there.
    const LocalFrame frame({Angle::from_degrees(-31.0), Angle::from_degrees(137.0), 100.0});
    const double m_per_degree = 111'320.0 * std::cos(31.0 * degree);
    auto rows = rows_of(200.0, [&](double t) {
        const Eigen::Vector3d place =
            frame
                .enu_from_geodetic(
                    {Angle::from_degrees(-31.0),
                     Angle::from_degrees(137.0 + (16'000.0 + 20.0 * t) / m_per_degree), 100.0})
                .m;
        return Motion{place.x(), place.y(), place.z(), 20.0, 0.0, 0.0};
    });
    EXPECT_GT(rows.front().up_m.value() - rows.back().up_m.value(), 10.0);
    EXPECT_LT(facts_of(rows, 100, 130).height_difference_m->value, 0.006 * 31.0);
    EXPECT_NEAR(facts_of(rows, 100, 1100).slope->value, 0.0, 2e-5);

    // In a plane of the recording's own nothing is corrected.
    const CourseErrors errors{.tangent_plane = false};
    EXPECT_NEAR(facts_of(rows, 100, 130, errors).height_difference_m->value,
                *rows.front().up_m - *rows.back().up_m, 1e-9);
}

TEST(Course, WithoutAHeightThereIsNoHeightDifference) {
    auto rows = rows_of(20.0, Straight{});
    rows[50].up_m.reset();
    const CourseFacts facts = facts_of(rows, 100, 130);
    EXPECT_FALSE(facts.height_difference_m.has_value());
    EXPECT_TRUE(facts.slope.has_value());
    rows[130].up_m.reset();
    EXPECT_FALSE(facts_of(rows, 100, 130).slope.has_value());
}

TEST(Course, SlopeAndHeadingAllRound) {
    for (const double heading_deg : {0.0, 45.0, 90.0, 180.0, 269.5, 359.9}) {
        const auto rows = rows_of(20.0, Straight{.heading_deg = heading_deg, .slope = -0.013});
        const CourseFacts facts = facts_of(rows, 20, 50, {.tangent_plane = false});
        EXPECT_NEAR(std::remainder(facts.heading_deg.value - heading_deg, 360.0), 0.0, 1e-9);
        EXPECT_GE(facts.heading_deg.value, 0.0);
        EXPECT_LT(facts.heading_deg.value, 360.0);
        EXPECT_NEAR(facts.slope->value, -0.013, 1e-12);
        EXPECT_NEAR(facts.straightness_m.value, 0.0, 1e-9);
        EXPECT_NEAR(facts.turning_deg.value, 0.0, 1e-9);
    }
}

TEST(Course, OfATurnTheChordTheArrowAndTheAngle) {
    // 20 m/s on a circle of 400 m to the right (and left): 3 s are 0.15 rad.
    for (const double side : {1.0, -1.0}) {
        const auto rows = rows_of(20.0, [side](double t) {
            const double heading = side * 0.05 * t + 350.0 * degree;
            return Motion{-side * 400.0 * std::cos(heading), side * 400.0 * std::sin(heading), 0.0,
                          20.0 * std::sin(heading),          20.0 * std::cos(heading),         0.0};
        });
        const CourseFacts facts = facts_of(rows, 50, 80);
        const double beginning_deg = 350.0 + side * 0.25 / degree;
        EXPECT_NEAR(facts.heading_deg.value,
                    std::fmod(beginning_deg + side * 0.075 / degree, 360.0), 1e-9);
        EXPECT_NEAR(facts.straightness_m.value, 400.0 * (1.0 - std::cos(0.075)), 1e-9);
        EXPECT_NEAR(facts.turning_deg.value, side * 0.15 / degree, 1e-9);
        EXPECT_NEAR(*facts.turning_deg.expanded_uncertainty,
                    2.0 * std::sqrt(2.0) * sigma_m_s / 20.0 / degree, 1e-9);
        // Halfway, the line has half the variance of an end.
        EXPECT_NEAR(*facts.straightness_m.expanded_uncertainty, 2.0 * std::sqrt(1.5) * sigma_m,
                    1e-9);
    }
}

TEST(Course, UncertaintyOfTheHeadingIsThatAcrossIt) {
    auto rows = rows_of(20.0, Straight{.heading_deg = 90.0});
    for (TrajectoryEpoch& row : rows)
        row.sigma_east_m = 5.0;
    EXPECT_NEAR(*facts_of(rows, 0, 30).heading_deg.expanded_uncertainty,
                2.0 * std::sqrt(2.0) * sigma_m / 60.0 / degree, 1e-9);
    rows[30].sigma_north_m.reset();
    EXPECT_FALSE(facts_of(rows, 0, 30).heading_deg.expanded_uncertainty.has_value());
    const auto parked = rows_of(20.0, Straight{.speed_m_s = 0.0});
    EXPECT_EQ(facts_of(parked, 0, 30).heading_deg.expanded_uncertainty, 180.0);
}

TEST(Course, RunUpFromRest) {
    const auto rows = rows_of(30.0, Straight{.speed_m_s = 0.0, .acceleration_m_s2 = 2.0});
    const CourseFacts facts = facts_of(rows, 200, 230);
    EXPECT_NEAR(facts.run_up_m, 400.0, 1e-9);
    EXPECT_NEAR(facts.run_up_s, 20.0, 1e-12);
    EXPECT_EQ(facts.speed_before_m_s.value, 0.0);
    EXPECT_NEAR(*facts.speed_before_m_s.expanded_uncertainty, 2.0 * sigma_m_s, 1e-12);
    EXPECT_TRUE(facts.standing_start);
}

TEST(Course, StandingStartAroundItsLimits) {
    struct Case {
        double speed_m_s, sigma_m_s;
        bool standing;
    };
    // sqrt(5.9915) = 2.4477 standard uncertainties: tables of chi-squared, 95 %, 2 degrees.
    for (const Case& one : {Case{0.5, 0.5 / 2.44, true},
                            {0.5, 0.5 / 2.46, false},
                            {0.19, 0.001, true},
                            {0.21, 0.001, false},
                            {0.99, 10.0, true},
                            {1.01, 10.0, false}}) {
        auto rows = rows_of(30.0, Straight{.speed_m_s = one.speed_m_s, .acceleration_m_s2 = 2.0});
        for (TrajectoryEpoch& row : rows)
            row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = one.sigma_m_s;
        EXPECT_EQ(facts_of(rows, 200, 230).standing_start, one.standing) << one.speed_m_s;
    }
}

TEST(Course, StandingBeforeTheRunsFirstRowIsAStandingStart) {
    // A precise recording of a start from rest: the run's first row is at 0.99 m/s, and not at
    // rest.
    const auto rows = rows_of(60.0, [](double t) {
        const Straight start{.speed_m_s = 0.0, .acceleration_m_s2 = 0.33};
        return start(std::max(0.0, t - 20.0));
    });
    const auto runs = runs_in(rows);
    ASSERT_EQ(runs.size(), 1u);
    EXPECT_EQ(runs[0].first_row, 230u);
    EXPECT_EQ(runs[0].stood_from_row, 0u);
    CourseFacts facts = course_facts(rows, runs[0], 500, 530, {});
    EXPECT_EQ(facts.speed_before_m_s.value, 0.0);
    EXPECT_TRUE(facts.standing_start);
    EXPECT_NEAR(facts.run_up_s, 27.0, 1e-9);

    CraftRun moving = runs[0];
    moving.stood_from_row.reset();
    facts = course_facts(rows, moving, 500, 530, {});
    EXPECT_NEAR(facts.speed_before_m_s.value, 0.99, 1e-9);
    EXPECT_FALSE(facts.standing_start);
    moving.stood_from_row = 231;
    EXPECT_THROW(course_facts(rows, moving, 500, 530, {}), Failure);
}

TEST(Course, OnlyRowsBeforeTheWindowAreOfTheStart) {
    const auto rows = rows_of(20.0, Straight{.speed_m_s = 20.0, .acceleration_m_s2 = -1.0});
    const CourseFacts facts = facts_of(rows, 50, 80);
    EXPECT_NEAR(facts.speed_before_m_s.value, 15.0, 1e-9);
    EXPECT_FALSE(facts.standing_start);
    const CourseFacts at_once = facts_of(rows, 0, 30);
    EXPECT_EQ(at_once.run_up_m, 0.0);
    EXPECT_NEAR(at_once.speed_before_m_s.value, 20.0, 1e-9);
}

TEST(Course, RowsWithoutAnEstimateArePassedOver) {
    auto rows = rows_of(20.0, Straight{});
    for (std::size_t i = 40; i < 45; ++i) {
        TrajectoryEpoch row;
        row.epoch = rows[i].epoch;
        row.time = rows[i].time;
        rows[i] = row;
    }
    EXPECT_NEAR(facts_of(rows, 100, 130).run_up_m, 200.0, 1e-9);
    EXPECT_THROW(facts_of(rows, 42, 130), Failure);
    EXPECT_THROW(facts_of(rows, 100, 100), Failure);
    const auto of_run = [&](std::size_t first, std::size_t last) {
        return course_facts(rows, {first, last, RunEdge::turn, RunEdge::turn, {}}, 100, 130, {});
    };
    EXPECT_NO_THROW(of_run(100, 130));
    EXPECT_THROW(of_run(101, 150), Failure);
    EXPECT_THROW(of_run(50, 129), Failure);
    EXPECT_THROW(of_run(42, 150), Failure);
    EXPECT_THROW(of_run(50, 201), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
