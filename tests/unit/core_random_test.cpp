#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/random.h"
#include "core/statistics.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(SplitMix64, GivesThePublishedNumbers) {
    // Outputs of S. Vigna's splitmix64.c for the seed 1234567, as many test suites print them.
    std::uint64_t state = 1234567;
    for (const std::uint64_t expected :
         {6457827717110365317U, 3203168211198807973U, 9817491932198370423U, 4593380528125082431U,
          16408922859458223821U})
        EXPECT_EQ(splitmix64(state), expected);
}

TEST(Xoshiro256StarStar, GivesThePublishedNumbers) {
    // Outputs of D. Blackman and S. Vigna's xoshiro256starstar.c for the state 1, 2, 3, 4.
    Xoshiro256StarStar generator{{1, 2, 3, 4}};
    for (const std::uint64_t expected : {11520U, 0U, 1509978240U})
        EXPECT_EQ(generator.next(), expected);
    for (const std::uint64_t expected :
         {1215971899390074240U, 1216172134540287360U, 607988272756665600U, 16172922978634559625U,
          8476171486693032832U, 10595114339597558777U, 2904607092377533576U})
        EXPECT_EQ(generator.next(), expected);
}

TEST(RandomGenerator, IsSeededBySplitMix64) {
    std::uint64_t seed = 42;
    Xoshiro256StarStar reference{};
    for (std::uint64_t& word : reference.state)
        word = splitmix64(seed);
    RandomGenerator random(42);
    for (int i = 0; i < 100; ++i)
        EXPECT_EQ(random.next(), reference.next());
    EXPECT_NE(RandomGenerator(0).next(), RandomGenerator(1).next());
}

TEST(RandomGenerator, UniformHasTheMomentsAndEnds) {
    RandomGenerator random(3);
    constexpr int count = 1'000'000;
    std::vector<double> values(count);
    for (double& value : values) {
        value = random.uniform();
        ASSERT_GT(value, 0.0);
        ASSERT_LT(value, 1.0);
    }
    // Five standard errors.
    EXPECT_NEAR(mean(values), 0.5, 5 * std::sqrt(1.0 / 12 / count));
    EXPECT_NEAR(standard_deviation(values), std::sqrt(1.0 / 12), 1e-3);
}

TEST(RandomGenerator, NormalHasTheMoments) {
    RandomGenerator random(4);
    constexpr int count = 1'000'000;
    double sums[5] = {};
    int beyond_two = 0;
    double lag_one = 0.0;
    double previous = 0.0;
    for (int i = 0; i < count; ++i) {
        const double z = random.normal();
        double power = 1.0;
        for (double& sum : sums) {
            sum += power;
            power *= z;
        }
        if (std::abs(z) > 2.0) ++beyond_two;
        lag_one += z * previous;
        previous = z;
    }
    // Five standard errors: those of the moments are sqrt(1, 2, 15, 96) / sqrt(n).
    const double error = 5 / std::sqrt(count);
    EXPECT_NEAR(sums[1] / count, 0.0, error);
    EXPECT_NEAR(sums[2] / count, 1.0, error * std::sqrt(2.0));
    EXPECT_NEAR(sums[3] / count, 0.0, error * std::sqrt(15.0));
    EXPECT_NEAR(sums[4] / count, 3.0, error * std::sqrt(96.0));
    EXPECT_NEAR(lag_one / count, 0.0, error);
    const double tail = 2.0 * normal_cdf(-2.0);
    EXPECT_NEAR(beyond_two / static_cast<double>(count), tail, error * std::sqrt(tail));
}

TEST(RandomGenerator, NormalIsThePolarMethod) {
    // Against the C library's logarithm, whose last bit may differ.
    RandomGenerator random(5);
    RandomGenerator same(5);
    for (int i = 0; i < 10'000; ++i) {
        double x = 0.0;
        double y = 0.0;
        double square = 0.0;
        do {
            x = 2.0 * same.uniform() - 1.0;
            y = 2.0 * same.uniform() - 1.0;
            square = x * x + y * y;
        } while (square >= 1.0);
        const double factor = std::sqrt(-2.0 * std::log(square) / square);
        // The logarithm of a number near 1 is small: compared relative to itself.
        EXPECT_NEAR(random.normal(), x * factor, 2e-15 * std::abs(x * factor));
        EXPECT_NEAR(random.normal(), y * factor, 2e-15 * std::abs(y * factor));
    }
}

TEST(RandomGenerator, NormalsAreTheSameBitsEverywhere) {
    RandomGenerator random(2022);
    std::uint64_t hash = 0;
    for (int i = 0; i < 1000; ++i)
        hash = std::rotl(hash, 5) ^ std::bit_cast<std::uint64_t>(random.normal());
    EXPECT_EQ(hash, 964576613804845731U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
