#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace runcert {

/// Seconds written as a decimal number ("12.3", "-0.05", "7"), as an exact count of nanoseconds.
///
/// Digits after the ninth decimal must be zero. Nothing if the text is anything else (blanks, an
/// exponent, a value beyond the 64-bit count: 292 years).
std::optional<std::int64_t> parse_decimal_nanoseconds(std::string_view text);

/// The same, the plain way for every text: parse_decimal_nanoseconds has a quicker one for most.
std::optional<std::int64_t> parse_any_decimal_nanoseconds(std::string_view text);

/// A decimal number as tables and recordings write nearly all of theirs: `digits` times ten to the
/// power of minus `decimals`.
struct PlainDecimal {
    std::uint64_t digits = 0;
    int decimals = 0;  ///< digits after the point
    int whole = 0;     ///< digits before it
    bool negative = false;
};

/// The powers of ten that a double holds exactly and that a PlainDecimal can need.
inline constexpr std::array<double, 19> exact_powers_of_ten{
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
    1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};

/// Reads a text that is an optional sign, then 1 to 18 digits with at most one point among them, in
/// one pass; nothing for any other text, which may still be a number.
inline std::optional<PlainDecimal> read_plain_decimal(std::string_view text) {
    const char* at = text.data();
    const char* const end = at + text.size();
    PlainDecimal number;
    if (at != end && (*at == '-' || *at == '+')) number.negative = *at++ == '-';
    if (end - at > 19) return std::nullopt;  // before anything can overflow
    const auto take_digits = [&] {
        const char* const first = at;
        for (; at != end && *at >= '0' && *at <= '9'; ++at)
            number.digits = number.digits * 10 + static_cast<std::uint64_t>(*at - '0');
        return static_cast<int>(at - first);
    };
    number.whole = take_digits();
    if (at != end && *at == '.') {
        ++at;
        number.decimals = take_digits();
    }
    const int count = number.whole + number.decimals;
    if (at != end || count == 0 || count > 18) return std::nullopt;
    return number;
}

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
