#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/failure.h"
#include "schemas/profile/profile.h"
#include "stages/check/decision.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kKmh = 1000.0 / 3600.0;
constexpr double kKnot = 1852.0 / 3600.0;

constexpr StepRounding kModes[] = {StepRounding::down, StepRounding::nearest, StepRounding::up};

/// A unit of speed, exact in mm/h.
struct Unit {
    const char* name;
    std::int64_t mm_per_h;
};

constexpr Unit kUnits[] = {{"km/h", 1000000}, {"m/s", 3600000}, {"kn", 1852000}, {"mph", 1609344}};

/// numerator / denominator rounded by integers alone.
std::int64_t rounded_ratio(std::int64_t numerator, std::int64_t denominator, StepRounding mode) {
    if (mode == StepRounding::down) return numerator / denominator;
    if (mode == StepRounding::up) return (numerator + denominator - 1) / denominator;
    return (2 * numerator + denominator) / (2 * denominator);
}

/// Whether the ratio is as near to a whole number, or a half, as a binary fraction of it is, and
/// yet is none.
bool too_close_to_call(std::int64_t numerator, std::int64_t denominator) {
    const std::int64_t rest = (2 * numerator) % denominator;
    const std::int64_t distance = std::min(rest, denominator - rest);
    return distance != 0 && static_cast<double>(distance) < 2e-6 * static_cast<double>(denominator);
}

struct Comparison {
    std::int64_t compared = 0;
    std::int64_t skipped = 0;
    std::int64_t wrong = 0;
};

/// Every record from 50.00 to 300.00 of the unit, with every margin and mode, to hundredths.
Comparison compare_with_integers(const Unit& of_record, const Unit& of_rule) {
    Comparison result;
    const double record_unit_m_s = metres_per_second(of_record.name);
    const double rule_unit_m_s = metres_per_second(of_rule.name);
    const std::int64_t margins_per_mille[] = {1, 2, 5, 10, 20};
    for (std::int64_t hundredths = 5000; hundredths <= 30000; ++hundredths) {
        const double record_m_s = static_cast<double>(hundredths) / 100.0 * record_unit_m_s;
        for (const std::int64_t margin : margins_per_mille) {
            const std::int64_t numerator = hundredths * (1000 + margin) * of_record.mm_per_h;
            const std::int64_t denominator = 1000 * of_rule.mm_per_h;
            if (too_close_to_call(numerator, denominator)) {
                ++result.skipped;
                continue;
            }
            for (const StepRounding mode : kModes) {
                const MarginRule rule{.kind = MarginKind::relative,
                                      .value = static_cast<double>(margin) / 1000.0,
                                      .rounding = DecimalRounding{mode, rule_unit_m_s, 2}};
                const auto exact = static_cast<double>(rounded_ratio(numerator, denominator, mode));
                const double expected_m_s = exact / 100.0 * rule_unit_m_s;
                if (threshold_of(rule, {record_m_s}).speed_m_s != expected_m_s) ++result.wrong;
                ++result.compared;
            }
        }
    }
    return result;
}

TEST(Threshold, IsThatOfIntegerArithmeticForEveryRecordMarginAndUnit) {
    for (const Unit& unit : kUnits) {
        const Comparison result = compare_with_integers(unit, unit);
        EXPECT_EQ(result.wrong, 0) << unit.name;
        EXPECT_EQ(result.compared, 25001 * 5 * 3);
    }
}

TEST(Threshold, IsThatOfIntegerArithmeticFromOneUnitToAnother) {
    for (const Unit& of_record : kUnits)
        for (const Unit& of_rule : kUnits) {
            const Comparison result = compare_with_integers(of_record, of_rule);
            EXPECT_EQ(result.wrong, 0) << of_record.name << " to " << of_rule.name;
            EXPECT_LT(result.skipped, 10);
        }
}

TEST(Threshold, IsNotMovedByNoiseButByAMillionthOfTheLastPlace) {
    for (const double figure : {50.76, 100.2, 222.87, 300.0, 510.4})
        for (const StepRounding mode : kModes) {
            const DecimalRounding rounding{mode, kKmh, 2};
            const double speed_m_s = figure * kKmh;
            for (const double noise : {-1e-12, -1e-15, 0.0, 1e-15, 1e-12})
                EXPECT_EQ(rounded_speed(speed_m_s * (1.0 + noise), rounding), speed_m_s);
            const double below = rounded_speed((figure - 1e-8) * kKmh, rounding) / kKmh;
            const double above = rounded_speed((figure + 1e-8) * kKmh, rounding) / kKmh;
            EXPECT_NEAR(below, mode == StepRounding::down ? figure - 0.01 : figure, 1e-12);
            EXPECT_NEAR(above, mode == StepRounding::up ? figure + 0.01 : figure, 1e-12);
        }
}

TEST(Threshold, TakesAHalfUpAndWhatIsAMillionthBelowItDown) {
    const DecimalRounding nearest{StepRounding::nearest, kKmh, 2};
    EXPECT_EQ(rounded_speed(222.945 * kKmh, nearest), 222.95 * kKmh);
    EXPECT_EQ(rounded_speed(222.945 * kKmh * (1.0 - 1e-12), nearest), 222.95 * kKmh);
    EXPECT_EQ(rounded_speed((222.945 - 1e-8) * kKmh, nearest), 222.94 * kKmh);
    EXPECT_EQ(rounded_speed(0.0, nearest), 0.0);
}

