#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/failure.h"
#include "core/random.h"
#include "core/rounding.h"
#include "stages/check/decision.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kKmh = 1000.0 / 3600.0;

TEST(ShownFigure, IsRoundedToTheSafeSideOnly) {
    const struct {
        double value;
        int decimals;
        const char* down;
        const char* up;
    } cases[] = {
        {222.879, 2, "222.87", "222.88"},
        {222.871, 2, "222.87", "222.88"},
        {222.87, 2, "222.87", "222.87"},
        {222.87, 1, "222.8", "222.9"},
        {222.87, 0, "222", "223"},
        {222.87, 4, "222.8700", "222.8700"},
        {0.164, 2, "0.16", "0.17"},
        {0.1, 1, "0.1", "0.1"},
        {0.3, 3, "0.300", "0.300"},
        {99.999, 2, "99.99", "100.00"},
        {100.0, 0, "100", "100"},
        {0.0, 2, "0.00", "0.00"},
        {-0.0, 2, "0.00", "0.00"},
        {0.001, 2, "0.00", "0.01"},
        {-0.001, 2, "-0.01", "0.00"},
        {-1.25, 1, "-1.3", "-1.2"},
        {1.005, 2, "1.00", "1.01"},
        {123456.123456789, 9, "123456.123456789", "123456.123456789"},
        {222.8700001, 2, "222.87", "222.88"},
        {222.8699999, 2, "222.86", "222.87"},
    };
    for (const auto& c : cases) {
        EXPECT_EQ(shown_figure(c.value, c.decimals, SafeSide::down), c.down);
        EXPECT_EQ(shown_figure(c.value, c.decimals, SafeSide::up), c.up);
    }
}

TEST(ShownFigure, OfADecimalFigureIsThatFigureAfterConversions) {
    for (const double unit_m_s : {kKmh, 1.0, 1852.0 / 3600.0, 1609.344 / 3600.0})
        for (int hundredths = 1; hundredths <= 60000; hundredths += 7) {
            const double figure = hundredths / 100.0;
            const std::string text = std::to_string(hundredths / 100) + "." +
                                     std::to_string(hundredths % 100 / 10) +
                                     std::to_string(hundredths % 10);
            const double back = figure * unit_m_s / unit_m_s;
            ASSERT_EQ(shown_figure(back, 2, SafeSide::down), text);
            ASSERT_EQ(shown_figure(back, 2, SafeSide::up), text);
            ASSERT_EQ(shown_figure(figure * 1.002 / 1.002, 2, SafeSide::up), text);
        }
}

TEST(ShownFigure, OfTheSpeedToReachIsThePublishedOne) {
    const MarginRule rule{.kind = MarginKind::relative,
                          .value = 0.002,
                          .rounding = DecimalRounding{StepRounding::down, kKmh, 2}};
    const Threshold threshold = threshold_of(rule, {222.43 * kKmh});
    EXPECT_EQ(shown_figure(threshold.speed_m_s / kKmh, 2, SafeSide::up), "222.87");
}

TEST(ShownFigure, IsOnItsSideAndWithinOneUnitOfTheLastPlace) {
    RandomGenerator random(110);
    for (int i = 0; i < 20000; ++i) {
        const double value = 400.0 * random.uniform();
        const int decimals = static_cast<int>(random.next() % 10);
        const double step = std::pow(10.0, -decimals);
        const double down = std::stod(shown_figure(value, decimals, SafeSide::down));
        const double up = std::stod(shown_figure(value, decimals, SafeSide::up));
        EXPECT_LE(down, value * (1.0 + 4e-15));
        EXPECT_GE(up, value * (1.0 - 4e-15));
        EXPECT_GT(down, value - step - 1e-12);
        EXPECT_LT(up, value + step + 1e-12);
    }
}

