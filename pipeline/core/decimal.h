#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace runcert {

/// Seconds written as a decimal number ("12.3", "-0.05", "7"), as an exact count of nanoseconds.
///
/// Digits after the ninth decimal must be zero. Returns nothing for any other text: blanks, an
/// exponent, or a value beyond the 64-bit count (292 years).
std::optional<std::int64_t> parse_decimal_nanoseconds(std::string_view text);

/// Gives the same result as parse_decimal_nanoseconds, without its fast path for common texts.
std::optional<std::int64_t> parse_any_decimal_nanoseconds(std::string_view text);

/// A decimal number in the form that tables and recordings nearly always use: `digits` times ten to
/// the power of minus `decimals`.
struct PlainDecimal {
    std::uint64_t digits = 0;
    int decimals = 0;  ///< digits after the point
    int whole = 0;     ///< digits before the point
    bool negative = false;
};

/// Powers of ten that a double holds exactly, up to the largest that a PlainDecimal needs.
inline constexpr std::array<double, 19> exact_powers_of_ten{
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8, 1e9,
    1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18};

/// Reads an optional sign followed by 1 to 18 digits with at most one point among them, in one
/// pass. Returns nothing for any other text, which may still be a number.
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

/// Bytes that the output buffer of the functions below must hold. They may write beyond the end
/// that they return.
inline constexpr std::size_t fixed_text_room = 48;

/// Counts below this limit have at most 16 digits.
inline constexpr std::uint64_t fixed_text_limit = 10'000'000'000'000'000;

/// Writes `count` times ten to the power of minus `decimals`, exactly: 1250, 3 and `negative` give
/// "-1.250". `count` must be below fixed_text_limit and `decimals` 0 to 12, which is not checked.
/// Returns the end of the text; no zero byte is written.
char* write_scaled(char* to, std::uint64_t count, int decimals, bool negative);

/// Writes a number as format_fixed (core/text.h) does, and returns the end of the text. Returns
/// null if this fast path cannot be sure of the last digit: the number lies too near the middle
/// between two neighbours, is large (2^52 or more in units of the last decimal) or not finite, or
/// `decimals` is not 0 to 12. A value that rounds to zero has no minus sign.
char* write_fixed_quickly(char* to, double value, int decimals);

}  // namespace runcert
