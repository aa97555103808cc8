#include "import_ubx_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace ubx_test;
using namespace std::string_literals;

TEST(UbxTime, EpochsBeforeTheTimeIsKnownAreLeftOut) {
    const std::string unknown = frame(1, 7, pvt().put(11, 0x01, 1).bytes());
    const Observations read = read_ubx(unknown + pvt_frame(500));
    EXPECT_EQ(read.rows.size(), 1u);
    EXPECT_TRUE(has_note(read, "before the receiver knew the time, which were left out: 1."));
    EXPECT_NE(failure_of(pos_receiver(), unknown).find("knew the time in none"), std::string::npos);
}

TEST(UbxTime, GpsTimeOfWeekCorrectsLeapSecondsThatTheReceiverHasYetToLearn) {
    // Firmware that counts 16 leap seconds shows 2 s more of UTC until a satellite tells it.
    const Observations read = read_ubx(frame(1, 7, pvt().put(10, 32, 1).bytes()) + pvt_frame(500));
    EXPECT_EQ(read.rows[1].time.nanoseconds, 500'000'000);
    EXPECT_TRUE(has_note(read, "whole seconds off the GPS time of week"));
}

TEST(UbxTime, AWeekThatIsRolledOverIsToldByTheLeapSecondsCounted) {
    // 1024 and 2048 weeks before 2023-07-11, when there were 18 leap seconds, and 13 and 3 then.
    const auto dated = [](int year, int month, int day, int second) {
        return frame(
            1, 7, pvt().put(4, year, 2).put(6, month, 1).put(7, day, 1).put(10, second, 1).bytes());
    };
    const GpsTime right = instant(read_ubx(pvt_frame(0)), 0);
    for (const auto& [year, month, day] : {std::array{2003, 11, 25}, std::array{1984, 4, 10}}) {
        const Observations read = read_ubx(dated(year, month, day, 30));
        EXPECT_EQ(instant(read, 0), right);
        EXPECT_TRUE(has_note(read, "1024 or 2048 too small"));
        EXPECT_FALSE(has_note(read, "whole seconds off"));
    }
    // As many as there were then, or were never: the date may be right.
    for (const int counted : {13, 15, 25}) {
        const Observations read = read_ubx(dated(2003, 11, 25, 48 - counted));
        EXPECT_EQ(instant(read, 0).calendar().year, 2003);
        EXPECT_FALSE(has_note(read, "too small"));
    }
    // NAV-TIMEGPS says how many it counts, and whether it knows.
    for (const bool knows : {true, false}) {
        const Payload timegps = Payload(16)
                                    .put(0, first_tow_ms, 4)
                                    .put(8, right.week() - 1024, 2)
                                    .put(10, 18, 1)
                                    .put(11, knows ? 7 : 3, 1);
        const std::string posllh = frame(1, 2, Payload(28).put(0, first_tow_ms, 4).bytes());
        const Observations read = read_ubx(posllh + frame(1, 0x20, timegps.bytes()));
        EXPECT_EQ(instant(read, 0).calendar().year, knows ? 2023 : 2003);
    }
}

