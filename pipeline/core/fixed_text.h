#pragma once

#include <cstddef>
#include <cstdint>

namespace runcert {

/// The room, in bytes, that the functions below may write to, beyond what they return.
inline constexpr std::size_t fixed_text_room = 48;

/// Below this a count has at most 16 digits.
inline constexpr std::uint64_t fixed_text_limit = 10'000'000'000'000'000;

/// Writes `count` times ten to the power of minus `decimals`: "-1.250" for 1250, 3 and `negative`.
/// `count` is below fixed_text_limit, `decimals` 0 to 12; neither is checked. Exact. Returns the
/// end of the text, which no zero byte follows.
char* write_scaled(char* to, std::uint64_t count, int decimals, bool negative);

/// Writes a number as format_fixed (core/text.h) does, or returns null where this quick way cannot
/// be sure of the last digit: where the number lies too near the middle between two neighbours, is
/// large (2^52 or more in units of the last decimal) or not finite, or where `decimals` is not 0 to
/// 12. What rounds to zero has no minus sign. Returns the end of the text.
char* write_fixed_quickly(char* to, double value, int decimals);

}  // namespace runcert
