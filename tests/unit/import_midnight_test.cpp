#include <fmt/format.h>

#include <string>

#include "import_nmea_test_support.h"

// Recorders write the new date a few records before midnight, at it, late or never: the day is
// counted once all the same.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace nmea_test;

/// Time of day so many seconds after 23:59:00.
std::string time_at(int second) {
    const int of_day = (86'340 + second) % 86'400;
    return fmt::format("{:02}{:02}{:02}", of_day / 3600, of_day / 60 % 60, of_day % 60);
}

void expect_seconds(const Observations& read, std::size_t rows) {
    ASSERT_EQ(read.rows.size(), rows);
    EXPECT_EQ(utc_of(read, 0), "2025-12-31T23:59:30.000Z");
    for (std::size_t i = 0; i < rows; ++i)
        EXPECT_EQ(read.rows[i].time.nanoseconds, static_cast<std::int64_t>(i) * 1'000'000'000) << i;
}

class IgcMidnight : public testing::TestWithParam<int> {};  // second of the new HFDTE

TEST_P(IgcMidnight, DayIsCountedOnce) {
    std::string text = "AXXX001\nHFDTE311225\n";
    for (int i = 30; i <= 100; ++i) {
        if (i == GetParam()) text += "HFDTE010126\n";
        text += "B" + time_at(i) + "5206000N00506000EA0000300003\n";
    }
    expect_seconds(import_text(pos_receiver(), text), 71);
}

INSTANTIATE_TEST_SUITE_P(All, IgcMidnight,
                         testing::Values(31, 45, 57, 58, 59, 60, 61, 62, 75, 100, 1000));

TEST(IgcMidnight, TheOldDateAgainAfterMidnightIsLate) {
    std::string text = "AXXX001\nHFDTE311225\n";
    for (int i = 30; i <= 100; ++i) {
        if (i == 63) text += "HFDTE311225\n";
        text += "B" + time_at(i) + "5206000N00506000EA0000300003\n";
    }
    expect_seconds(import_text(pos_receiver(), text), 71);
}

TEST(IgcMidnight, AnotherFlightADayLaterIsOne) {
    const auto b = [](const std::string& time) {
        return "B" + time + "5206000N00506000EA0000300003\n";
    };
    const Observations read = import_text(
        pos_receiver(), "AXXX001\nHFDTE311225\n" + b("100000") + "HFDTE010126\n" + b("110000"));
    EXPECT_EQ(utc_of(read, 1), "2026-01-01T11:00:00.000Z");
}

/// The epoch from which RMC has the new date.
class NmeaMidnight : public testing::TestWithParam<int> {};

TEST_P(NmeaMidnight, DayIsCountedOnce) {
    std::string text;
    for (int i = 30; i <= 100; ++i) {
        text += gga(time_at(i) + ".00");
        text += rmc(time_at(i) + ".00", i < GetParam() ? "311225" : "010126");
    }
    expect_seconds(read_nmea(text), 71);
}

INSTANTIATE_TEST_SUITE_P(All, NmeaMidnight, testing::Values(57, 59, 60, 61, 63));

TEST(NmeaMidnight, TheFirstDateOfARecordingMayBeLate) {
    std::string text;
    for (int i = 60; i <= 200; ++i)
        text += rmc(time_at(i) + ".00", i < 62 ? "311225" : "010126");
    const Observations read = read_nmea(text);
    EXPECT_EQ(utc_of(read, 0), "2026-01-01T00:00:00.000Z");
    EXPECT_EQ(read.rows.back().time.nanoseconds, 140'000'000'000);
    std::string early;
    for (int i = 58; i <= 100; ++i)
        early += rmc(time_at(i) + ".00", i < 59 ? "010126" : i < 60 ? "311225" : "010126");
    EXPECT_EQ(utc_of(read_nmea(early), 0), "2025-12-31T23:59:58.000Z");
}

TEST(NmeaMidnight, ADateThatJumpsAtNoonIsTaken) {
    const Observations read = read_nmea(rmc("120000.00", "311225") + rmc("120001.00", "010126"));
    EXPECT_EQ(read.rows[1].time.nanoseconds, 86'401'000'000'000);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