TEST(UbxTime, LeapSecondAndEndOfWeek) {
    // 2016-12-31 was a Saturday: the leap second is the week's 17th second in GPS time.
    const auto at = [](std::int64_t tow_ms, int year, int month, int day, int hms, int nano) {
        return frame(1, 7,
                     pvt()
                         .put(0, tow_ms, 4)
                         .put(4, year, 2)
                         .put(6, month, 1)
                         .put(7, day, 1)
                         .put(8, hms / 10000, 1)
                         .put(9, hms / 100 % 100, 1)
                         .put(10, hms % 100, 1)
                         .put(16, nano, 4)
                         .bytes());
    };
    const Observations read =
        read_ubx(at(16'500, 2016, 12, 31, 235959, 500'000'000) +
                 at(17'500, 2016, 12, 31, 235960, 500'000'000) + at(18'000, 2017, 1, 1, 0, -250) +
                 at(604'800'000, 2017, 1, 7, 235942, 0));
    ASSERT_EQ(read.rows.size(), 4u);
    EXPECT_EQ(read.rows[1].time.nanoseconds, 1'000'000'000);
    EXPECT_EQ(read.rows[2].time.nanoseconds, 1'499'999'750);
    EXPECT_EQ(instant(read, 3), GpsTime::from_week(1931, 0));
    EXPECT_FALSE(has_note(read, "whole seconds off"));
}

TEST(UbxTime, ImpossibleTimeIsABadRecord) {
    const Observations read =
        read_ubx(pvt_frame(0) + frame(1, 7, pvt(250).put(6, 13, 1).bytes()) + pvt_frame(500));
    EXPECT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_EQ(read.records.bad_records[0].byte, 100);
}

// --------------------------------------------------------------------------------------- frames

TEST(UbxFrames, StandBetweenNmeaAndRtcm) {
    // An RTCM message that happens to hold the sync characters and a class of messages.
    const std::string rtcm = "\xd3\x00\x08\xb5\x62\x01\x07\x04\x00\x11\x22\x94\xf8\x2f"s;
    const std::string nmea = "$GNTXT,01,01,02,u-blox AG - www.u-blox.com*4E\r\n";
    const Observations read =
        read_ubx(nmea + pvt_frame(0) + rtcm + pvt_frame(250) + nmea + rtcm + pvt_frame(500) + nmea);
    EXPECT_EQ(read.rows.size(), 3u);
    EXPECT_EQ(read.records.total, 3);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_FALSE(has_note(read, "neither NMEA nor RTCM"));
    const Observations junk = read_ubx(pvt_frame(0) + "\x01\x02\xb5\x62\xee\x03" + pvt_frame(250));
    EXPECT_EQ(junk.rows.size(), 2u);
    EXPECT_EQ(junk.records.bad, 0);
    EXPECT_TRUE(has_note(junk, "neither NMEA nor RTCM, and were passed over: 5."));
}

TEST(UbxFrames, WholeFrameInsideADamagedOneIsFound) {
    // The length of the second frame is damaged, and swallows the third.
    std::string damaged = pvt_frame(250);
    damaged[4] = static_cast<char>(92 + 50);
    const Observations read = read_ubx(pvt_frame(0) + damaged + pvt_frame(500) + pvt_frame(750));
    ASSERT_EQ(read.rows.size(), 3u);
    EXPECT_EQ(read.rows[1].time.nanoseconds, 500'000'000);
    ASSERT_EQ(read.records.bad, 1);
    EXPECT_EQ(read.records.bad_records[0].byte, 100);
    EXPECT_EQ(read.records.bad_records[0].epoch, 1);
    EXPECT_NE(read.records.bad_records[0].what.find("class 01, number 07 has a checksum"),
              std::string::npos);
}

TEST(UbxFrames, DamageOfAnyByteCostsItsOwnFrameAndNoOther) {
    const std::string before = pvt_frame(0), after = pvt_frame(500) + pvt_frame(750);
    for (std::size_t at = 0; at < 100; ++at)
        for (const int flip : {0x01, 0x80, 0xff}) {
            std::string damaged = pvt_frame(250);
            damaged[at] = static_cast<char>(damaged[at] ^ flip);
            const Observations read = read_ubx(before + damaged + after);
            ASSERT_EQ(read.rows.size(), 3u) << at;
            EXPECT_EQ(read.rows[1].time.nanoseconds, 500'000'000) << at;
            // Without its sync characters it is no frame at all.
            EXPECT_EQ(read.records.bad, at < 2 ? 0 : 1) << at;
            EXPECT_EQ(has_note(read, "neither NMEA nor RTCM"), true) << at;
        }
}

TEST(UbxFrames, CutAtEveryByteKeepsWhatWasBefore) {
    const std::string bytes = pvt_frame(0) + pvt_frame(250) + pvt_frame(500);
    for (std::size_t size = 100; size <= bytes.size(); ++size) {
        const Observations read = read_ubx(bytes.substr(0, size));
        EXPECT_EQ(read.rows.size(), size / 100) << size;
        EXPECT_EQ(read.records.bad, size % 100 == 0 ? 0 : 1) << size;
    }
    Receiver receiver = pos_receiver();
    receiver.format = "ubx";
    for (std::size_t size = 1; size < 100; ++size)
        EXPECT_NE(failure_of(receiver, bytes.substr(0, size)).find("end of the recording"),
                  std::string::npos)
            << size;
}

TEST(UbxFrames, RepeatedMessageDoesNotReplace) {
    const Observations read =
        read_ubx(pvt_frame(0) + frame(1, 7, pvt(0).put(32, 1, 4).bytes()) + pvt_frame(250));
    EXPECT_EQ(read.rows.size(), 2u);
    EXPECT_DOUBLE_EQ(*read.rows[0].height_m, 167.75);
    EXPECT_TRUE(has_note(read, "repeat one of the same kind and epoch"));
}

// Each of these could be a frame of 64 KiB, and each is not: read in a few passes, not in 65,000.
TEST(UbxFrames, ManyFalseLengthsCostLittle) {
    std::string bytes = pvt_frame(0);
    while (bytes.size() < 3'000'000)
        bytes += "\xb5\x62\x01\x07\xff\xff"s;
    EXPECT_NE(failure_of(pos_receiver(), bytes).find("records cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
