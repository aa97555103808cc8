#include "stages/window/window_courses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/course_angle.h"

// The course of windows and of the run, by its definitions.
namespace runcert::RUNCERT_FILE {
namespace {

const Geodetic origin{Angle::from_degrees(-31.0), Angle::from_degrees(136.0), 100.0};

/// Epochs 1 s apart on a straight line in the plane, 10 km east and 5 km south of the origin. The
/// first and the last have no position.
TrajectoryTable straight_line() {
    TrajectoryTable table{
        .header = {}, .facts = {}, .origin = FrameOrigin{origin, "attempt"}, .rows = {}};
    for (int i = 0; i < 9; ++i) {
        TrajectoryEpoch row;
        row.epoch = i + 1;
        row.time = {i * 1'000'000'000LL};
        if (i > 0 && i < 8) {
            row.east_m = 10'000.0 + 60.0 * i;
            row.north_m = -5'000.0 + 80.0 * i;
        }
        table.rows.push_back(row);
    }
    return table;
}

Windows with_window(std::int64_t first, std::int64_t last) {
    Windows windows;
    ProfileWindows& rule = windows.profiles.emplace_back();
    rule.best.emplace();
    rule.further.emplace_back();
    rule.best->span.first_epoch = rule.further[0].span.first_epoch = first;
    rule.best->span.last_epoch = last;
    rule.further[0].span.last_epoch = first;
    return windows;
}

TEST(WindowCourses, PartFromThePlaneByTheConvergence) {
    Windows windows = with_window(3, 6);
    set_courses(straight_line(), windows);
    ASSERT_TRUE(windows.course && windows.profiles[0].best->course);
    // The meridian of a place 10 km east of the origin leans against that of the origin by the
    // difference of longitudes times the sine of the latitude: 0.054 degrees.
    const LocalFrame frame(origin);
    for (const auto& [course, first, last] :
         {std::tuple(*windows.course, 1, 7), std::tuple(*windows.profiles[0].best->course, 2, 5)}) {
        const auto place = [&](int i) {
            return frame.geodetic_from_enu({{10'000.0 + 60.0 * i, -5'000.0 + 80.0 * i, 0.0}});
        };
        EXPECT_NEAR(course.plane_deg, std::atan2(60.0, 80.0) * degrees_per_radian, 1e-9);
        const double convergence_deg =
            (place(first).longitude.degrees() - origin.longitude.degrees()) *
            std::sin(place(first).latitude.radians());
        EXPECT_NEAR(course.geodesic_deg - course.plane_deg, convergence_deg, 2e-4);
        const double turn_deg =
            (place(last).longitude.degrees() - place(first).longitude.degrees()) *
            std::sin(place(first).latitude.radians());
        EXPECT_NEAR(course.geodesic_end_deg - course.geodesic_deg, turn_deg, 1e-6);
        EXPECT_NEAR(course.loxodrome_deg - course.geodesic_deg, 0.5 * turn_deg, 1e-6);
        EXPECT_LT(turn_deg, -3e-4);
        EXPECT_FALSE(course.heading_deg);
    }
    // One place has no course.
    EXPECT_FALSE(windows.profiles[0].further[0].course);
}

TEST(WindowCourses, OfALateSessionAreKnownToo) {
    // The second half was recorded first: its numbers are lower, and its rows stand behind.
    TrajectoryTable trajectory = straight_line();
    for (TrajectoryEpoch& row : trajectory.rows)
        row.epoch = row.epoch < 5 ? row.epoch + 100 : row.epoch;
    Windows windows = with_window(102, 7);
    set_courses(trajectory, windows);
    ASSERT_TRUE(windows.profiles[0].best->course);
    Windows in_order = with_window(2, 7);
    set_courses(straight_line(), in_order);
    EXPECT_EQ(windows.profiles[0].best->course->geodesic_deg,
              in_order.profiles[0].best->course->geodesic_deg);
}

TEST(WindowCourses, InAPlaneWithoutAPlaceThereIsNone) {
    Windows windows = with_window(3, 6);
    TrajectoryTable trajectory = straight_line();
    trajectory.origin.reset();
    set_courses(trajectory, windows);
    EXPECT_FALSE(windows.course);
    EXPECT_FALSE(windows.profiles[0].best->course);
}

TEST(WindowCourses, OfEpochsWithoutAPositionThereIsNone) {
    Windows windows = with_window(1, 6);
    set_courses(straight_line(), windows);
    EXPECT_TRUE(windows.course);
    EXPECT_FALSE(windows.profiles[0].best->course);
}

// Headings about north have their mean about north.
TEST(WindowCourses, TheHeadingIsTheMeanOverTheWindow) {
    Windows windows = with_window(3, 6);
    windows.profiles[0].best->span.start = {2'000'000'000};
    windows.profiles[0].best->span.duration = {3'000'000'000};
    set_courses(straight_line(), windows);
    InertialSolution solution;
    for (int i = 0; i < 9; ++i) {
        InertialEpoch& epoch = solution.epochs.emplace_back();
        epoch.time_s = i;
        epoch.attitude.heading = (i % 2 == 0 ? 358.0 : 4.0) * radians_per_degree;
    }
    add_headings(solution, windows);
    ASSERT_TRUE(windows.profiles[0].best->course->heading_deg);
    EXPECT_NEAR(*windows.profiles[0].best->course->heading_deg, 1.0, 1e-9);
    solution.consistency.doubts.push_back({});
    Windows doubted = with_window(3, 6);
    doubted.profiles[0].best->span = windows.profiles[0].best->span;
    set_courses(straight_line(), doubted);
    add_headings(solution, doubted);
    EXPECT_FALSE(doubted.profiles[0].best->course->heading_deg);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
