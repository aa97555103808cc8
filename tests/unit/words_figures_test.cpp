#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/failure.h"
#include "core/prose.h"
#include "schemas/verdict/figures.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(WordsOfFigures, AnUncertaintyHasTwoSignificantDigits) {
    EXPECT_EQ(uncertainty_text(0.018365), "0.018");
    EXPECT_EQ(uncertainty_text(0.0996), "0.10");
    EXPECT_EQ(uncertainty_text(0.09949), "0.099");
    EXPECT_EQ(uncertainty_text(0.31), "0.31");
    EXPECT_EQ(uncertainty_text(1.24), "1.2");
    EXPECT_EQ(uncertainty_text(9.96), "10");
    EXPECT_EQ(uncertainty_text(23.4), "23");
    EXPECT_EQ(uncertainty_text(0.000012), "0.000012");
}

TEST(WordsOfFigures, FiguresHaveTheirSignificantDigits) {
    EXPECT_EQ(significant_text(0.0, 3), "0");
    EXPECT_EQ(significant_text(0.00057735, 2), "0.00058");
    EXPECT_EQ(significant_text(-72.0018, 3), "-72.0");
    EXPECT_EQ(significant_text(9.96, 2), "10");
    EXPECT_EQ(significant_text(0.0996, 2), "0.10");
    EXPECT_EQ(significant_text(4123.4, 3), "4123");
    EXPECT_EQ(significant_text(3.1e-9, 2), "3.1e-09");
    for (const double none : {std::numeric_limits<double>::infinity(), std::nan("")}) {
        EXPECT_EQ(significant_text(none, 3), "not determined");
        EXPECT_EQ(scientific_text(none), "not determined");
    }
    EXPECT_EQ(coverage_text(2.000001), "2");
    EXPECT_EQ(coverage_text(2.0689), "2.07");
}

TEST(WordsOfFigures, ASpeedHasAtLeastTheDecimalsOfItsUnitAndThoseOfItsUncertainty) {
    const SpeedUnit& km_h = speed_unit("km/h");
    EXPECT_EQ(speed_text(60.002417, std::nullopt, km_h), "216.01");
    EXPECT_EQ(speed_text(60.002417, 0.005102, km_h), "216.009");
    EXPECT_EQ(speed_text(60.002417, 1.0, km_h), "216.01");
}

// Standing figures: Greenbird 202.9 km/h is 126.1 mph.
TEST(WordsOfFigures, UnitsConvertExactly) {
    EXPECT_EQ(speed_text(202.9 / 3.6, std::nullopt, speed_unit("mph")), "126.08");
    EXPECT_EQ(speed_text(1852.0 / 3600.0, std::nullopt, speed_unit("kn")), "1.00");
    EXPECT_EQ(&speed_unit(""), &speed_unit("km/h"));
    EXPECT_THROW(speed_unit("furlongs"), Failure);
}