TEST(ShownFigure, NeverContradictsTheOutcome) {
    RandomGenerator random(111);
    int refused_close = 0;
    int accepted = 0;
    for (int i = 0; i < 50000; ++i) {
        // km/h; one in four without uncertainty, one in four exactly on a hundredth.
        const double u = i % 4 == 0 ? 0.0 : 0.2 * std::pow(random.uniform(), 3.0);
        const double to_reach =
            200.0 + (i % 8 < 4 ? 0.01 * std::floor(100.0 * random.uniform()) : random.uniform());
        const double speed = to_reach + 3.0 * (u + 0.005) * random.normal();
        const SpeedPosterior posterior{speed * kKmh, u * kKmh};
        const Threshold threshold{to_reach * kKmh};
        const Outcome outcome = decide(conformance_probability(posterior, threshold), 0.975);
        const double limit = acceptance_limit(posterior, threshold, 0.975) / kKmh;
        const int decimals = decimals_of(2.0 * u, std::nullopt);
        const auto number = [&](double value, SafeSide side) {
            return std::stod(shown_figure(value, decimals, side));
        };
        const double shown_speed = number(speed, SafeSide::down);
        const double shown_to_reach = number(to_reach, SafeSide::up);
        if (outcome == Outcome::beaten) {
            ++accepted;
            if (u > 0.0) {
                EXPECT_GE(shown_speed, shown_to_reach);
            }
        } else {
            EXPECT_LT(shown_speed, number(limit, SafeSide::up));
            if (speed < to_reach) {
                EXPECT_LT(shown_speed, shown_to_reach);
            }
            if (limit - speed < std::pow(10.0, -decimals)) ++refused_close;
        }
    }
    EXPECT_GT(refused_close, 1000);
    EXPECT_GT(accepted, 5000);
}

TEST(DecimalsOf, AreThoseOfTwoDigitsRoundedUpOrFewer) {
    const struct {
        double uncertainty;
        std::optional<int> rule;
        int expected;
        const char* shown;
    } cases[] = {
        {0.164, {}, 2, "0.17"},   {0.164, 2, 2, "0.17"},     {0.164, 1, 1, "0.2"},
        {0.164, 3, 2, "0.17"},    {0.164, 0, 0, "1"},        {0.1, {}, 2, "0.10"},
        {0.099, {}, 3, "0.099"},  {0.0991, {}, 2, "0.10"},   {0.0901, {}, 3, "0.091"},
        {0.0124, {}, 3, "0.013"}, {0.99, {}, 2, "0.99"},     {0.991, {}, 1, "1.0"},
        {1.0, {}, 1, "1.0"},      {1.64, {}, 1, "1.7"},      {9.91, {}, 0, "10"},
        {9.9, {}, 1, "9.9"},      {10.0, {}, 0, "10"},       {164.2, {}, 0, "165"},
        {164.2, 2, 0, "165"},     {1e-9, {}, 6, "0.000001"}, {0.0, 3, 3, "0.000"},
        {0.0, {}, 2, "0.00"},     {0.3, {}, 2, "0.30"},      {0.07, {}, 3, "0.070"},
    };
    for (const auto& c : cases) {
        SCOPED_TRACE(c.uncertainty);
        EXPECT_EQ(decimals_of(c.uncertainty, c.rule), c.expected);
        EXPECT_EQ(shown_figure(c.uncertainty, c.expected, SafeSide::up), c.shown);
    }
}

TEST(ShownFigure, RefusesWhatCannotBeShown) {
    for (const double bad : {kNaN, kInfinity, -kInfinity}) {
        EXPECT_THROW(shown_figure(bad, 2, SafeSide::down), Failure);
        EXPECT_THROW(decimals_of(bad, 2), Failure);
    }
    EXPECT_THROW(shown_figure(1e300, 2, SafeSide::down), Failure);
    EXPECT_THROW(shown_figure(1.0, -1, SafeSide::down), Failure);
    EXPECT_THROW(shown_figure(1.0, 10, SafeSide::down), Failure);
    EXPECT_THROW(decimals_of(-0.1, 2), Failure);
    EXPECT_THROW(decimals_of(0.1, -1), Failure);
    EXPECT_THROW(decimals_of(0.0, -1), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
