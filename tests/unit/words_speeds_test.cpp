#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/failure.h"
#include "core/random.h"
#include "core/text.h"
#include "reports/words/decision.h"
#include "schemas/verdict/figures.h"

// The one table by which speeds are rounded for people: a measured one down, an uncertainty, a
// required speed and a limit up, all with the same decimals.

namespace runcert::RUNCERT_FILE {
namespace {

/// As 5-windows and 6-verdict keep it.
double kept(double speed_m_s) {
    return parse_double(format_fixed(speed_m_s, speed_decimals_kept)).value();
}

double in_m_s(const SpeedUnit& unit, double value) {
    return value / unit.per_m_s;
}

TEST(ShownSpeed, OfARecordInItsOwnUnitIsTheRecordThoughItIsKeptInMetresPerSecond) {
    // 448.8 km/h is kept as 124.666667 m/s, which is 448.8000012 km/h.
    const SpeedUnit& km_h = speed_unit("km/h");
    EXPECT_GT(kept(in_m_s(km_h, 448.8)) * km_h.per_m_s, 448.800001);
    for (const SpeedUnit& unit : speed_units())
        for (const double figure : {448.8, 202.9, 50.25, 0.1, 0.3, 99.99, 1234.56, 7.0, 650.11})
            for (int decimals = 2; decimals <= 4; ++decimals)
                for (const SpeedKind kind :
                     {SpeedKind::measured, SpeedKind::uncertainty, SpeedKind::required,
                      SpeedKind::limit, SpeedKind::plain}) {
                    const std::string exact = format_fixed(figure, decimals);
                    EXPECT_EQ(shown_speed(kind, in_m_s(unit, figure), decimals, unit), exact);
                    EXPECT_EQ(shown_speed(kind, kept(in_m_s(unit, figure)), decimals, unit), exact);
                }
}

TEST(ShownSpeed, IsRoundedByWhatItIs) {
    const SpeedUnit& km_h = speed_unit("km/h");
    const struct {
        double km_h;
        int decimals;
        const char *down, *up, *nearest;
    } cases[] = {
        {232.1789, 2, "232.17", "232.18", "232.18"},
        {232.1711, 2, "232.17", "232.18", "232.17"},
        {232.175, 2, "232.17", "232.18", "232.18"},
        {448.80001, 1, "448.8", "448.9", "448.8"},  // more than the last digit that is kept
        {448.79999, 1, "448.7", "448.8", "448.8"},
        {448.8000012, 1, "448.8", "448.8", "448.8"},
        {448.7999999, 1, "448.8", "448.8", "448.8"},
        {0.0, 2, "0.00", "0.00", "0.00"},
        {-0.0, 2, "0.00", "0.00", "0.00"},
        {-0.123, 2, "-0.13", "-0.12", "-0.12"},
        {-0.0004, 2, "-0.01", "0.00", "0.00"},
        {1e-9, 2, "0.00", "0.00", "0.00"},  // below what is kept
        {1e-4, 2, "0.00", "0.01", "0.00"},
        {36000.0, 0, "36000", "36000", "36000"},
        {1e9 + 0.25, 1, "1000000000.2", "1000000000.3", "1000000000.3"},
    };
    for (const auto& c : cases) {
        SCOPED_TRACE(c.km_h);
        const double speed_m_s = c.km_h / km_h.per_m_s;
        EXPECT_EQ(shown_speed(SpeedKind::measured, speed_m_s, c.decimals, km_h), c.down);
        for (const SpeedKind kind : {SpeedKind::uncertainty, SpeedKind::required, SpeedKind::limit})
            EXPECT_EQ(shown_speed(kind, speed_m_s, c.decimals, km_h), c.up);
        EXPECT_EQ(shown_speed(SpeedKind::plain, speed_m_s, c.decimals, km_h), c.nearest);
    }
    for (const double bad : {std::nan(""), HUGE_VAL, 1e300})
        EXPECT_THROW(shown_speed(SpeedKind::measured, bad, 2, km_h), Failure);
    EXPECT_THROW(shown_speed(SpeedKind::measured, 1.0, 10, km_h), Failure);
}

TEST(ShownSpeed, NeverClaimsMoreThanTheValue) {
    RandomGenerator random(7);
    const double guard_m_s = speed_guard_m_s + 0.5e-6;  // and what is not kept
    for (int i = 0; i < 100'000; ++i) {
        const SpeedUnit& unit = speed_units()[random.next() % speed_units().size()];
        const int decimals = static_cast<int>(random.next() % 7);
        const double size = std::pow(10.0, random.uniform() * 9.0 - 6.0);
        double speed_m_s = size * (random.uniform() * 2.0 - 0.2);
        if (i % 3 == 0)  // a decimal figure of the unit, and what lies beside it
            speed_m_s = std::round(speed_m_s * unit.per_m_s * 100.0) / 100.0 / unit.per_m_s +
                        (random.uniform() - 0.5) * 4e-6;
        const double value = speed_m_s * unit.per_m_s, guard = guard_m_s * unit.per_m_s;
        const double binary = 1e-12 * std::abs(value) + 1e-12;
        const double step = std::pow(10.0, -decimals);
        const auto shown = [&](SpeedKind kind, double m_s) {
            return parse_double(shown_speed(kind, m_s, decimals, unit)).value();
        };
        const double down = shown(SpeedKind::measured, speed_m_s);
        ASSERT_LE(down, value + guard + binary) << speed_m_s << ' ' << decimals << unit.name;
        ASSERT_GT(down, value - step - guard - binary) << speed_m_s << ' ' << decimals << unit.name;
        for (const SpeedKind kind :
             {SpeedKind::uncertainty, SpeedKind::required, SpeedKind::limit}) {
            const double up = shown(kind, speed_m_s);
            ASSERT_GE(up, value - guard - binary) << speed_m_s << ' ' << decimals << unit.name;
            ASSERT_LT(up, value + step + guard + binary)
                << speed_m_s << ' ' << decimals << unit.name;
        }
        // What is read from a file is shown as what was computed.
        for (const SpeedKind kind : {SpeedKind::measured, SpeedKind::required, SpeedKind::plain})
            ASSERT_EQ(shown(kind, speed_m_s), shown(kind, kept(speed_m_s))) << speed_m_s;
    }
}

TEST(ShownSpeed, ValueAndUncertaintyHaveTheSameDecimalsInEveryUnit) {
    RandomGenerator random(11);
    const auto decimals = [](const std::string& text) {
        const std::size_t point = text.find('.');
        return point == std::string::npos ? 0 : static_cast<int>(text.size() - point - 1);
    };
    for (int i = 0; i < 20'000; ++i) {
        const SpeedUnit& own = speed_units()[random.next() % speed_units().size()];
        const double speed_m_s = 1.0 + 200.0 * random.uniform();
        const double u_m_s = std::pow(10.0, random.uniform() * 4.0 - 3.0);
        const auto rule = random.next() % 2 == 0
                              ? std::nullopt
                              : std::optional(static_cast<int>(random.next() % 4));
        const ShownFigures shown = shown_in({.speed_m_s = speed_m_s,
                                             .expanded_uncertainty_m_s = u_m_s,
                                             .required_speed_m_s = speed_m_s - 1.0,
                                             .acceptance_limit_m_s = speed_m_s - 1.0 + u_m_s},
                                            own, rule);
        ASSERT_EQ(decimals(shown.speed), decimals(shown.expanded_uncertainty)) << u_m_s;
        ASSERT_EQ(decimals(shown.speed), decimals(shown.required_speed));
        ASSERT_EQ(decimals(shown.speed), decimals(shown.acceptance_limit));
        for (const SpeedUnit& unit : speed_units()) {
            const std::string speed = shown_speed(SpeedKind::measured, speed_m_s, shown, unit);
            const std::string u = shown_speed(SpeedKind::uncertainty, u_m_s, shown, unit);
            ASSERT_EQ(decimals(speed), decimals(u)) << unit.name;
            // In the verdict's own unit, what the verdict shows.
            if (unit.name == own.name) {
                ASSERT_EQ(speed, shown.speed);
                ASSERT_EQ(u, shown.expanded_uncertainty);
                ASSERT_EQ(shown_speed(SpeedKind::required, speed_m_s - 1.0, shown, unit),
                          shown.required_speed);
            }
            // No digit below the one that a tenth of the uncertainty begins with.
            const double tenth = 0.1 * parse_double(u).value();
            ASSERT_GE(std::pow(10.0, -decimals(speed)),
                      0.999 * std::pow(10.0, std::floor(std::log10(tenth) - 1e-9)))
                << speed << " ± " << u;
        }
    }
}

TEST(ShownSpeed, APlainOneHasAtLeastTheUsualDecimals) {
    const ShownFigures shown =
        shown_in({.speed_m_s = 60.0, .expanded_uncertainty_m_s = 6.0}, speed_unit("kn"));
    EXPECT_EQ(shown.speed, "116");
    EXPECT_EQ(shown.expanded_uncertainty, "12");
    const SpeedUnit& knots = speed_unit("kn");
    EXPECT_EQ(shown_speed(SpeedKind::plain, 54.08 / knots.per_m_s, shown, knots), "54.08");
    EXPECT_EQ(shown_speed(SpeedKind::plain, 0.097 / knots.per_m_s, shown, knots), "0.10");
}

TEST(ShownDifference, IsThatOfWhatIsShown) {
    EXPECT_EQ(shown_difference("54.17", "54.12"), "0.05");
    EXPECT_EQ(shown_difference("54.1", "54.12"), "-0.02");
    EXPECT_EQ(shown_difference("232", "232"), "0");
    ProfileVerdict verdict{.outcome = Outcome::beaten,
                           .speed_m_s = 60.0,
                           .expanded_uncertainty_m_s = 0.05,
                           .required_speed_m_s = 59.9001};
    verdict.decision = Decision{.acceptance_limit_m_s = 59.95011, .risk = 0.01};
    for (const SpeedUnit& unit : speed_units()) {
        const ShownFigures shown = shown_of(verdict, unit.name);
        EXPECT_EQ(guard_band_figure(verdict, unit),
                  shown_difference(shown.acceptance_limit, shown.required_speed));
        EXPECT_NE(guard_band_text(verdict, unit).find(guard_band_figure(verdict, unit)),
                  std::string::npos);
    }
    EXPECT_EQ(guard_band_figure({}, speed_unit("km/h")), "");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
