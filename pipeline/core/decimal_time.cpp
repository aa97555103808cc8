#include "core/decimal_time.h"

namespace runcert {
namespace {

constexpr std::int64_t per_second = 1'000'000'000;
constexpr std::int64_t max_seconds = 9'000'000'000;

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

}  // namespace

std::optional<std::int64_t> parse_decimal_nanoseconds(std::string_view text) {
    bool negative = false;
    if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
        negative = text.front() == '-';
        text.remove_prefix(1);
    }
    std::int64_t seconds = 0;
    std::size_t digits = 0;
    while (!text.empty() && is_digit(text.front())) {
        seconds = seconds * 10 + (text.front() - '0');
        if (seconds > max_seconds) return std::nullopt;
        text.remove_prefix(1);
        ++digits;
    }
    std::int64_t nanoseconds = 0;
    if (!text.empty() && text.front() == '.') {
        text.remove_prefix(1);
        std::int64_t scale = per_second / 10;
        for (; !text.empty() && is_digit(text.front()); text.remove_prefix(1), ++digits) {
            if (scale == 0 && text.front() != '0') return std::nullopt;
            nanoseconds += scale * (text.front() - '0');
            scale /= 10;
        }
    }
    if (digits == 0 || !text.empty()) return std::nullopt;
    const std::int64_t total = seconds * per_second + nanoseconds;
    return negative ? -total : total;
}

}  // namespace runcert
