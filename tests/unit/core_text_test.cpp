#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/claimed_text.h"
#include "core/text.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(ParseDouble, ReadsDecimalNumbers) {
    const struct {
        const char* text;
        double value;
    } cases[] = {
        {"0", 0.0},
        {"-0.0", -0.0},
        {"+3.5", 3.5},
        {"-3.5", -3.5},
        {"136.977574275", 136.977574275},
        {".5", 0.5},
        {"5.", 5.0},
        {"1e3", 1000.0},
        {"1E-3", 0.001},
        {"2.5e+2", 250.0},
        {"007", 7.0},
        {"0e999", 0.0},
        {"1.7976931348623157e308", std::numeric_limits<double>::max()},
        {"4.9406564584124654e-324", std::numeric_limits<double>::denorm_min()},
    };
    for (const auto& c : cases) {
        const auto value = parse_double(c.text);
        ASSERT_TRUE(value.has_value()) << c.text;
        EXPECT_EQ(*value, c.value) << c.text;
    }
    EXPECT_TRUE(std::signbit(parse_double("-0.0").value()));
}

TEST(ParseDouble, RefusesEverythingElse) {
    for (const char* text :
         {"",       "+",           "-",    ".",     "+-1",   "-+1", "--1",   "++1",
          " 1",     "1 ",          "1,5",  "1.5.2", "nan",   "NaN", "-nan",  "inf",
          "-inf",   "infinity",    "0x10", "1e",    "1e+",   "e5",  "1e309", "-1e309",
          "1e-400", "0.0001e-400", "12m",  "1_000", "1'000", "١"})
        EXPECT_FALSE(parse_double(text).has_value()) << text;
    EXPECT_FALSE(parse_double(std::string_view("1\0", 2)).has_value());
}

TEST(ParseInteger, ReadsWholeNumbersOnly) {
    EXPECT_EQ(parse_integer("0"), 0);
    EXPECT_EQ(parse_integer("+42"), 42);
    EXPECT_EQ(parse_integer("-42"), -42);
    EXPECT_EQ(parse_integer("9223372036854775807"), std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ(parse_integer("-9223372036854775808"), std::numeric_limits<std::int64_t>::min());
    for (const char* text : {"", "+", "-", "+-1", "-+1", " 1", "1 ", "1.0", "1e3", "0x1",
                             "9223372036854775808", "-9223372036854775809"})
        EXPECT_FALSE(parse_integer(text).has_value()) << text;
}

TEST(Trim, TakesBlanksOffBothEnds) {
    EXPECT_EQ(trim(" \t a b\r\n"), "a b");
    EXPECT_EQ(trim(" \r\n "), "");
    EXPECT_EQ(trim(""), "");
    EXPECT_EQ(trim("x"), "x");
}

TEST(FormatFixed, RoundsAndHasNoNegativeZero) {
    EXPECT_EQ(format_fixed(60.00049, 3), "60.000");
    EXPECT_EQ(format_fixed(60.0005001, 3), "60.001");
    EXPECT_EQ(format_fixed(-0.0004, 3), "0.000");
    EXPECT_EQ(format_fixed(-0.0006, 3), "-0.001");
    EXPECT_EQ(format_fixed(-0.0, 0), "0");
    EXPECT_EQ(format_fixed(-0.4, 0), "0");
    EXPECT_EQ(format_fixed(-100.0, 0), "-100");
    EXPECT_EQ(format_fixed(1e15, 1), "1000000000000000.0");
    EXPECT_EQ(format_fixed(0.5, 0), "0");  // halves that doubles hold exactly go to even
    EXPECT_EQ(format_fixed(1.5, 0), "2");
}

TEST(FormatFixed, RoundTripsWithEnoughDecimals) {
    for (const double value : {35.134709483, -136.977574275, 104.728, 1e-9, 12345678.123456789})
        EXPECT_EQ(parse_double(format_fixed(value, 20)), value);
}

TEST(Nearest, FindsTheSmallestEditDistance) {
    const std::vector<std::string_view> names = {"rtklib-pos", "csv", "nmea", "ubx", "vbo"};
    EXPECT_EQ(nearest("rtklib_pos", names), "rtklib-pos");
    EXPECT_EQ(nearest("nmae", names), "nmea");
    EXPECT_EQ(nearest("ub", names), "ubx");
    EXPECT_EQ(nearest("", names), "csv");
    EXPECT_EQ(nearest("vbx", names), "ubx");  // as near as vbo, and earlier
    EXPECT_EQ(nearest("x", {}), "");
    const std::string_view columns[] = {"Date", "Altitude", "Alt(m)", "GAlt"};
    EXPECT_EQ(nearest("Alt", columns), "Alt(m)");  // the shortest that begins so
    EXPECT_EQ(nearest("alti", columns), "Altitude");
    EXPECT_EQ(nearest("Dote", columns), "Date");
}

TEST(Escape, QuotesAnyBytes) {
    EXPECT_EQ(escape_for_message("2022-03-18"), "2022-03-18");
    EXPECT_EQ(escape_for_message(std::string_view("a\0\x1b[1m\xff\n", 8)),
              "a\\x00\\x1b[1m\\xff\\x0a");
    EXPECT_EQ(escape_for_message(std::string(41, 'a')), std::string(40, 'a') + "...");
    EXPECT_EQ(escape_for_message(std::string(40, 'a')), std::string(40, 'a'));
    EXPECT_EQ(escape_for_message("abcdef", 3), "abc...");
    EXPECT_TRUE(is_printable_ascii("a ~"));
    EXPECT_TRUE(is_printable_ascii(""));
    EXPECT_FALSE(is_printable_ascii("a\tb"));
    EXPECT_FALSE(is_printable_ascii("\x7f"));
    EXPECT_FALSE(is_printable_ascii("\xc3\xa9"));
}

TEST(HiddenCharacter, IsAnyThatUnicodeCallsDefaultIgnorable) {  // some were shown as nothing
    for (const char* one :
         {"\u00AD", "\u034F", "\u061C", "\u115F",     "\u17B4",     "\u180B",     "\u180F",
          "\u200B", "\u200D", "\u2060", "\u206F",     "\u3164",     "\uFE00",     "\uFE0F",
          "\uFEFF", "\uFFA0", "\uFFF0", "\U0001BCA0", "\U0001D173", "\U000E0001", "\U000E0FFF"}) {
        EXPECT_TRUE(hidden_character(std::string("a") + one)) << one;
        EXPECT_EQ(plain_text(one), "\uFFFD") << one;
    }
    for (const char* one :
         {"\u00AC", "\u00AE", "\u2010", "\u2070", "\u3165", "\U0001F600", "\u0301"})
        EXPECT_FALSE(hidden_character(one)) << one;
}

TEST(Claimed, IsInQuotationMarksThatNothingInItCloses) {
    EXPECT_EQ(claimed("Greenbird"), "“Greenbird”");
    EXPECT_EQ(claimed(""), "");
    EXPECT_EQ(claimed("a” beaten \"b\" «c» “d"), "“a' beaten 'b' 'c' 'd”");
    EXPECT_EQ(claimed_value("202.9"), "202.9");
    EXPECT_EQ(claimed_value("land-yacht"), "land-yacht");
    EXPECT_EQ(claimed_value("a newspaper"), "“a newspaper”");
    EXPECT_EQ(claimed_value("0.010 m"), "0.010 m");
    EXPECT_EQ(claimed_value("0.010 m by far"), "“0.010 m by far”");
    EXPECT_EQ(claimed_value("✓"), "“✓”");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
