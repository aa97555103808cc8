#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/failure.h"
#include "core/gps_time.h"
#include "core/leap_seconds.h"
#include "core/random.h"
#include "core/text.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr std::int64_t second_ns = GpsTime::nanoseconds_per_second;

TEST(LeapSeconds, PublishedInstants) {
    // GPS seconds against UTC: the GPS epoch; second 10^9; the gravitational waves GW150914 and
    // GW170817 (LIGO event pages); the last leap second (LIGO's 1167264018).
    const struct {
        std::int64_t gps_s;
        const char* utc;
    } cases[] = {
        {0, "1980-01-06T00:00:00Z"},
        {1'000'000'000, "2011-09-14T01:46:25Z"},
        {1'126'259'462, "2015-09-14T09:50:45Z"},
        {1'187'008'882, "2017-08-17T12:41:04Z"},
        {1'167'264'016, "2016-12-31T23:59:59Z"},
        {1'167'264'017, "2016-12-31T23:59:60Z"},
        {1'167'264'018, "2017-01-01T00:00:00Z"},
    };
    for (const auto& c : cases)
        EXPECT_EQ(to_utc_iso(GpsTime::from_nanoseconds(c.gps_s * second_ns), 0), c.utc);
    EXPECT_EQ(to_utc_iso(parse_gps_iso("2022-03-18T08:51:22.300")), "2022-03-18T08:51:04.300Z");
}

TEST(LeapSeconds, ALeapSecondRoundTrips) {
    CalendarTime utc{.year = 2016,
                     .month = 12,
                     .day = 31,
                     .hour = 23,
                     .minute = 59,
                     .second = 60,
                     .nanosecond = 250'000'000};
    const GpsTime time = gps_from_utc(utc);
    EXPECT_EQ(utc_from_gps(time).time, utc);
    EXPECT_EQ(to_utc_iso(time), "2016-12-31T23:59:60.250Z");
    EXPECT_EQ(to_iso(time), "2017-01-01T00:00:17.250");
    EXPECT_EQ(to_utc_iso(time.plus_nanoseconds(749'999'999)), "2017-01-01T00:00:00.000Z");
    EXPECT_EQ(to_utc_iso(time.plus_nanoseconds(-250'000'001)), "2016-12-31T23:59:60.000Z");
}

TEST(LeapSeconds, RefusesALeapSecondThatNeverWas) {
    const auto refused = [](CalendarTime utc) { EXPECT_THROW(gps_from_utc(utc), Failure); };
    refused({.year = 2016, .month = 12, .day = 30, .hour = 23, .minute = 59, .second = 60});
    refused({.year = 2016, .month = 12, .day = 31, .hour = 22, .minute = 59, .second = 60});
    refused({.year = 2022, .month = 6, .day = 30, .hour = 23, .minute = 59, .second = 60});
    refused({.year = 1980, .month = 1, .day = 5, .hour = 23, .minute = 59, .second = 60});
    refused({.year = 2016, .month = 12, .day = 31, .hour = 23, .minute = 59, .second = 61});
}

TEST(LeapSeconds, EveryStepIsContinuousAndOneSecondLong) {
    for (const LeapSecondStep& step : leap_second_table().subspan(1)) {
        const GpsTime start =
            gps_from_utc({.year = step.year, .month = step.month, .day = step.day});
        for (std::int64_t offset_ns = -3 * second_ns; offset_ns <= 3 * second_ns;
             offset_ns += second_ns / 4) {
            const GpsTime time = start.plus_nanoseconds(offset_ns);
            const UtcTime utc = utc_from_gps(time);
            EXPECT_TRUE(utc.leap_seconds_known);
            EXPECT_EQ(gps_from_utc(utc.time), time);
            EXPECT_EQ(utc.time.second == 60, offset_ns < 0 && offset_ns >= -second_ns);
        }
    }
}

TEST(LeapSeconds, UtcRoundTripsAnywhere) {
    RandomGenerator random(2);
    for (int i = 0; i < 20'000; ++i) {
        const GpsTime time =
            GpsTime::from_nanoseconds(static_cast<std::int64_t>(random.uniform() * 1.6e18));
        ASSERT_EQ(gps_from_utc(utc_from_gps(time).time), time) << to_iso(time, 9);
    }
}

TEST(LeapSeconds, AreUnknownOutsideTheTable) {
    EXPECT_EQ(leap_seconds_known_until(), (CalendarTime{.year = 2027, .month = 6, .day = 28}));
    const GpsTime end = gps_from_utc(leap_seconds_known_until());
    EXPECT_TRUE(utc_from_gps(end.plus_nanoseconds(-1)).leap_seconds_known);
    EXPECT_FALSE(utc_from_gps(end).leap_seconds_known);
    EXPECT_TRUE(utc_from_gps(GpsTime()).leap_seconds_known);
    EXPECT_FALSE(utc_from_gps(GpsTime::from_nanoseconds(-1)).leap_seconds_known);
    EXPECT_EQ(to_utc_iso(GpsTime::from_nanoseconds(-second_ns), 0), "1980-01-05T23:59:59Z");
}

struct SystemList {
    std::vector<std::pair<std::int64_t, std::int64_t>> steps;  // NTP second, TAI - UTC
    std::int64_t expires_ntp_s = 0;
};

SystemList read_system_list(std::istream& file) {
    SystemList list;
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("#@"))
            list.expires_ntp_s = parse_integer(trim(std::string_view(line).substr(2))).value();
        if (line.starts_with('#') || trim(line).empty()) continue;
        std::istringstream fields(line);
        std::string ntp_s;
        std::string tai_minus_utc_s;
        fields >> ntp_s >> tai_minus_utc_s;
        list.steps.emplace_back(parse_integer(ntp_s).value(),
                                parse_integer(tai_minus_utc_s).value());
    }
    return list;
}

// NTP counts UTC seconds from 1900-01-01, days of 86 400 s; 29 224 days before 1980-01-06. TAI is
// ahead of GPS time by 19 s.
constexpr std::int64_t gps_epoch_ntp_s = 29'224LL * 86'400;

std::int64_t ntp_s(const CalendarTime& utc, int gps_minus_utc_s) {
    return gps_epoch_ntp_s + gps_from_utc(utc).nanoseconds() / second_ns - gps_minus_utc_s;
}

/// The program's table as the lists of others write it.
std::vector<std::pair<std::int64_t, std::int64_t>> own_steps() {
    std::vector<std::pair<std::int64_t, std::int64_t>> own;
    for (const LeapSecondStep& step : leap_second_table().subspan(1))
        own.emplace_back(
            ntp_s({.year = step.year, .month = step.month, .day = step.day}, step.gps_minus_utc_s),
            step.gps_minus_utc_s + 19);
    return own;
}

// leap-seconds.list of the Paris Observatory, after IERS Bulletin C.
TEST(LeapSeconds, ArePublished) {
    const std::vector<std::pair<std::int64_t, std::int64_t>> published{
        {2571782400, 20}, {2603318400, 21}, {2634854400, 22}, {2698012800, 23}, {2776982400, 24},
        {2840140800, 25}, {2871676800, 26}, {2918937600, 27}, {2950473600, 28}, {2982009600, 29},
        {3029443200, 30}, {3076704000, 31}, {3124137600, 32}, {3345062400, 33}, {3439756800, 34},
        {3550089600, 35}, {3644697600, 36}, {3692217600, 37}};
    EXPECT_EQ(own_steps(), published);
    EXPECT_EQ(leap_second_table().front().gps_minus_utc_s, 0);
}

// As far as both know: a list that is older says nothing of what came after it.
TEST(LeapSeconds, AgreeWithTheSystemsList) {
    std::ifstream file("/usr/share/zoneinfo/leap-seconds.list");
    if (!file) GTEST_SKIP() << "tzdata is not installed (/usr/share/zoneinfo/leap-seconds.list)";
    SystemList list = read_system_list(file);
    const std::int64_t both_know_until_ntp_s =
        std::min(list.expires_ntp_s, ntp_s(leap_seconds_known_until(), 18));
    auto own = own_steps();
    std::erase_if(own, [&](const auto& step) { return step.first >= both_know_until_ntp_s; });
    std::erase_if(list.steps, [&](const auto& step) {
        return step.first <= gps_epoch_ntp_s || step.first >= both_know_until_ntp_s;
    });
    EXPECT_EQ(own, list.steps);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
