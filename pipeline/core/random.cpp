#include "core/random.h"

#include <bit>
#include <cmath>
#include <numbers>

namespace runcert {

namespace {

/// Natural logarithm of a normal positive number, to 2 ulp, of basic operations only.
///
/// x = 2^e m with m in [sqrt(1/2), sqrt(2)); log m = 2 atanh(s), s = (m - 1) / (m + 1), |s| <
/// 0.172, so 11 terms of s^(2k) / (2k + 1) leave less than 1e-17.
double portable_log(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);
    if (m < std::numbers::sqrt2 / 2) {
        m *= 2.0;
        --exponent;
    }
    const double s = (m - 1.0) / (m + 1.0);
    const double square = s * s;
    double series = 0.0;
    for (int k = 10; k >= 0; --k)
        series = series * square + 1.0 / (2 * k + 1);
    return exponent * std::numbers::ln2 + 2.0 * s * series;
}

}  // namespace

std::uint64_t splitmix64(std::uint64_t& state) {
    state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
}

std::uint64_t Xoshiro256StarStar::next() {
    const std::uint64_t result = std::rotl(state[1] * 5, 7) * 9;
    const std::uint64_t shifted = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= shifted;
    state[3] = std::rotl(state[3], 45);
    return result;
}

RandomGenerator::RandomGenerator(std::uint64_t seed) : bits_{} {
    for (std::uint64_t& word : bits_.state)
        word = splitmix64(seed);
}

double RandomGenerator::uniform() {
    // 52 bits and a half: with 53 the largest would round to 1.
    return (static_cast<double>(next() >> 12) + 0.5) * 0x1p-52;
}

double RandomGenerator::normal() {
    if (spare_normal_) {
        const double spare = *spare_normal_;
        spare_normal_.reset();
        return spare;
    }
    double x = 0.0;
    double y = 0.0;
    double square = 0.0;
    do {
        x = 2.0 * uniform() - 1.0;
        y = 2.0 * uniform() - 1.0;
        square = x * x + y * y;
    } while (square >= 1.0 || square == 0.0);
    const double factor = std::sqrt(-2.0 * portable_log(square) / square);
    spare_normal_ = y * factor;
    return x * factor;
}

}  // namespace runcert
