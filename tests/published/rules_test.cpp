#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <string>

#include "core/rounding.h"
#include "schemas/profile/profile.h"
#include "stages/check/decision.h"
#include "stages/check/requirements.h"

// Figures that the bodies themselves published.
namespace runcert::published::RUNCERT_FILE {
namespace {

const double kKnot = metres_per_second("kn");
const double kKmh = metres_per_second("km/h");

/// The speed in its unit with two decimals, after the body's rounding.
std::string printed(double speed_m_s, StepRounding mode, double unit_m_s) {
    const double rounded_m_s = rounded_speed(speed_m_s, {mode, unit_m_s, 2});
    return shown_figure(rounded_m_s / unit_m_s, 2, SafeSide::down);
}

TEST(Rules, WssrcSpeedsInKnots) {
    // Newsletters of the World Sailing Speed Record Council: distance (m), time (s), current (kn),
    // and the speed as printed. Four were rounded to the nearest, one was truncated.
    const struct {
        double distance_m;
        double elapsed_s;
        double current_kn;
        const char* printed;
        const char* truncated;
        const char* nearest;
    } cases[] = {
        {1853.81, 71.8, 0.02, "50.17", "50.16", "50.17"},
        {502.25, 20.8, 0.06, "46.88", "46.87", "46.88"},
        {501.9, 20.6, 0.0, "47.36", "47.35", "47.36"},
        {501.0, 19.34, 0.1, "50.26", "50.25", "50.26"},
        {500.0, 17.97, 0.0, "54.08", "54.08", "54.09"},
    };
    int nearest_reproduces = 0;
    int truncation_reproduces = 0;
    for (const auto& c : cases) {
        SCOPED_TRACE(c.printed);
        const double speed_m_s = course_speed_m_s(c.distance_m, c.elapsed_s, c.current_kn * kKnot);
        EXPECT_EQ(printed(speed_m_s, StepRounding::down, kKnot), c.truncated);
        EXPECT_EQ(printed(speed_m_s, StepRounding::nearest, kKnot), c.nearest);
        nearest_reproduces += std::string(c.printed) == c.nearest;
        truncation_reproduces += std::string(c.printed) == c.truncated;
    }
    EXPECT_EQ(nearest_reproduces, 4);
    EXPECT_EQ(truncation_reproduces, 1);
    EXPECT_NEAR(course_speed_m_s(500.0, 17.97, 0.0) / kKnot, 54.0858, 5e-5);
}

TEST(Rules, WssrcMarginOfAHundredthOfASecondOver500Metres) {
    // A record of 17.97 s is beaten by 17.96 s: 500 m / 17.96 s = 54.1159 kn.
    const MarginRule rule{.kind = MarginKind::elapsed_time, .value = 0.01, .distance_m = 500.0};
    const Threshold threshold = threshold_of(rule, {course_speed_m_s(500.0, 17.97, 0.0)});
    EXPECT_NEAR(threshold.speed_m_s / kKnot, 54.1159, 5e-5);
    EXPECT_EQ(conformance_probability({course_speed_m_s(500.0, 17.96, 0.0), 0.0}, threshold), 1.0);
    EXPECT_EQ(conformance_probability({course_speed_m_s(500.0, 17.961, 0.0), 0.0}, threshold), 0.0);
}

std::string next_fisly_required_speed(double record_kmh, StepRounding mode) {
    const MarginRule rule{
        .kind = MarginKind::relative, .value = 0.002, .rounding = DecimalRounding{mode, kKmh, 2}};
    const Threshold threshold = threshold_of(rule, {record_kmh * kKmh});
    return shown_figure(threshold.speed_m_s / kKmh, 2, SafeSide::up);
}

TEST(Rules, FislyNextTargetAfter222Point43) {
    // 222.43 x 1.002 = 222.87486. The published 222.87 is the truncated figure and also the
    // nearest, so that it does not tell the two apart; 222.60 x 1.002 = 223.0452 would.
    EXPECT_EQ(next_fisly_required_speed(222.43, StepRounding::down), "222.87");
    EXPECT_EQ(next_fisly_required_speed(222.43, StepRounding::nearest), "222.87");
    EXPECT_EQ(next_fisly_required_speed(222.43, StepRounding::up), "222.88");
    EXPECT_EQ(next_fisly_required_speed(222.60, StepRounding::down), "223.04");
    EXPECT_EQ(next_fisly_required_speed(222.60, StepRounding::nearest), "223.05");
}

TEST(Rules, NalsaOneMileAnHourAboveGreenbird) {
    const double mph = metres_per_second("mph");
    const MarginRule rule{.kind = MarginKind::absolute, .value = 1.0 * mph};
    EXPECT_NEAR(threshold_of(rule, {126.2 * mph}).speed_m_s / mph, 127.2, 1e-13 * 127.2);
}

TEST(Rules, ConformanceProbabilityOfJcgm106) {
    EXPECT_NEAR(conformance_probability({13.6, 1.8}, {12.5}) -
                    conformance_probability({13.6, 1.8}, {16.3}),
                0.6626, 5e-5);
}

TEST(Rules, FaiRangesTwoPerCentApart) {
    // Lower limit of the new range at least 2 % above the upper limit of the old, in hundredths of
    // km/h, both ranges +- twice the standard uncertainty: 100 (new - U) >= 102 (old + U), in
    // integers.
    const double level = 0.5 * std::erfc(-std::sqrt(2.0));  // Phi(2)
    const MarginRule rule{.kind = MarginKind::relative, .value = 0.02, .above_upper_limit = true};
    const long old_speed = 50000;
    const long old_expanded = 40;
    const Threshold threshold =
        threshold_of(rule, {static_cast<double>(old_speed) / 100.0 * kKmh,
                            static_cast<double>(old_expanded) / 100.0 * kKmh});
    EXPECT_NEAR(threshold.speed_m_s / kKmh, 510.408, 1e-10);
    int beaten = 0;
    for (const long expanded : {10L, 26L, 40L, 100L})
        for (long speed = 51000; speed <= 51200; ++speed) {
            const SpeedPosterior posterior{static_cast<double>(speed) / 100.0 * kKmh,
                                           static_cast<double>(expanded) / 200.0 * kKmh};
            const bool apart = 100 * (speed - expanded) >= 102 * (old_speed + old_expanded);
            const double probability = conformance_probability(posterior, threshold);
            EXPECT_EQ(decide(probability, level) == Outcome::beaten, apart)
                << speed << " +- " << expanded;
            beaten += apart;
        }
    EXPECT_GT(beaten, 0);
    // Rounded down: 510.40 km/h is to be reached.
    MarginRule rounded = rule;
    rounded.rounding = DecimalRounding{StepRounding::down, kKmh, 2};
    EXPECT_EQ(shown_figure(threshold_of(rounded, {500.0 * kKmh, 0.4 * kKmh}).speed_m_s / kKmh, 2,
                           SafeSide::up),
              "510.40");
}

}  // namespace
}  // namespace runcert::published::RUNCERT_FILE
