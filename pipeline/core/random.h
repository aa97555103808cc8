#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace runcert {

/// One step of SplitMix64 (Steele, Lea & Flood 2014; S. Vigna's splitmix64.c): advances `state`
/// and returns the next number. Used to spread a seed over a larger state.
std::uint64_t splitmix64(std::uint64_t& state);

/// The generator xoshiro256** 1.0 (Blackman & Vigna 2021, "Scrambled linear pseudorandom number
/// generators", ACM TOMS 47(4)). The state must not be all zero.
struct Xoshiro256StarStar {
    std::array<std::uint64_t, 4> state;

    std::uint64_t next();
};

/// Seeded random numbers, the same on every platform: integer arithmetic, and for the rest only
/// operations that IEEE 754 rounds correctly (the C library's logarithm is not one of them).
class RandomGenerator {
  public:
    /// The state is four numbers of `splitmix64` started at `seed`; every seed is good.
    explicit RandomGenerator(std::uint64_t seed);

    /// 64 random bits.
    std::uint64_t next() { return bits_.next(); }

    /// Uniform in (0, 1), both ends excluded, in steps of 2^-52.
    double uniform();

    /// Standard normal, by Marsaglia's polar method (Marsaglia & Bray 1964).
    double normal();

  private:
    Xoshiro256StarStar bits_;
    std::optional<double> spare_normal_;  // the method makes them in pairs
};

}  // namespace runcert
