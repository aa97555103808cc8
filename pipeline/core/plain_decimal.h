#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace runcert {

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

}  // namespace runcert
