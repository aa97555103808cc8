#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace runcert {

/// One step of SplitMix64 ([SLF14]; S. Vigna's splitmix64.c): advances `state` and returns the next
/// number. Used to expand a seed into a larger state.
std::uint64_t splitmix64(std::uint64_t& state);

/// The generator xoshiro256** 1.0 [BV21]. The state must not be all zero.
struct Xoshiro256StarStar {
    std::array<std::uint64_t, 4> state;

    std::uint64_t next() {
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
};

/// A number uniform in (0, 1) from the next 52 bits of a generator plus half a step. With 53 bits
/// the largest would round to 1.
inline double uniform_of(Xoshiro256StarStar& bits) {
    return (static_cast<double>(static_cast<std::int64_t>(bits.next() >> 12)) + 0.5) * 0x1p-52;
}

/// Seeded random numbers, the same on every platform. It uses integer arithmetic, and otherwise
/// only operations that IEEE 754 rounds correctly. The C library's logarithm is not one of them.
class RandomGenerator {
  public:
    /// The state is the first four numbers of `splitmix64` started at `seed`. Every seed is
    /// suitable.
    explicit RandomGenerator(std::uint64_t seed);

    /// 64 random bits.
    std::uint64_t next() { return bits_.next(); }

    /// Uniform in (0, 1), both ends excluded, in steps of 2^-52.
    double uniform() { return uniform_of(bits_); }

    /// Standard normal, by Marsaglia's polar method (Marsaglia & Bray 1964).
    double normal();

    /// `count` standard normal numbers, bit for bit those that `count` calls of `normal` give,
    /// several times as fast.
    std::vector<double> normals(std::size_t count);

  private:
    Xoshiro256StarStar bits_;
    std::optional<double> spare_normal_;  // the method generates them in pairs
};

}  // namespace runcert