TEST(Threshold, ModesKeepTheirOrder) {
    for (int i = 0; i < 1000; ++i) {
        const double speed_m_s = 13.0 + 0.0731 * i;
        for (const int decimals : {0, 1, 2, 5, 9}) {
            const double down = rounded_speed(speed_m_s, {StepRounding::down, kKnot, decimals});
            const double nearest =
                rounded_speed(speed_m_s, {StepRounding::nearest, kKnot, decimals});
            const double up = rounded_speed(speed_m_s, {StepRounding::up, kKnot, decimals});
            const double step = kKnot * std::pow(10.0, -decimals);
            EXPECT_LE(down, speed_m_s * (1.0 + 3e-12));
            EXPECT_GE(up, speed_m_s * (1.0 - 3e-12));
            EXPECT_TRUE(nearest == down || nearest == up);
            EXPECT_LE(std::abs(nearest - speed_m_s), 0.5 * step + 1e-12);
            EXPECT_LE(up - down, step * (1.0 + 1e-4));
        }
    }
}

TEST(Threshold, CarriesTheRecordsUncertaintyByTheDerivative) {
    const MarginRule rules[] = {
        {.kind = MarginKind::absolute, .value = 0.44704},
        {.kind = MarginKind::relative, .value = 0.02},
        {.kind = MarginKind::elapsed_time, .value = 0.01, .distance_m = 500.0},
        {.kind = MarginKind::elapsed_time, .value = 4.0, .distance_m = 500.0},
    };
    for (MarginRule rule : rules)
        for (const double record_m_s : {14.0, 27.8, 61.8}) {
            const double h = 1e-4;
            const double numeric = (threshold_of(rule, {record_m_s + h}).speed_m_s -
                                    threshold_of(rule, {record_m_s - h}).speed_m_s) /
                                   (2.0 * h);
            // k = 2: the expanded uncertainty 0.3 is a standard uncertainty of 0.15.
            const Threshold plain = threshold_of(rule, {record_m_s, 0.3});
            EXPECT_NEAR(plain.standard_uncertainty_m_s, 0.15 * numeric, 1e-8);
            EXPECT_EQ(threshold_of(rule, {record_m_s}).standard_uncertainty_m_s, 0.0);
            rule.rounding = DecimalRounding{StepRounding::up, kKmh, 0};
            EXPECT_EQ(threshold_of(rule, {record_m_s, 0.3}).standard_uncertainty_m_s,
                      plain.standard_uncertainty_m_s);
            rule.rounding.reset();
        }
}

TEST(Threshold, AboveTheUpperLimitIsThatOfARecordRaisedToIt) {
    for (const MarginKind kind :
         {MarginKind::absolute, MarginKind::relative, MarginKind::elapsed_time}) {
        MarginRule rule{.kind = kind, .value = 0.02, .distance_m = 500.0};
        const Threshold raised = threshold_of(rule, {50.5});
        rule.above_upper_limit = true;
        const Threshold threshold = threshold_of(rule, {50.0, 0.5});
        EXPECT_EQ(threshold.speed_m_s, raised.speed_m_s);
        EXPECT_EQ(threshold.standard_uncertainty_m_s, 0.0);
    }
}

TEST(Threshold, OfAnElapsedTimeIsTheCourseInTheShorterTime) {
    // 500 m in 20 s; 0.01 s less, then half the time.
    const auto to_reach = [](double gain_s) {
        const MarginRule rule{
            .kind = MarginKind::elapsed_time, .value = gain_s, .distance_m = 500.0};
        return threshold_of(rule, {25.0}).speed_m_s;
    };
    EXPECT_DOUBLE_EQ(to_reach(0.01), 500.0 / 19.99);
    EXPECT_DOUBLE_EQ(to_reach(10.0), 50.0);
    EXPECT_EQ(to_reach(0.0), 25.0);
    EXPECT_THROW(to_reach(20.0), Failure);
    EXPECT_THROW(to_reach(21.0), Failure);
}

TEST(Threshold, RefusesWhatNoRuleOrRecordIs) {
    const MarginRule rule{.kind = MarginKind::relative, .value = 0.002};
    for (const double bad : {0.0, -1.0, kNaN, kInfinity})
        EXPECT_THROW(threshold_of(rule, {bad}), Failure);
    for (const double bad : {-1.0, kNaN, kInfinity}) {
        EXPECT_THROW(threshold_of(rule, {50.0, bad}), Failure);
        EXPECT_THROW(threshold_of({.kind = MarginKind::absolute, .value = bad}, {50.0}), Failure);
        EXPECT_THROW(threshold_of({.kind = MarginKind::elapsed_time, .distance_m = bad}, {50.0}),
                     Failure);
        EXPECT_THROW(rounded_speed(bad, {StepRounding::up, kKmh, 2}), Failure);
        EXPECT_THROW(rounded_speed(50.0, {StepRounding::up, bad, 2}), Failure);
    }
    EXPECT_THROW(threshold_of({.kind = MarginKind::elapsed_time}, {50.0}), Failure);
    EXPECT_THROW(rounded_speed(50.0, {StepRounding::up, kKmh, -1}), Failure);
    EXPECT_THROW(rounded_speed(50.0, {StepRounding::up, kKmh, 10}), Failure);
    EXPECT_THROW(rounded_speed(1e300, {StepRounding::up, kKmh, 2}), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
