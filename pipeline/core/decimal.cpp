#include "core/decimal.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

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
    if (plain && plain->whole <= 9 && plain->decimals <= 9) {  // below 10^18, which fits 64 bits
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

namespace {

constexpr int digits_at_once = 8;
constexpr std::uint32_t eight_digits_end = 100'000'000;
constexpr int most_decimals = 12;
/// Doubles below this limit have steps of at most 0.5, so that whole part and remainder are exact.
constexpr double whole_limit = 0x1p52;

/// The eight digits of a number below 10^8, the first in the lowest byte, as values 0 to 9. All are
/// computed at once, in lanes of one register: halves of four digits, then pairs, then digits. The
/// factors are rounded reciprocals of 100 and 10, exact for numbers below 10^4 and 10^2.
std::uint64_t eight_digits(std::uint32_t number) {
    std::uint64_t lanes = number / 10'000 | std::uint64_t{number % 10'000} << 32;
    const std::uint64_t hundreds = (lanes * 10'486 >> 20) & 0x0000'007f'0000'007f;
    lanes = hundreds | (lanes - hundreds * 100) << 16;
    const std::uint64_t tens = (lanes * 103 >> 10) & 0x000f'000f'000f'000f;
    return tens | (lanes - tens * 10) << 8;
}

int leading_zeros(std::uint64_t digits) {
    return digits == 0 ? digits_at_once : std::countr_zero(digits) / 8;
}

/// Sixteen digits as values 0 to 9, the first in the lowest byte.
using Digits = unsigned __int128;

void put(char* to, Digits digits) {
    for (int i = 0; i < 2; ++i, digits >>= 64, to += digits_at_once) {
        std::uint64_t text = static_cast<std::uint64_t>(digits) + 0x3030'3030'3030'3030;
        if constexpr (std::endian::native == std::endian::big) text = __builtin_bswap64(text);
        std::memcpy(to, &text, sizeof text);
    }
}

}  // namespace

char* write_scaled(char* to, std::uint64_t count, int decimals, bool negative) {
    constexpr int all = 2 * digits_at_once;
    const std::uint64_t high = eight_digits(static_cast<std::uint32_t>(count / eight_digits_end));
    const std::uint64_t low = eight_digits(static_cast<std::uint32_t>(count % eight_digits_end));
    const Digits digits = Digits{low} << 64 | high;
    int zeros = leading_zeros(high);
    if (zeros == digits_at_once) zeros += leading_zeros(low);
    const int first = std::min(zeros, all - decimals - 1);
    if (negative) *to++ = '-';
    // Storing all sixteen bytes is quicker than storing only those needed, which is why the buffer
    // has spare room. The digits stay in registers until then, because a load that overlaps a
    // recent store in part is slow.
    put(to, digits >> (8 * first));
    to += all - decimals - first;
    if (decimals == 0) return to;
    *to++ = '.';
    put(to, digits >> (8 * (all - decimals)));
    return to + decimals;
}

char* write_fixed_quickly(char* to, double value, int decimals) {
    if (decimals < 0 || decimals > most_decimals) return nullptr;
    const double scaled = std::abs(value) * exact_powers_of_ten[static_cast<std::size_t>(decimals)];
    if (!(scaled < whole_limit)) return nullptr;
    const auto whole = static_cast<std::int64_t>(scaled);
    const double rest = scaled - static_cast<double>(whole);
    // The product is off by at most half a unit in its last place. This matters only where it could
    // carry the remainder across one half, exact ties included.
    if (std::abs(rest - 0.5) <= scaled * 0x1p-52) return nullptr;
    const auto count = static_cast<std::uint64_t>(whole) + (rest > 0.5 ? 1 : 0);
    return write_scaled(to, count, decimals, std::signbit(value) && count != 0);
}

}  // namespace runcert
