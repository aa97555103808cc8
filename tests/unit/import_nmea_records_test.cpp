#include <array>
#include <cmath>

#include "import_nmea_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace nmea_test;
using nmea_test::sentence;  // not core/text.h's

Observation row_with_velocities(const std::string& vtg, const std::string& rmc_speed_course) {
    const Observations read = read_nmea(
        gga("101112.00") + (vtg.empty() ? "" : sentence("GPVTG," + vtg)) +
        sentence("GPRMC,101112.00,A,4530.0,N,00915.0,E," + rmc_speed_course + ",050321,,,A"));
    return read.rows.at(0);
}

TEST(NmeaVelocity, IsOfTheMostFinelyWritten) {
    const auto east = [](const std::string& vtg, const std::string& rmc_speed_course) {
        return row_with_velocities(vtg, rmc_speed_course).recorded_velocity_east_m_s.value();
    };
    EXPECT_NEAR(east("090.0,T,,M,19.4,N,36.0,K,A", "19.4,090.0"), 10.0, 1e-9);
    EXPECT_NEAR(east("090.0,T,,M,19.438,N,36.0,K,A", "19.4,090.0"), 19.438 * 1852 / 3600, 1e-9);
    EXPECT_NEAR(east("090.0,T,,M,19.4,N,36.0,K,A", "19.44,090.0"), 19.44 * 1852 / 3600, 1e-9);
    EXPECT_NEAR(east("", "19.4,270.0"), -19.4 * 1852 / 3600, 1e-9);
    EXPECT_NEAR(east(",T,,M,19.4,N,36.0,K,A", "19.4,090.0"), 10.0, 1e-9);  // course of RMC
}

TEST(NmeaVelocity, OfAnotherMomentIsNotUsed) {
    // VTG has no time: one written before its epoch's first sentence is taken for the epoch before.
    const Observation row = row_with_velocities("090.0,T,,M,38.9,N,72.0,K,A", "19.4,090.0");
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, 19.4 * 1852 / 3600, 1e-9);
}

TEST(NmeaVelocity, StandingNeedsNoCourseAndMovingDoes) {
    EXPECT_EQ(*row_with_velocities("", "0.00,").recorded_velocity_north_m_s, 0.0);
    EXPECT_FALSE(row_with_velocities("", "0.01,").recorded_velocity_north_m_s);
    EXPECT_FALSE(row_with_velocities("", ",090.0").recorded_velocity_north_m_s);
    EXPECT_FALSE(row_with_velocities("090.0,T,,M,1,N,2,K,N", ",").recorded_velocity_north_m_s);
}

// ----------------------------------------------------------------------------------------- time

TEST(NmeaTime, IsExactToTheNanosecond) {
    const Observations read = read_nmea(rmc("101112.123456789", "050321") +
                                        rmc("101112.2", "050321") + rmc("101113", "050321"));
    EXPECT_EQ(utc_of(read, 0, 9), "2021-03-05T10:11:12.123456789Z");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 76'543'211);
    EXPECT_EQ(read.rows[2].time.nanoseconds, 876'543'211);
}

TEST(NmeaTime, DayIsCarriedOverMidnight) {
    // RMC once a second, GGA four times: the midnight falls between, and RMC's new date is not
    // one more day.
    const Observations read =
        read_nmea(gga("235959.25") + gga("235959.50") + rmc("235959.50", "311220") +
                  gga("235959.75") + gga("000000.00") + gga("000000.25") + gga("000000.50") +
                  rmc("000000.50", "010121") + gga("000000.75"));
    ASSERT_EQ(read.rows.size(), 7u);
    EXPECT_EQ(utc_of(read, 0), "2020-12-31T23:59:59.250Z");  // before the first date
    for (std::size_t i = 0; i < 7; ++i)
        EXPECT_EQ(read.rows[i].time.nanoseconds, static_cast<std::int64_t>(i) * 250'000'000);
}

