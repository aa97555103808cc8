#pragma once

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

}  // namespace runcert