TEST(WordsOfFigures, TimesAreGivenInUtcAndGpsTime) {
    const GpsTime time = parse_gps_iso("2022-03-18T08:51:22.300");
    EXPECT_EQ(utc_text(time), "2022-03-18 08:51:04.300");
    EXPECT_EQ(gps_text(time), "2022-03-18 08:51:22.300");
    EXPECT_EQ(seconds_text({.nanoseconds = 40'200'000'000}), "40.200 s");
}

TEST(WordsOfFigures, CountsAgreeWithTheirNoun) {
    EXPECT_EQ(counted(1, "epoch"), "1 epoch");
    EXPECT_EQ(counted(0, "epoch"), "0 epochs");
}

TEST(WordsOfFigures, AProbabilityNeverShowsAsOneThatItDoesNotReach) {
    EXPECT_EQ(probability_text(0.975), "97.50 %");
    EXPECT_EQ(probability_text(0.9749999), "97.49 %");
    EXPECT_EQ(probability_text(0.025), "2.50 %");
    EXPECT_EQ(probability_text(0.0250001), "2.51 %");
    EXPECT_EQ(probability_text(0.99995), "99.9950 %");
    EXPECT_EQ(probability_text(1.0), "more than 99.9999 %");
    EXPECT_EQ(probability_text(0.0), "less than 0.0001 %");
    EXPECT_EQ(level_text(1.0 - 0.975), "2.5 %");
}

TEST(WordsOfFigures, AQuantityHasTheDecimalsOfItsUncertaintyWhichIsRoundedUp) {
    EXPECT_EQ(
        figure_text({.name = "a", .value = 12.3456, .unit = "deg", .expanded_uncertainty = 0.301}),
        "a: 12.35 deg ± 0.31 deg (k = 2)");
    EXPECT_EQ(figure_text({.name = "a", .value = 31.0, .unit = {}}), "a: 31");
    EXPECT_EQ(figure_text({.name = "a", .value = 12345.67, .unit = "m"}), "a: 12345.7 m");
    EXPECT_EQ(figure_text({.name = "a",
                           .value = 0.123456,
                           .unit = "%",
                           .expanded_uncertainty = 0.0,
                           .note = "why"}),
              "a: 0.123456 %; why");
    EXPECT_EQ(quantity_text(0.4211, 0.0801, "m"), "0.421 m ± 0.081 m");
}

TEST(WordsOfFigures, AFigureThatAVerdictShowsIsNotRoundedAnew) {
    EXPECT_EQ(figure_text({.name = "speed",
                           .value = 232.1789,
                           .unit = "km/h",
                           .expanded_uncertainty = 0.1611,
                           .shown = "232.17 km/h ± 0.17 km/h (k = 2)"}),
              "speed: 232.17 km/h ± 0.17 km/h (k = 2)");
}

// 64.4941 m/s is 232.17876 km/h and 144.26919 mph; 0.0447 m/s is 0.16092 km/h and 0.09999 mph.
TEST(WordsOfFigures, ShownSpeedsAreRoundedToTheSafeSideInEveryUnit) {
    const SpeedsToShow speeds{.speed_m_s = 64.4941,
                              .expanded_uncertainty_m_s = 0.0447,
                              .required_speed_m_s = 62.2304,
                              .acceptance_limit_m_s = 62.2747};
    const ShownFigures km_h = shown_in(speeds, speed_unit("km/h"));
    EXPECT_EQ(km_h.speed, "232.17");
    EXPECT_EQ(km_h.expanded_uncertainty, "0.17");
    EXPECT_EQ(km_h.required_speed, "224.03");
    EXPECT_EQ(km_h.acceptance_limit, "224.19");
    EXPECT_EQ(measured_speed_text(km_h), "232.17 km/h ± 0.17 km/h");
    EXPECT_EQ(measured_speed_text(km_h, 2.0689), "232.17 km/h ± 0.17 km/h (k = 2.07)");
    EXPECT_EQ(in_decimals_of(km_h, 62.2747, SafeSide::down), "224.18");
    const ShownFigures mph = shown_in(speeds, speed_unit("mph"));
    EXPECT_EQ(mph.speed, "144.26");
    EXPECT_EQ(mph.expanded_uncertainty, "0.10");
    // The rule's decimals, where they are fewer, of the uncertainty too.
    const ShownFigures rule = shown_in(speeds, speed_unit("km/h"), 1);
    EXPECT_EQ(rule.speed, "232.1");
    EXPECT_EQ(rule.expanded_uncertainty, "0.2");
    EXPECT_EQ(rule.required_speed, "224.1");
}

TEST(WordsOfFigures, AVerdictWithoutShownFiguresIsShownByTheSameRounding) {
    const ProfileVerdict verdict{.speed_m_s = 64.4941, .expanded_uncertainty_m_s = 0.0447};
    EXPECT_EQ(measured_speed_text(shown_of(verdict, "km/h")), "232.17 km/h ± 0.17 km/h");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
