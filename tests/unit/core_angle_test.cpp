#include <gtest/gtest.h>

#include <numbers>
#include <type_traits>

#include "core/angle.h"

namespace runcert::RUNCERT_FILE {
namespace {

static_assert(!std::is_convertible_v<double, Angle>);
static_assert(!std::is_constructible_v<Angle, double>);
static_assert(!std::is_convertible_v<Angle, double>);

TEST(Angle, KeepsDegreesExactly) {
    for (const double degrees : {0.0, 90.0, -90.0, 35.134709483, 136.977574275, 360.0, 1e-9})
        EXPECT_EQ(Angle::from_degrees(degrees).degrees(), degrees);
}

TEST(Angle, KeepsRadiansToRounding) {
    EXPECT_EQ(Angle::from_radians(std::numbers::pi / 2).degrees(), 90.0);
    for (const double radians : {0.1, 1.0, -2.5, 3.0})
        EXPECT_DOUBLE_EQ(Angle::from_radians(radians).radians(), radians);
}

TEST(Angle, TakesTheSignOfDegreesMinutesSecondsApart) {
    EXPECT_DOUBLE_EQ(Angle::from_dms(1, 35.0, 8.0, 4.9541388).degrees(), 35.134709483);
    EXPECT_DOUBLE_EQ(Angle::from_dms(-1, 35.0, 8.0, 4.9541388).degrees(), -35.134709483);
    EXPECT_DOUBLE_EQ(Angle::from_dms(-1, 0.0, 30.0, 0.0).degrees(), -0.5);
}

TEST(Angle, Compares) {
    EXPECT_EQ(Angle::from_degrees(180.0), Angle::from_radians(std::numbers::pi));
    EXPECT_LT(Angle::from_degrees(-1.0), Angle::from_degrees(1.0));
    EXPECT_EQ(Angle(), Angle::from_degrees(0.0));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