TEST(NmeaTime, EpochsBeforeTheFirstDateAreCountedBack) {
    const Observations read = read_nmea(gga("235959.00") + gga("000000.00") + gga("000001.00") +
                                        rmc("000001.00", "010121"));
    EXPECT_EQ(utc_of(read, 0), "2020-12-31T23:59:59.000Z");
    EXPECT_EQ(read.rows[2].time.nanoseconds, 2'000'000'000);
}

TEST(NmeaTime, DateOfAReceiverWithoutFixDoesNotCount) {
    const Observations read = read_nmea(sentence("GPRMC,101110.00,V,,,,,,,060180,,,N") +
                                        gga("101111.00") + rmc("101112.00", "050321"));
    EXPECT_EQ(utc_of(read, 0), "2021-03-05T10:11:10.000Z");
    const Observations never =
        read_nmea(sentence("GPRMC,101110.00,V,,,,,,,060180,,,N") + gga("101111.00"));
    EXPECT_EQ(utc_of(never, 0), "1980-01-06T10:11:10.000Z");
    EXPECT_TRUE(has_note(never, "receiver's own clock"));
}

TEST(NmeaTime, TwoDigitYearsAndStepsBack) {
    EXPECT_EQ(utc_of(read_nmea(rmc("101112.00", "050380")), 0), "1980-03-05T10:11:12.000Z");
    EXPECT_EQ(utc_of(read_nmea(rmc("101112.00", "050379")), 0), "2079-03-05T10:11:12.000Z");
    const Observations back = read_nmea(rmc("101112.00", "050321") + rmc("101111.00", "050321"));
    EXPECT_EQ(back.rows[1].time.nanoseconds, -1'000'000'000);
}

TEST(NmeaTime, LeapSecondIsOneSecond) {
    const Observations read = read_nmea(rmc("235959.50", "311216") + rmc("235960.50", "311216") +
                                        rmc("000000.50", "010117"));
    EXPECT_EQ(utc_of(read, 1), "2016-12-31T23:59:60.500Z");
    EXPECT_EQ(read.rows[2].time.nanoseconds, 2'000'000'000);
    const Observations never = read_nmea(rmc("235959.50", "311218") + rmc("235960.50", "311218") +
                                         rmc("000000.50", "010119"));
    EXPECT_EQ(never.records.bad, 1);
    EXPECT_EQ(never.rows.size(), 2u);
}

TEST(NmeaTime, WithoutDateIsTheAttemptsOrRelative) {
    const std::string text = gga("235959.00") + gga("000000.50");
    Receiver receiver = pos_receiver();
    const Observations relative = import_text(receiver, text);
    EXPECT_EQ(relative.time_scale, "relative");
    EXPECT_FALSE(relative.facts.first_epoch);
    EXPECT_EQ(relative.rows[1].time.nanoseconds, 1'500'000'000);
    EXPECT_TRUE(has_note(relative, "start_date"));
    receiver.start_date = "2023-07-11";
    EXPECT_EQ(utc_of(import_text(receiver, text), 1), "2023-07-12T00:00:00.500Z");
    receiver.start_date = "2023-02-30";
    EXPECT_NE(failure_of(receiver, text).find("attempt.yaml:5:5: start_date \"2023-02-30\""),
              std::string::npos);
}

// ----------------------------------------------------------------------------------- bad records

TEST(NmeaRecords, WrongChecksumIsBadAndItsEpochGoesOn) {
    const std::string damaged = replaced(gga("101112.00"), "120.5", "120.6");
    const Observations read = read_nmea(rmc("101111.00", "050321") + rmc("101112.00", "050321") +
                                        damaged + rmc("101113.00", "050321"));
    ASSERT_EQ(read.rows.size(), 3u);
    EXPECT_FALSE(read.rows[1].height_m);
    EXPECT_EQ(read.records.total, 4);
    ASSERT_EQ(read.records.bad_records.size(), 1u);
    const BadRecord& bad = read.records.bad_records[0];
    EXPECT_EQ(bad.line, 3);
    EXPECT_EQ(bad.epoch, 2);
    EXPECT_NE(bad.what.find("checksum"), std::string::npos) << bad.what;
}

TEST(NmeaRecords, MissingChecksumIsNotedAndJunkIsPassedOver) {
    std::string bare = gga("101112.00");
    bare = bare.substr(0, bare.find('*')) + "\n";
    const Observations read =
        read_nmea(std::string("\xd3\x00\x13\x3e\0\x01$\xb5\x62 12:00 ", 16) +
                  rmc("101112.00", "050321") + "a line of a logger\n" + bare +
                  sentence("PUBX,00,1") + "$PSTI,030*00\n!AIVDM,1,1,,A,x,0*00\n" +
                  sentence("GPGLL,4530.0,N,00915.0,E,101112.00,A,A") + "\n");
    EXPECT_EQ(read.rows.size(), 1u);
    EXPECT_TRUE(read.rows[0].height_m);
    EXPECT_EQ(read.records.total, 2);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_TRUE(has_note(read, "no checksum, and were taken as they are: 1."));
    EXPECT_TRUE(has_note(read, "hold no NMEA sentence, and were passed over: 1."));
}

TEST(NmeaRecords, SentenceRunIntoTheNextIsBad) {
    const Observations read = read_nmea(
        rmc("101111.00", "050321") + gga("101112.00").substr(0, 30) + rmc("101112.00", "050321"));
    EXPECT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_NE(read.records.bad_records[0].what.find("cut off"), std::string::npos);
}

TEST(NmeaRecords, RepeatedSentenceDoesNotReplace) {
    const Observations read =
        read_nmea(gga("101112.00", "4") + rmc("101112.00", "050321") + gga("101112.00", "1"));
    ASSERT_EQ(read.rows.size(), 1u);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_TRUE(has_note(read, "repeat one of the same type and time"));
}

class NmeaBadField : public testing::TestWithParam<std::array<const char*, 2>> {};

TEST_P(NmeaBadField, IsABadRecord) {
    const auto& [from, to] = GetParam();
    std::string body = gga("101112.00");
    body = replaced(body.substr(1, body.find('*') - 1), from, to);
    const Observations read =
        read_nmea(rmc("101111.00", "050321") + rmc("101112.00", "050321") + sentence(body));
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_FALSE(read.rows[1].height_m);
}

INSTANTIATE_TEST_SUITE_P(
    Gga, NmeaBadField,
    testing::Values(std::array{"4530.0", "4560.0"}, std::array{"4530.0", "9530.0"},
                    std::array{"4530.0", "0x10"}, std::array{"4530.0000000", "-4530.0"},
                    std::array{"00915.0", "18115.0"}, std::array{",N,", ",,"},
                    std::array{",N,", ",E,"}, std::array{",N,", ",North,"},
                    std::array{"120.5", "nan"}, std::array{"120.5", "1e400"},
                    std::array{"120.5", "120 5"}, std::array{"120.5", "2e5"},
                    std::array{"M,47", "F,47"}, std::array{"47.25", "x"},
                    std::array{",1,10,", ",x,10,"}, std::array{",1,10,", ",1,-1,"},
                    std::array{"1.5", "inf"}, std::array{"101112.00", "101162.00"},
                    std::array{"101112.00", "241112.00"}, std::array{"101112.00", "1012.00"},
                    std::array{"101112.00", "101112.0000000000"}));

TEST(NmeaRecords, CutAtEveryByteKeepsWhatWasBefore) {
    const std::string text = rmc("101111.00", "050321") + gga("101111.00") +
                             rmc("101112.00", "050321") + gga("101112.00");
    const std::size_t first = (rmc("101111.00", "050321") + gga("101111.00")).size();
    const Observations whole = read_nmea(text);
    for (std::size_t size = first; size < text.size(); ++size) {
        const Observations cut = read_nmea(text.substr(0, size));
        EXPECT_EQ(*cut.rows.at(0).height_m, *whole.rows[0].height_m) << size;
        if (cut.rows.size() > 1 && cut.rows[1].height_m) {
            EXPECT_EQ(*cut.rows[1].height_m, *whole.rows[1].height_m) << size;
        }
        EXPECT_LE(cut.records.bad, 1) << size;
    }
    for (std::size_t size = 1; size < first; ++size)
        (void)failure_of(pos_receiver(), std::string_view(text).substr(0, size));
}

TEST(NmeaRecords, WithoutPositionsIsRefusedInWords) {
    Receiver receiver = pos_receiver();
    EXPECT_NE(
        failure_of(receiver, sentence("GPGGA,,,,,,0,00,,,,,,,")).find("none of them has a time"),
        std::string::npos);
    EXPECT_NE(failure_of(receiver, sentence("GPZDA,101112.00,05,03,2021,00,00"))
                  .find("no GGA, GNS or RMC"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
