#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/monte_carlo.h"
#include "core/random.h"

// What is drawn and counted in blocks, or by shorter ways, against the plain form.

namespace runcert::RUNCERT_FILE {
namespace {

TEST(FastDraws, NormalsAreWhatSoManySingleCallsGive) {
    RandomGenerator block(11);
    RandomGenerator single(11);
    // Odd counts leave a spare number for the next call, whichever that is.
    for (const std::size_t count : {0U, 1U, 2U, 3U, 255U, 256U, 257U, 1000U, 100'001U}) {
        for (const double number : block.normals(count))
            ASSERT_EQ(number, single.normal()) << count;
        ASSERT_EQ(block.normal(), single.normal()) << count;
    }
    EXPECT_EQ(block.next(), single.next());
}

/// The polar method with the logarithm as its series has it, from std::frexp.
double plain_normal_factor(double square) {
    int exponent = 0;
    double m = std::frexp(square, &exponent);
    if (m < std::numbers::sqrt2 / 2) {
        m *= 2.0;
        --exponent;
    }
    const double s = (m - 1.0) / (m + 1.0);
    double series = 0.0;
    for (int k = 10; k >= 0; --k)
        series = series * (s * s) + 1.0 / (2 * k + 1);
    return std::sqrt(-2.0 * (exponent * std::numbers::ln2 + 2.0 * s * series) / square);
}

TEST(FastDraws, NormalsAreThoseOfThePlainPolarMethod) {
    RandomGenerator random(5);
    RandomGenerator uniform(5);
    const std::vector<double> numbers = random.normals(20'000);
    for (std::size_t i = 0; i < numbers.size();) {
        const double x = 2.0 * uniform.uniform() - 1.0;
        const double y = 2.0 * uniform.uniform() - 1.0;
        const double square = x * x + y * y;
        if (square >= 1.0 || square == 0.0) continue;
        ASSERT_EQ(numbers[i++], x * plain_normal_factor(square));
        ASSERT_EQ(numbers[i++], y * plain_normal_factor(square));
    }
}

/// Student's t by the quotient of the densities, term by term.
double plain_student_t(RandomGenerator& random, double nu) {
    while (true) {
        const double x = 2.0 * random.uniform() - 1.0;
        const double y = 2.0 * random.uniform() - 1.0;
        if (x * x + y * y >= 1.0 || y == 0.0) continue;
        const double square = (x / y) * (x / y);
        const double log_acceptance =
            std::log((1.0 + square) / 2.0) -
            (nu + 1.0) / 2.0 * (std::log1p(square / nu) - std::log1p(1.0 / nu));
        if (std::log(random.uniform()) <= log_acceptance) return x / y;
    }
}

TEST(FastDraws, StudentsTAreThoseOfThePlainRejection) {
    for (const double nu : {1.0, 1.5, 4.0, 60.0, 25'826.45, 1e9, 1e14, 1e17}) {
        RandomGenerator fast(3);
        RandomGenerator plain(3);
        for (int i = 0; i < 20'000; ++i)
            ASSERT_EQ(draw_student_t(fast, nu), plain_student_t(plain, nu)) << nu;
    }
}

TEST(FastDraws, IntervalsAreThoseOfAllValuesSorted) {
    for (const double probability : {0.3, 0.5, 0.68, 0.95, 0.99}) {
        const MonteCarloOptions options{
            .seed = 8, .trials_max = 300'000, .probability = probability};
        // Skew, so that the shortest interval is not the symmetric one; and with many equal values.
        const auto draw = [](RandomGenerator& random) {
            return std::floor(1000.0 * std::exp(0.5 * random.normal())) / 1000.0;
        };
        const MonteCarloResult result = propagate(options, draw);
        RandomGenerator random(options.seed);
        std::vector<double> all(static_cast<std::size_t>(result.trials));
        for (double& value : all)
            value = draw(random);
        std::sort(all.begin(), all.end());
        const CoverageInterval symmetric = symmetric_interval(all, probability);
        const CoverageInterval shortest = shortest_interval(all, probability);
        EXPECT_EQ(result.symmetric.lower, symmetric.lower) << probability;
        EXPECT_EQ(result.symmetric.upper, symmetric.upper) << probability;
        EXPECT_EQ(result.shortest.lower, shortest.lower) << probability;
        EXPECT_EQ(result.shortest.upper, shortest.upper) << probability;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
