#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "core/decimal.h"
#include "core/random.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::int64_t smallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t largest = std::numeric_limits<std::int64_t>::max();

TEST(DecimalNanoseconds, ReadsSecondsExactly) {
    const struct {
        const char* text;
        std::int64_t nanoseconds;
    } cases[] = {
        {"0", 0},
        {"-0", 0},
        {"-0.0", 0},
        {"7", 7'000'000'000},
        {"+7", 7'000'000'000},
        {"12.3", 12'300'000'000},
        {"-0.05", -50'000'000},
        {".5", 500'000'000},
        {"5.", 5'000'000'000},
        {"0.000000001", 1},
        {"-0.000000001", -1},
        {"0.1", 100'000'000},  // no double is 0.1
        {"1331628682.299999999", 1'331'628'682'299'999'999},
        {"1.500000000000000", 1'500'000'000},
        {"000000000000000000000001", 1'000'000'000},
        {"9000000000.000000001", 9'000'000'000'000'000'001},
        {"9223372036.854775807", largest},
        {"-9223372036.854775807", -largest},
        {"-9223372036.854775808", smallest},
    };
    for (const auto& c : cases)
        EXPECT_EQ(parse_decimal_nanoseconds(c.text), c.nanoseconds) << c.text;
}

TEST(DecimalNanoseconds, RefusesEverythingElse) {
    for (const char* text : {"",
                             "+",
                             "-",
                             ".",
                             "-.",
                             "+-1",
                             "--1",
                             " 1",
                             "1 ",
                             "1.2.3",
                             "1,5",
                             "1e3",
                             "1.0e-06",
                             "0x1",
                             "nan",
                             "inf",
                             "12:30",
                             "1s",
                             "1_000",
                             "1.0000000001",
                             "0.1234567891",
                             "9223372036.854775808",
                             "-9223372036.854775809",
                             "9223372037",
                             "-9223372037",
                             "18446744073.709551616",
                             "99999999999999999999999999"})
        EXPECT_FALSE(parse_decimal_nanoseconds(text).has_value()) << text;
    EXPECT_FALSE(parse_decimal_nanoseconds(std::string_view("1\0", 2)).has_value());
}

TEST(DecimalNanoseconds, EveryCountRoundTrips) {
    RandomGenerator random(1);
    for (int i = 0; i < 10'000; ++i) {
        const auto magnitude = random.next() >> (1 + random.next() % 60);
        const bool negative = random.next() % 2 == 0;
        const std::string text = fmt::format("{}{}.{:09}", negative ? "-" : "",
                                             magnitude / 1'000'000'000, magnitude % 1'000'000'000);
        const auto count = static_cast<std::int64_t>(magnitude);
        ASSERT_EQ(parse_decimal_nanoseconds(text), negative ? -count : count) << text;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
