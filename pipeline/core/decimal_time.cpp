#include "core/decimal_time.h"

#include <limits>

#include "core/plain_decimal.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::uint64_t per_second = 1'000'000'000;
constexpr std::uint64_t largest = std::numeric_limits<std::int64_t>::max();

std::uint64_t digit(char c) {
    return static_cast<std::uint64_t>(c - '0');
}

}  // namespace

std::optional<std::int64_t> parse_decimal_nanoseconds(std::string_view text) {
    const auto plain = read_plain_decimal(text);
    if (plain && plain->whole <= 9 && plain->decimals <= 9) {  // below 10^18, which 64 bits hold
        auto nanoseconds = static_cast<std::int64_t>(plain->digits);
        for (int i = plain->decimals; i < 9; ++i)
            nanoseconds *= 10;
        return plain->negative ? -nanoseconds : nanoseconds;
    }
    return parse_any_decimal_nanoseconds(text);
}

std::optional<std::int64_t> parse_any_decimal_nanoseconds(std::string_view text) {
    bool negative = false;
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
        negative = text.front() == '-';
        text.remove_prefix(1);
    }
    std::uint64_t seconds = 0;
    std::size_t digits = 0;
    while (!text.empty() && is_digit(text.front())) {
        seconds = seconds * 10 + digit(text.front());
        if (seconds > largest / per_second) return std::nullopt;
        text.remove_prefix(1);
        ++digits;
    }
    std::uint64_t nanoseconds = 0;
    if (!text.empty() && text.front() == '.') {
        text.remove_prefix(1);
        std::uint64_t scale = per_second / 10;
        for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1), ++digits) {
            if (scale == 0 && text.front() != '0') return std::nullopt;
            nanoseconds += scale * digit(text.front());
            scale /= 10;
        }
    }
    if (digits == 0 || !text.empty()) return std::nullopt;
    const std::uint64_t total = seconds * per_second + nanoseconds;
    if (total > largest + (negative ? 1 : 0)) return std::nullopt;
    return static_cast<std::int64_t>(negative ? 0 - total : total);
}

}  // namespace runcert
