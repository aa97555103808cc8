#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(StudentT, GivesScipysProbabilities) {
    // scipy 1.10.1, stats.t.cdf.
    const struct {
        double x;
        double degrees;
        double expected;
    } cases[] = {
        {2.0, 3, 0.9303370157205785},     {-2.0, 3, 0.06966298427942155},
        {-8.0, 3, 0.0020382887938927333}, {1.5, 2.5, 0.876081773456852},
        {0.3, 5, 0.6118754788683627},     {-40.0, 10, 1.1404288715428737e-12},
        {3.0, 1e6, 0.9986500687292891},   {-3.0, 30, 0.002694982032825972},
    };
    for (const auto& c : cases)
        EXPECT_NEAR(student_t_cdf(c.x, c.degrees), c.expected, 1e-11 * c.expected);
}

TEST(StudentT, IsTheClosedFormForOneAndTwoDegrees) {
    for (const double x : {-30.0, -2.0, -0.1, 0.0, 0.7, 5.0}) {
        EXPECT_NEAR(student_t_cdf(x, 1.0), 0.5 + std::atan(x) / std::numbers::pi, 1e-15);
        EXPECT_NEAR(student_t_cdf(x, 2.0), 0.5 + 0.5 * x / std::sqrt(2.0 + x * x), 1e-15);
    }
}

TEST(StudentT, OfInfiniteDegreesIsNormal) {
    for (const double x : {-9.0, -1.0, 0.0, 2.5}) {
        EXPECT_EQ(student_t_cdf(x, std::nullopt), normal_cdf(x));
        EXPECT_EQ(student_t_cdf(x, kInfinity), normal_cdf(x));
        EXPECT_NEAR(student_t_cdf(x, 1e13), normal_cdf(x), 1e-9 * normal_cdf(x));
    }
    EXPECT_EQ(student_t_quantile(0.05, std::nullopt), normal_quantile(0.05));
}

TEST(StudentT, GivesTheTabulatedQuantilesAndTheirProbabilities) {
    // [GUM] table G.2, 95 % and 99 % two-sided.
    EXPECT_NEAR(student_t_quantile(0.975, 1.0), 12.71, 0.005);
    EXPECT_NEAR(student_t_quantile(0.975, 3.0), 3.18, 0.005);
    EXPECT_NEAR(student_t_quantile(0.975, 10.0), 2.23, 0.005);
    EXPECT_NEAR(student_t_quantile(0.995, 5.0), 4.03, 0.005);
    for (const double degrees : {1.0, 2.5, 3.0, 12.0, 1e6})
        for (const double p : {1e-9, 0.01, 0.05, 0.5, 0.9, 0.999}) {
            EXPECT_NEAR(student_t_cdf(student_t_quantile(p, degrees), degrees), p, 1e-9 * p);
        }
}

TEST(StudentT, HasItsEndsAndRefusesTheRest) {
    EXPECT_EQ(student_t_cdf(kInfinity, 3.0), 1.0);
    EXPECT_EQ(student_t_cdf(-kInfinity, 3.0), 0.0);
    EXPECT_THROW(student_t_cdf(kNaN, 3.0), Failure);
    for (const double degrees : {0.0, -1.0, kNaN}) {
        EXPECT_THROW(student_t_cdf(1.0, degrees), Failure);
        EXPECT_THROW(student_t_quantile(0.95, degrees), Failure);
    }
    for (const double probability : {0.0, 1.0, kNaN}) {
        EXPECT_THROW(student_t_quantile(probability, 3.0), Failure);
        EXPECT_THROW(student_t_quantile(probability, std::nullopt), Failure);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
