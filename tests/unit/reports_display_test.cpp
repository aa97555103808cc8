#include <gtest/gtest.h>

#include "core/failure.h"
#include "reports/certificate/display.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(Display, AnUncertaintyHasTwoSignificantDigits) {
    EXPECT_EQ(uncertainty_text(0.018365), "0.018");
    EXPECT_EQ(uncertainty_text(0.0996), "0.10");
    EXPECT_EQ(uncertainty_text(0.09949), "0.099");
    EXPECT_EQ(uncertainty_text(0.31), "0.31");
    EXPECT_EQ(uncertainty_text(1.24), "1.2");
    EXPECT_EQ(uncertainty_text(9.96), "10");
    EXPECT_EQ(uncertainty_text(23.4), "23");
    EXPECT_EQ(uncertainty_text(0.000012), "0.000012");
}

TEST(Display, FiguresHaveTheirSignificantDigits) {
    EXPECT_EQ(significant_text(0.0, 3), "0");
    EXPECT_EQ(significant_text(0.00057735, 2), "0.00058");
    EXPECT_EQ(significant_text(-72.0018, 3), "-72.0");
    EXPECT_EQ(significant_text(9.96, 2), "10");
    EXPECT_EQ(significant_text(0.0996, 2), "0.10");
    EXPECT_EQ(significant_text(4123.4, 3), "4123");
    EXPECT_EQ(significant_text(3.1e-9, 2), "3.1e-09");
    EXPECT_EQ(coverage_text(2.000001), "2");
    EXPECT_EQ(coverage_text(2.0689), "2.07");
}

TEST(Display, ASpeedHasAtLeastTheDecimalsOfItsUnitAndThoseOfItsUncertainty) {
    const SpeedUnit& km_h = speed_unit("km/h");
    EXPECT_EQ(speed_text(60.002417, std::nullopt, km_h), "216.01");
    EXPECT_EQ(speed_text(60.002417, 0.005102, km_h), "216.009");
    EXPECT_EQ(speed_text(60.002417, 1.0, km_h), "216.01");
}

// Standing figures: Greenbird 202.9 km/h is 126.1 mph.
TEST(Display, UnitsConvertExactly) {
    EXPECT_EQ(speed_text(202.9 / 3.6, std::nullopt, speed_unit("mph")), "126.08");
    EXPECT_EQ(speed_text(1852.0 / 3600.0, std::nullopt, speed_unit("kn")), "1.00");
    EXPECT_EQ(&speed_unit(""), &speed_unit("km/h"));
    EXPECT_THROW(speed_unit("furlongs"), Failure);
}

TEST(Display, TimesAreGivenInUtcAndGpsTime) {
    const GpsTime time = parse_gps_iso("2022-03-18T08:51:22.300");
    EXPECT_EQ(utc_text(time), "2022-03-18 08:51:04.300");
    EXPECT_EQ(gps_text(time), "2022-03-18 08:51:22.300");
    EXPECT_EQ(seconds_text({.nanoseconds = 40'200'000'000}), "40.200 s");
}

TEST(Display, CountsAgreeWithTheirNoun) {
    EXPECT_EQ(counted(1, "epoch"), "1 epoch");
    EXPECT_EQ(counted(0, "epoch"), "0 epochs");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
