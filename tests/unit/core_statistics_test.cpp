#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(ChiSquared, GivesTheTabulatedQuantiles) {
    // NIST/SEMATECH e-Handbook of Statistical Methods, 1.3.6.7.4, critical values.
    const struct {
        double probability;
        int degrees;
        double expected;
    } cases[] = {
        {0.95, 1, 3.841},     {0.99, 1, 6.635},   {0.999, 1, 10.828},  {0.95, 2, 5.991},
        {0.95, 3, 7.815},     {0.999, 3, 16.266}, {0.95, 10, 18.307},  {0.999, 10, 29.588},
        {0.95, 100, 124.342}, {0.05, 10, 3.940},  {0.01, 100, 70.065},
    };
    for (const auto& c : cases) {
        EXPECT_NEAR(chi_squared_quantile(c.probability, c.degrees), c.expected, 0.0005);
        EXPECT_NEAR(chi_squared_upper_quantile(1.0 - c.probability, c.degrees), c.expected, 0.0005);
    }
}

TEST(ChiSquared, IsExactForTwoDegreesHoweverSmallTheTail) {
    for (const double tail : {0.5, 1e-3, 1e-6, 1e-12, 1e-15, 1e-100, 1e-300}) {
        const double expected = -2.0 * std::log(tail);
        EXPECT_NEAR(chi_squared_upper_quantile(tail, 2), expected, 1e-13 * expected);
    }
}

TEST(ChiSquared, OfOneDegreeIsTheSquareOfANormal) {
    for (const double tail : {0.5, 1e-3, 1e-6, 1e-12, 1e-15, 1e-100}) {
        const double z = normal_quantile(0.5 * tail);
        EXPECT_NEAR(chi_squared_upper_quantile(tail, 1), z * z, 1e-12 * z * z);
    }
    EXPECT_EQ(chi_squared_quantile(0.0, 3), 0.0);
    EXPECT_EQ(chi_squared_upper_quantile(1.0, 3), 0.0);
}

TEST(Normal, GivesKnownQuantiles) {
    EXPECT_NEAR(normal_quantile(0.975), 1.959963984540054, 1e-15);
    EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-16);
    EXPECT_NEAR(normal_quantile(0.75), 0.6744897501960817, 1e-15);
    EXPECT_NEAR(normal_quantile(1e-12), -7.034483825301131, 1e-13);
    for (const double p : {1e-300, 1e-12, 0.01, 0.3, 0.7, 0.99})
        EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-11 * p);
    // [JCGM106]: y = 13.6, u = 1.8, limits 12.5 and 16.3.
    EXPECT_NEAR(normal_cdf((16.3 - 13.6) / 1.8) - normal_cdf((12.5 - 13.6) / 1.8), 0.6626, 5e-5);
}

TEST(Sample, GivesTheCertifiedValues) {
    // NIST StRD univariate: NumAcc1, NumAcc3 (first of its 1001 values 1000000.2, then .1, .3 in
    // turn) have certified means 10000002 and 1000000.2, standard deviations 1 and 0.1.
    const std::vector<double> first = {10000001.0, 10000003.0, 10000002.0};
    EXPECT_EQ(mean(first), 10000002.0);
    EXPECT_EQ(standard_deviation(first), 1.0);
    std::vector<double> third = {1000000.2};
    for (int i = 0; i < 500; ++i)
        third.insert(third.end(), {1000000.1, 1000000.3});
    EXPECT_NEAR(mean(third), 1000000.2, 1e-8);
    EXPECT_NEAR(standard_deviation(third), 0.1, 1e-9);
    EXPECT_NEAR(root_mean_square(std::vector<double>{3.0, -4.0}), std::sqrt(12.5), 1e-15);
}

TEST(Sample, TakesTheMedian) {
    EXPECT_EQ(median({3.0}), 3.0);
    EXPECT_EQ(median({9.0, 1.0, 2.0}), 2.0);
    EXPECT_EQ(median({9.0, 1.0, 2.0, 4.0}), 3.0);
}

TEST(Statistics, RefuseWhatHasNoAnswer) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<double> none;
    EXPECT_THROW(mean(none), Failure);
    EXPECT_THROW(root_mean_square(none), Failure);
    EXPECT_THROW(median(none), Failure);
    EXPECT_THROW(median({1.0, nan}), Failure);
    EXPECT_THROW(standard_deviation(std::vector<double>{1.0}), Failure);
    for (const double p : {-0.1, 1.0, 1.1, nan})
        EXPECT_THROW(chi_squared_quantile(p, 2), Failure);
    for (const double p : {0.0, -0.1, 1.1, nan})
        EXPECT_THROW(chi_squared_upper_quantile(p, 2), Failure);
    EXPECT_THROW(chi_squared_quantile(0.5, 0), Failure);
    for (const double p : {0.0, 1.0, nan})
        EXPECT_THROW(normal_quantile(p), Failure);
}

TEST(Statistics, TheTailOfChiSquaredKeepsItsDigits) {
    // scipy 1.10, scipy.stats.chi2.logsf; beyond its range the closed forms of 2 and 1 degrees of
    // freedom.
    EXPECT_NEAR(log_chi_squared_upper_tail(10.0, 1), -6.45961245415, 1e-10);
    EXPECT_NEAR(log_chi_squared_upper_tail(1199.0, 3), -596.180336788, 1e-8);
    EXPECT_NEAR(log_chi_squared_upper_tail(1201.0, 40), -518.250298318, 1e-8);
    EXPECT_NEAR(log_chi_squared_upper_tail(5000.0, 2), -2500.0, 1e-9);
    EXPECT_NEAR(log_chi_squared_upper_tail(1e6, 1), -500007.133548, 1e-5);
    EXPECT_EQ(log_chi_squared_upper_tail(0.0, 2), 0.0);
    EXPECT_THROW(log_chi_squared_upper_tail(-1.0, 2), Failure);
}

TEST(Statistics, BaardasNoncentrality) {
    // 17.075 for a size of 0.001 and a power of 0.80 (Baarda 1968, "A testing procedure for use in
    // geodetic networks").
    EXPECT_NEAR(noncentrality(0.001, 0.80, 1), 17.075, 5e-4);
    // scipy 1.10, scipy.stats.ncx2.
    EXPECT_NEAR(noncentrality(1e-9, 0.8, 2), 51.92467616587213, 1e-8);
    EXPECT_THROW(noncentrality(0.5, 0.4, 1), Failure);
    EXPECT_THROW(noncentrality(0.0, 0.4, 1), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
