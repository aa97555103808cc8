#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>

#include "core/failure.h"
#include "core/gps_time.h"
#include "core/random.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::int64_t second_ns = GpsTime::nanoseconds_per_second;
constexpr std::int64_t smallest = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t largest = std::numeric_limits<std::int64_t>::max();

static_assert(GpsTime::from_nanoseconds(-1).week() == -1);
static_assert(GpsTime::from_nanoseconds(-1).nanoseconds_of_week() ==
              GpsTime::nanoseconds_per_week - 1);

/// The problem that parsing a text reports.
std::string problem_of(std::string_view text) {
    try {
        parse_gps_iso(text);
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), "time");
        return failure.problem();
    }
    return "none";
}

bool contains(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

TEST(GpsTime, CountsWeeksFromTheEpoch) {
    // The two rollovers of the 10-bit week number, and the day of the urban car recording.
    EXPECT_EQ(GpsTime::from_calendar({.year = 1999, .month = 8, .day = 22}).week(), 1024);
    EXPECT_EQ(GpsTime::from_calendar({.year = 2019, .month = 4, .day = 7}).week(), 2048);
    const GpsTime time = parse_gps_iso("2022-03-18T08:51:22.300");
    EXPECT_EQ(time.week(), 2201);
    EXPECT_EQ(time.nanoseconds_of_week(),
              (5 * 86'400 + 8 * 3600 + 51 * 60 + 22) * second_ns + 300'000'000);
    EXPECT_EQ(GpsTime::from_week(time.week(), time.nanoseconds_of_week()), time);
    EXPECT_EQ(GpsTime::from_week(-1, 0).nanoseconds(), -GpsTime::nanoseconds_per_week);
}

TEST(GpsTime, AcceptsTheVeryEndOfAWeekAndNothingBeyond) {
    EXPECT_EQ(GpsTime::from_week(2200, GpsTime::nanoseconds_per_week), GpsTime::from_week(2201, 0));
    EXPECT_THROW(GpsTime::from_week(2200, GpsTime::nanoseconds_per_week + 1), Failure);
    EXPECT_THROW(GpsTime::from_week(2200, -1), Failure);
}

TEST(GpsTime, RefusesInvalidCalendarTimes) {
    const CalendarTime good{.year = 2024,
                            .month = 2,
                            .day = 29,
                            .hour = 23,
                            .minute = 59,
                            .second = 59,
                            .nanosecond = 999'999'999};
    EXPECT_EQ(GpsTime::from_calendar(good).calendar(), good);
    const auto refused = [](CalendarTime time) {
        EXPECT_THROW(GpsTime::from_calendar(time), Failure);
    };
    for (const int month : {0, 13, -1})
        refused({.year = 2024, .month = month, .day = 1});
    refused({.year = 2024, .month = 2, .day = 30});
    refused({.year = 2023, .month = 2, .day = 29});
    refused({.year = 1900, .month = 2, .day = 29});
    refused({.year = 2024, .month = 4, .day = 31});
    refused({.year = 2024, .month = 4, .day = 0});
    refused({.year = 2024, .month = 4, .day = 1, .hour = 24});
    refused({.year = 2024, .month = 4, .day = 1, .minute = 60});
    refused({.year = 2016, .month = 12, .day = 31, .hour = 23, .minute = 59, .second = 60});
    refused({.year = 2024, .month = 4, .day = 1, .nanosecond = second_ns});
    refused({.year = 2024, .month = 4, .day = 1, .nanosecond = -1});
    refused({.year = 2273, .month = 4, .day = 1});
    refused({.year = 1686, .month = 4, .day = 1});
    refused({.year = std::numeric_limits<int>::max(), .month = 4, .day = 1});
}

TEST(GpsTime, NeverWraps) {
    const GpsTime first = GpsTime::from_nanoseconds(smallest);
    const GpsTime last = GpsTime::from_nanoseconds(largest);
    EXPECT_THROW(last.plus_nanoseconds(1), Failure);
    EXPECT_THROW(first.plus_nanoseconds(-1), Failure);
    EXPECT_THROW(last.nanoseconds_since(first), Failure);
    EXPECT_THROW(last.seconds_since(first), Failure);
    EXPECT_THROW(GpsTime::from_week(std::numeric_limits<int>::max(), 0), Failure);
    EXPECT_THROW(to_iso(last, 0), Failure);
    EXPECT_EQ(to_iso(last, 9), "2272-04-15T23:47:16.854775807");
    EXPECT_EQ(to_iso(first, 9), "1687-09-26T00:12:43.145224192");
    EXPECT_EQ(first.week(), -15251);
}

TEST(GpsTime, DifferencesAreExact) {
    const GpsTime start = parse_gps_iso("2022-03-18T08:51:22.300");
    const GpsTime end = parse_gps_iso("2022-03-18T08:51:25.300");
    EXPECT_EQ(end.nanoseconds_since(start), 3 * second_ns);
    EXPECT_EQ(end.seconds_since(start), 3.0);
    EXPECT_EQ(start.seconds_since(end), -3.0);
    EXPECT_EQ(start.plus_nanoseconds(100'000'000).seconds_since(start), 0.1);
    EXPECT_EQ(GpsTime::from_nanoseconds(1'331'628'682'300'000'000).seconds_since(GpsTime()),
              1331628682.3);
    EXPECT_GT(end, start);
}

TEST(GpsTime, CalendarRoundTrips) {
    RandomGenerator random(1);
    for (int i = 0; i < 20'000; ++i) {
        const auto shift = static_cast<int>(random.next() % 40);
        // One second inside the span, below which the calendar's whole seconds fall out of it.
        const std::int64_t value = static_cast<std::int64_t>(random.next()) / 2 >> shift;
        const GpsTime time = GpsTime::from_nanoseconds(value);
        ASSERT_EQ(GpsTime::from_calendar(time.calendar()), time) << value;
        ASSERT_EQ(parse_gps_iso(to_iso(time, 9)), time) << value;
        ASSERT_EQ(GpsTime::from_week(time.week(), time.nanoseconds_of_week()), time) << value;
    }
}

TEST(GpsTimeText, RoundsAndCarries) {
    const GpsTime time = GpsTime::from_calendar({.year = 2023,
                                                 .month = 12,
                                                 .day = 31,
                                                 .hour = 23,
                                                 .minute = 59,
                                                 .second = 59,
                                                 .nanosecond = 999'500'000});
    EXPECT_EQ(to_iso(time), "2024-01-01T00:00:00.000");
    EXPECT_EQ(to_iso(time, 0), "2024-01-01T00:00:00");
    EXPECT_EQ(to_iso(time, 4), "2023-12-31T23:59:59.9995");
    EXPECT_EQ(to_iso(time.plus_nanoseconds(-1)), "2023-12-31T23:59:59.999");
    EXPECT_EQ(to_iso(GpsTime(), 1), "1980-01-06T00:00:00.0");
    EXPECT_EQ(to_iso(GpsTime::from_nanoseconds(-500'000), 3), "1980-01-06T00:00:00.000");
    EXPECT_EQ(to_iso(GpsTime::from_nanoseconds(-500'001), 3), "1980-01-05T23:59:59.999");
}

TEST(GpsTimeText, ReadsItsForms) {
    const GpsTime time = parse_gps_iso("2022-03-18T08:51:22.300");
    EXPECT_EQ(parse_gps_iso("2022/03/18 08:51:22.3"), time);
    EXPECT_EQ(parse_gps_iso("2022-03-18 08:51:22.300000000"), time);
    EXPECT_EQ(parse_gps_iso("2022/03/18T08:51:22"), time.plus_nanoseconds(-300'000'000));
    EXPECT_EQ(to_iso(time), "2022-03-18T08:51:22.300");
}

TEST(GpsTimeText, SaysWhatIsWrongAndAtWhichColumn) {
    const struct {
        const char* text;
        const char* said;
    } cases[] = {
        {"", "column 1: expected 4 digits of the year"},
        {" 2022-03-18T08:51:22", "column 1: expected 4 digits"},
        {"22-03-18T08:51:22", "column 3: expected 4 digits"},
        {"2022-03/18T08:51:22", "column 8: expected '-'"},
        {"2022/03-18T08:51:22", "column 8: expected '/'"},
        {"2022.03.18T08:51:22", "column 5: expected '-' or '/'"},
        {"2022-13-18T08:51:22", "column 6: the month 13 is not 1 to 12"},
        {"2022-02-30T08:51:22", "column 9: the day 30 is not 1 to 28 in 2022-02"},
        {"2022-03-18T24:51:22", "column 12: the hour 24"},
        {"2022-03-18T08:60:22", "column 15: the minute 60"},
        {"2016-12-31T23:59:60", "column 18: the second 60 is not 0 to 59"},
        {"2022-03-18_08:51:22", "column 11: expected 'T' or a blank"},
        {"2022-03-18  08:51:22", "column 12: expected 2 digits of the hour"},
        {"2022-03-18T08:51", "column 17: expected ':'"},
        {"2022-03-18T08:51:22.", "column 21: expected a decimal"},
        {"2022-03-18T08:51:22,3", "column 20: expected a decimal point or the end"},
        {"2022-03-18T08:51:22.1234567890", "column 30: expected at most 9 decimals"},
        {"2022-03-18T08:51:22Z", "column 20: expected a decimal point or the end"},
        {"2022-03-18T08:51:22.3Z", "column 22: expected the end"},
        {"2022-03-18T08:51:22.3 ", "column 22: expected the end"},
        {"9999-03-18T08:51:22", "column 1: the year 9999"},
    };
    for (const auto& c : cases)
        EXPECT_TRUE(contains(problem_of(c.text), c.said)) << c.text << " -> " << problem_of(c.text);
    EXPECT_TRUE(contains(problem_of("2300-03-18T08:51:22"), "outside the years"));
    EXPECT_TRUE(contains(problem_of(std::string("\x01\xff", 2)), "\\x01\\xff"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
