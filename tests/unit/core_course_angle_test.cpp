#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/course_angle.h"
#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"

// Angles of loxodrome and geodesic against closed forms, and against the examples of the manuals of
// RhumbSolve and GeodSolve.
namespace runcert::RUNCERT_FILE {
namespace {

constexpr double a_m = 6378137.0, f = 1.0 / 298.257223563;

Geodetic at(double latitude_deg, double longitude_deg) {
    return {Angle::from_degrees(latitude_deg), Angle::from_degrees(longitude_deg), 0.0};
}

double dms(double degrees, double minutes, double seconds) {
    return degrees + minutes / 60.0 + seconds / 3600.0;
}

double apart_deg(Angle one, double degrees) {
    return std::abs(std::remainder(one.degrees() - degrees, 360.0));
}

/// The isometric latitude of the ellipsoid: a loxodrome is a straight line of it over longitude.
double isometric(double latitude_rad) {
    const double e = std::sqrt(f * (2.0 - f)), sine = std::sin(latitude_rad);
    return std::atanh(sine) - e * std::atanh(e * sine);
}

// From the airports of New York to Singapore.
TEST(CourseAngle, AsTheManualsPrintThem) {
    const auto found =
        course_angles(at(dms(40, 38, 23), -dms(73, 46, 44)), at(dms(1, 21, 33), dms(103, 59, 22)));
    ASSERT_TRUE(found);
    constexpr double tenth = 0.05 / 3600.0;  // a second is printed to a tenth
    EXPECT_NEAR(found->loxodrome.degrees(), dms(103, 34, 58.2), tenth);
    EXPECT_NEAR(found->loxodrome_m, 18523563.0, 0.5);
    EXPECT_NEAR(found->geodesic.degrees(), dms(3, 18, 29.9), tenth);
    EXPECT_NEAR(found->geodesic_end.degrees(), dms(177, 29, 9.2), tenth);
    EXPECT_NEAR(found->geodesic_m, 15347628.0, 0.5);
}

TEST(CourseAngle, OnMeridianAndEquatorAllAreTheSame) {
    for (const double longitude : {0.0, 136.5, -179.9}) {
        const auto north = course_angles(at(-31.0, longitude), at(-30.9, longitude));
        const auto south = course_angles(at(-30.9, longitude), at(-31.0, longitude));
        for (const Angle angle : {north->loxodrome, north->geodesic, north->geodesic_end})
            EXPECT_LT(apart_deg(angle, 0.0), 1e-9);
        for (const Angle angle : {south->loxodrome, south->geodesic, south->geodesic_end})
            EXPECT_LT(apart_deg(angle, 180.0), 1e-9);
        EXPECT_NEAR(north->loxodrome_m, north->geodesic_m, 1e-6);
    }
    const auto east = course_angles(at(0.0, 10.0), at(0.0, 10.1));
    const auto west = course_angles(at(0.0, 10.1), at(0.0, 10.0));
    for (const Angle angle : {east->loxodrome, east->geodesic, east->geodesic_end})
        EXPECT_NEAR(angle.degrees(), 90.0, 1e-9);
    for (const Angle angle : {west->loxodrome, west->geodesic, west->geodesic_end})
        EXPECT_NEAR(angle.degrees(), 270.0, 1e-9);
    EXPECT_NEAR(east->loxodrome_m, a_m * 0.1 * std::numbers::pi / 180.0, 1e-6);
}

TEST(CourseAngle, LoxodromeIsAStraightLineOfIsometricLatitude) {
    RandomGenerator random(1);
    for (int i = 0; i < 2'000; ++i) {
        const Geodetic from = at(150.0 * random.uniform() - 75.0, 360.0 * random.uniform() - 180.0);
        const double size_deg = std::pow(10.0, -3.0 + 4.0 * random.uniform());
        const Geodetic to = at(from.latitude.degrees() + size_deg * (random.uniform() - 0.5),
                               from.longitude.degrees() + size_deg * (random.uniform() - 0.5));
        const auto found = course_angles(from, to);
        ASSERT_TRUE(found);
        const double east = to.longitude.radians() - from.longitude.radians();
        const double north = isometric(to.latitude.radians()) - isometric(from.latitude.radians());
        // The difference of two isometric latitudes has an error of 1e-15 or so.
        const double tolerance_deg =
            1e-9 + 2e-15 / std::hypot(east, north) * 180.0 / std::numbers::pi;
        EXPECT_LT(apart_deg(found->loxodrome, std::atan2(east, north) * degrees_per_radian),
                  tolerance_deg)
            << i;
    }
}

// A short geodesic begins along the plane of its beginning, and turns by the convergence of the
// meridians, half of which parts it from the loxodrome.
TEST(CourseAngle, ShortWaysDifferByHalfTheConvergence) {
    RandomGenerator random(2);
    for (int i = 0; i < 500; ++i) {
        const Geodetic from = at(120.0 * random.uniform() - 60.0, 136.0);
        const double bearing = 2.0 * std::numbers::pi * random.uniform();
        const LocalFrame frame(from);
        for (const double length_m : {200.0, 2000.0}) {
            const Geodetic to = frame.geodetic_from_enu(
                {{length_m * std::sin(bearing), length_m * std::cos(bearing), 0.0}});
            const auto found = course_angles(from, to);
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->geodesic_m, length_m, 1e-3);
            EXPECT_LT(apart_deg(found->geodesic, bearing * degrees_per_radian), 1e-6);
            const double convergence_deg =
                (to.longitude.degrees() - from.longitude.degrees()) *
                std::sin(0.5 * (from.latitude.radians() + to.latitude.radians()));
            EXPECT_LT(apart_deg(found->geodesic_end, found->geodesic.degrees() + convergence_deg),
                      2e-6);
            EXPECT_LT(
                apart_deg(found->loxodrome, found->geodesic.degrees() + 0.5 * convergence_deg),
                2e-6);
        }
    }
}

TEST(CourseAngle, OfOnePlaceThereIsNone) {
    EXPECT_FALSE(course_angles(at(-31.0, 136.0), at(-31.0, 136.0)));
    EXPECT_FALSE(course_angles(at(-31.0, 136.0), at(-31.0, 136.0 + 1e-9)));
    EXPECT_TRUE(course_angles(at(-31.0, 136.0), at(-31.0, 136.0 + 1e-7)));
    EXPECT_THROW(course_angles(at(-91.0, 136.0), at(-31.0, 136.0)), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
