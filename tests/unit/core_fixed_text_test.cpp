#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/decimal.h"
#include "core/random.h"
#include "core/text.h"

// The quick ways of numbers to and from text against the plain ones.

namespace runcert::RUNCERT_FILE {
namespace {

std::string quickly(double value, int decimals) {
    std::array<char, fixed_text_room> room;
    char* const end = write_fixed_quickly(room.data(), value, decimals);
    return end ? std::string(room.data(), end) : "not sure";
}

/// Numbers as tables hold them, any bit pattern, and neighbours of a middle between two decimals.
double random_number(RandomGenerator& random, int decimals) {
    const double step = std::pow(10.0, -decimals);
    const auto count = static_cast<double>(random.next() >> (11 + random.next() % 53));
    switch (random.next() % 4) {
        case 0:
            return random.normal() * std::pow(10.0, static_cast<double>(random.next() % 9) - 3.0);
        case 1:
            return std::bit_cast<double>(random.next());
        case 2:
            return (random.next() % 2 == 0 ? 1.0 : -1.0) * count * step;
        default:
            break;
    }
    double middle = (count + 0.5) * step;
    for (std::uint64_t n = random.next() % 3; n > 0; --n)
        middle = std::nextafter(middle, random.next() % 2 == 0 ? 0.0 : 1e300);
    return middle;
}

TEST(FixedText, QuickEqualsPlain) {
    RandomGenerator random(20260322);
    std::size_t quick = 0;
    constexpr std::size_t rounds = 3'000'000;
    for (std::size_t i = 0; i < rounds; ++i) {
        const int decimals = static_cast<int>(random.next() % 13);
        const double value = random_number(random, decimals);
        if (!std::isfinite(value)) continue;
        const std::string text = quickly(value, decimals);
        if (text == "not sure") continue;
        ++quick;
        ASSERT_EQ(text, format_any_fixed(value, decimals)) << value << ", " << decimals;
    }
    EXPECT_GT(quick, rounds / 2);  // or it would not be worth having
}

TEST(FixedText, LeavesWhatItCannotBeSureOf) {
    EXPECT_EQ(quickly(0.5, 0), "not sure");
    EXPECT_EQ(quickly(0.125, 2), "not sure");
    EXPECT_EQ(quickly(1e16, 0), "not sure");
    EXPECT_EQ(quickly(1e5, 12), "not sure");
    EXPECT_EQ(quickly(1.0, 13), "not sure");
    EXPECT_EQ(quickly(std::numeric_limits<double>::quiet_NaN(), 3), "not sure");
    EXPECT_EQ(quickly(std::numeric_limits<double>::infinity(), 3), "not sure");
    EXPECT_EQ(quickly(-0.0004, 3), "0.000");
    EXPECT_EQ(quickly(-0.0006, 3), "-0.001");
    EXPECT_EQ(quickly(0x1p50 - 1.0, 0), "1125899906842623");
    EXPECT_EQ(format_fixed(0.125, 2), "0.12");
}

TEST(FixedText, CountsAreWrittenExactly) {
    const auto scaled = [](std::uint64_t count, int decimals, bool negative) {
        std::array<char, fixed_text_room> room;
        return std::string(room.data(), write_scaled(room.data(), count, decimals, negative));
    };
    EXPECT_EQ(scaled(0, 0, false), "0");
    EXPECT_EQ(scaled(0, 9, false), "0.000000000");
    EXPECT_EQ(scaled(1250, 3, true), "-1.250");
    EXPECT_EQ(scaled(fixed_text_limit - 1, 12, true), "-9999.999999999999");
    for (std::uint64_t count = 1; count < fixed_text_limit; count = count * 3 + 1)
        EXPECT_EQ(scaled(count, 0, false), std::to_string(count));
    for (std::uint64_t power = 1; power < fixed_text_limit; power *= 10) {
        EXPECT_EQ(scaled(power, 0, false), std::to_string(power));
        EXPECT_EQ(scaled(power - 1, 0, false), std::to_string(power - 1));
    }
}

/// Texts near those of numbers: digits, signs, points, exponents in any order, mostly the right
/// one.
std::string random_number_text(RandomGenerator& random) {
    if (random.next() % 3 == 0)
        return format_any_fixed(random_number(random, 6), static_cast<int>(random.next() % 13));
    static constexpr std::string_view letters = "0123456789012345678900000000..-+e ";
    std::string text;
    for (std::uint64_t n = random.next() % 24; n > 0; --n)
        text += letters[random.next() % (random.next() % 4 == 0 ? letters.size() : 29)];
    return text;
}

TEST(ParseDouble, QuickEqualsPlain) {
    RandomGenerator random(20260323);
    std::size_t numbers = 0;
    for (int i = 0; i < 2'000'000; ++i) {
        const std::string text = random_number_text(random);
        const auto value = parse_double(text);
        const auto plain = parse_any_double(text);
        ASSERT_EQ(value.has_value(), plain.has_value()) << text;
        if (!value) continue;
        ++numbers;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(*value), std::bit_cast<std::uint64_t>(*plain))
            << text;
    }
    EXPECT_GT(numbers, 1'000'000u);
}

TEST(DecimalNanoseconds, QuickEqualsPlain) {
    RandomGenerator random(20260324);
    std::size_t times = 0;
    for (int i = 0; i < 1'000'000; ++i) {
        const std::string text = random_number_text(random);
        const auto value = parse_decimal_nanoseconds(text);
        ASSERT_EQ(value, parse_any_decimal_nanoseconds(text)) << text;
        times += value ? 1 : 0;
    }
    EXPECT_GT(times, 100'000u);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
