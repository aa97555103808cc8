#include "core/random.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace runcert {

namespace {

/// A positive normal number as 2^exponent times a number in [sqrt(1/2), sqrt(2)).
struct Parts {
    double exponent = 0.0;
    double number = 1.0;
};

Parts parts_of(double x) {
    // Branch-free: half of all numbers would take the branch.
    constexpr std::uint64_t fraction_bits = (std::uint64_t{1} << 52) - 1;
    constexpr std::uint64_t exponent_of_half = 1022;
    constexpr std::uint64_t fraction_of_root =
        std::bit_cast<std::uint64_t>(std::numbers::sqrt2 / 2) & fraction_bits;
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t fraction = bits & fraction_bits;
    const auto low = static_cast<std::uint64_t>(fraction < fraction_of_root);
    const auto exponent =
        static_cast<std::int64_t>(bits >> 52) - static_cast<std::int64_t>(exponent_of_half + low);
    return {static_cast<double>(exponent),
            std::bit_cast<double>(fraction | ((exponent_of_half + low) << 52))};
}

/// Natural logarithm of a normal positive number, to 2 ulp, by basic operations only.
///
/// x = 2^e m with m in [sqrt(1/2), sqrt(2)); log m = 2 atanh(s), s = (m - 1) / (m + 1),
/// |s| < 0.172, so 11 terms of s^(2k) / (2k + 1) leave less than 1e-17.
double portable_log(const Parts& x) {
    const double s = (x.number - 1.0) / (x.number + 1.0);
    const double square = s * s;
    double series = 0.0;
    for (int k = 10; k >= 0; --k)
        series = series * square + 1.0 / (2 * k + 1);
    return x.exponent * std::numbers::ln2 + 2.0 * s * series;
}

/// A point that is uniform in the square around the unit disc.
struct Point {
    double x = 0.0;
    double y = 0.0;
    double square = 0.0;  ///< squared distance from the centre

    /// Whether the point lies strictly inside the disc and is not its centre. One comparison of
    /// bits suffices: the bits of non-negative numbers have the order of the numbers, and zero
    /// becomes the largest.
    bool in_disc() const {
        return std::bit_cast<std::uint64_t>(square) - 1 < std::bit_cast<std::uint64_t>(1.0) - 1;
    }
};

inline Point next_point(Xoshiro256StarStar& bits) {
    // Two statements, because the compiler may choose the order in which it evaluates operands.
    Point point;
    point.x = 2.0 * uniform_of(bits) - 1.0;
    point.y = 2.0 * uniform_of(bits) - 1.0;
    point.square = point.x * point.x + point.y * point.y;
    return point;
}

/// The factor of the polar method for both coordinates of a point in the unit disc.
double polar_factor(double square, const Parts& parts) {
    return std::sqrt(-2.0 * portable_log(parts) / square);
}

template <std::size_t N>
std::array<double, N> polar_factors(const std::array<double, N>& square) {
    std::array<double, N> exponent, number, factor;
    for (std::size_t i = 0; i < N; ++i) {
        const Parts parts = parts_of(square[i]);
        exponent[i] = parts.exponent;
        number[i] = parts.number;
    }
    for (std::size_t i = 0; i < N; ++i)
        factor[i] = polar_factor(square[i], {exponent[i], number[i]});
    return factor;
}

}  // namespace

std::uint64_t splitmix64(std::uint64_t& state) {
    state += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31);
}

RandomGenerator::RandomGenerator(std::uint64_t seed) : bits_{} {
    for (std::uint64_t& word : bits_.state)
        word = splitmix64(seed);
}

double RandomGenerator::normal() {
    if (spare_normal_) {
        const double spare = *spare_normal_;
        spare_normal_.reset();
        return spare;
    }
    Point point = next_point(bits_);
    while (!point.in_disc())
        point = next_point(bits_);
    const double factor = polar_factor(point.square, parts_of(point.square));
    spare_normal_ = point.y * factor;
    return point.x * factor;
}

std::vector<double> RandomGenerator::normals(std::size_t count) {
    std::vector<double> numbers(count);
    std::size_t filled = 0;
    if (spare_normal_ && count > 0) numbers[filled++] = normal();
    // Pairs are made in blocks. Points are kept or overwritten without a branch, and the factors of
    // a block do not depend on one another.
    constexpr std::size_t block = 128;
    std::array<double, block> x, y, square;
    Xoshiro256StarStar bits = bits_;
    while (count - filled >= 2) {
        const std::size_t pairs = std::min(block, (count - filled) / 2);
        for (std::size_t kept = 0; kept < pairs;) {
            const Point point = next_point(bits);
            x[kept] = point.x;
            y[kept] = point.y;
            square[kept] = point.square;
            kept += static_cast<std::size_t>(point.in_disc());
        }
        std::fill(square.begin() + static_cast<std::ptrdiff_t>(pairs), square.end(), 0.5);
        const std::array<double, block> factor = polar_factors(square);
        for (std::size_t i = 0; i < pairs; ++i) {
            numbers[filled++] = x[i] * factor[i];
            numbers[filled++] = y[i] * factor[i];
        }
    }
    bits_ = bits;
    if (filled < count) numbers[filled] = normal();
    return numbers;
}

}  // namespace runcert
