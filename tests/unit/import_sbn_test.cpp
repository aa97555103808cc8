#include <cmath>
#include <cstdint>

#include "gpsbabel_support.h"
#include "import_test_support.h"
#include "stages/import/format.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver sbn_receiver() {
    Receiver receiver = pos_receiver();
    receiver.format = "sbn";
    return receiver;
}

std::string big(std::uint64_t value, int size) {
    std::string bytes;
    for (int i = size - 1; i >= 0; --i)
        bytes += static_cast<char>(value >> (8 * i) & 255);
    return bytes;
}

std::string frame(const std::string& payload) {
    unsigned sum = 0;
    for (const char c : payload)
        sum += static_cast<unsigned char>(c);
    return "\xa0\xa2" + big(payload.size(), 2) + payload + big(sum & 0x7fff, 2) + "\xb0\xb3";
}

/// 2012-07-15, a Sunday: GPS week 1697 begins.
constexpr int week = 1697;

/// An epoch of message 41, 16 leap seconds being right.
struct Epoch {
    int nav_type = 4;
    std::int64_t of_week_ms = 3'600'000;
    int leap_seconds = 16;
    std::int32_t latitude = 543'210'000;
    std::int32_t longitude = -13'579'000;
    int ellipsoid_cm = 6012;
    int sea_level_cm = 1234;
    int datum = 21;
    int speed_cmps = 1500;
    int course = 27'000;
    int climb_cmps = 12;
    std::uint64_t horizontal_error_cm = 280;
    std::uint64_t vertical_error_cm = 450;
    int velocity_error_cmps = 0;
    int sdop = 40;
    int vsdop = 70;
    bool locosys = true;
};

std::string message(const Epoch& epoch) {
    const auto u = [](auto value) { return static_cast<std::uint64_t>(value); };
    // 1 h into the week it is 1 h past Sunday's midnight, GPS time.
    const CalendarTime utc =
        GpsTime::from_week(week, epoch.of_week_ms * 1'000'000)
            .plus_nanoseconds(-epoch.leap_seconds * GpsTime::nanoseconds_per_second)
            .calendar();
    std::string payload =
        big(41, 1) + big(0, 2) + big(u(epoch.nav_type), 2) + big(week, 2) +
        big(u(epoch.of_week_ms), 4) + big(u(utc.year), 2) + big(u(utc.month), 1) +
        big(u(utc.day), 1) + big(u(utc.hour), 1) + big(u(utc.minute), 1) +
        big(u(utc.second * 1000 + utc.nanosecond / 1'000'000), 2) + big(0x1ff, 4) +
        big(u(epoch.latitude), 4) + big(u(epoch.longitude), 4) + big(u(epoch.ellipsoid_cm), 4) +
        big(u(epoch.sea_level_cm), 4) + big(u(epoch.datum), 1) + big(u(epoch.speed_cmps), 2) +
        big(u(epoch.course), 2) + big(0, 2) + big(u(epoch.climb_cmps), 2) + big(0, 2) +
        big(epoch.horizontal_error_cm, 4) + big(epoch.vertical_error_cm, 4) + big(0, 4) +
        big(u(epoch.velocity_error_cmps), 2) + std::string(24, '\0') + big(9, 1) + big(6, 1) +
        big(0, 1);
    EXPECT_EQ(payload.size(), 91u);
    if (epoch.locosys) payload += big(0, 4) + big(u(epoch.sdop), 1) + big(u(epoch.vsdop), 1);
    return payload;
}

const std::string identity = frame("\xfdROD,30003117,1,V1.4(B1)");
const std::string other = frame(std::string("\x0d\x03") + std::string(21, '\x11'));

std::string log_of(int count, Epoch epoch = {}) {
    std::string bytes = identity;
    for (int i = 0; i < count; ++i, epoch.of_week_ms += 1000) {
        bytes += frame(message(epoch));
        epoch.longitude -= 2300;
    }
    return bytes;
}

TEST(Sbn, IsRecognisedByItsFirstMessage) {
    EXPECT_TRUE(find_format("sbn")->recognises(log_of(1)));
    EXPECT_FALSE(find_format("sbn")->recognises("\x20" + log_of(1)));
    EXPECT_FALSE(find_format("sbn")->recognises(log_of(1).substr(0, 20)));
    EXPECT_FALSE(find_format("sbn")->recognises(std::string(200, '\xa0')));
}

TEST(Sbn, ReadsEveryField) {
    const std::string bytes =
        log_of(2) + other + frame(message({.nav_type = 0x86, .of_week_ms = 3'602'500}));
    const Observations read = import_text(sbn_receiver(), bytes);
    EXPECT_EQ(read.format, "sbn");
    EXPECT_EQ(read.device, "ROD, 30003117, 1, V1.4(B1)");
    EXPECT_EQ(read.instrument, (Instrument{.serial = "30003117", .firmware = "V1.4(B1)"}));
    EXPECT_EQ(read.time_scale, "gps");
    EXPECT_EQ(read.accuracy_source, "recording");
    EXPECT_EQ(*read.facts.first_epoch, GpsTime::from_week(week, 3'600'000'000'000));
    EXPECT_EQ(read.records.total, 5);
    EXPECT_EQ(read.records.bad, 0);
    ASSERT_EQ(read.rows.size(), 3u);
    const Observation& row = read.rows[0];
    EXPECT_EQ(row.source_byte, static_cast<std::int64_t>(identity.size()));
    EXPECT_EQ(row.fix, FixType::single);
    EXPECT_EQ(row.satellites, 9);
    EXPECT_NEAR(*row.latitude_deg, 54.321, 1e-12);
    EXPECT_NEAR(*row.longitude_deg, -1.3579, 1e-12);
    EXPECT_NEAR(*row.height_m, 60.12, 1e-12);  // above the ellipsoid, not the 12.34 above the sea
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, -15.0, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_up_m_s, 0.12, 1e-12);
    EXPECT_NEAR(*row.sigma_east_m, 2.80 / std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(*row.sigma_north_m, 2.80 / std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(*row.sigma_up_m, 4.50, 1e-12);
    EXPECT_NEAR(*row.sigma_recorded_velocity_north_m_s, 0.40, 1e-12);
    EXPECT_NEAR(*row.sigma_recorded_velocity_up_m_s, 0.70, 1e-12);
    EXPECT_EQ(read.rows[2].fix, FixType::dgps);
    EXPECT_EQ(read.rows[2].time.nanoseconds, 2'500'000'000);
}

TEST(Sbn, ZeroAndFullErrorsAreUnknown) {
    for (const std::uint64_t unknown : {0ull, 0xffffffffull, 0x7fffffffull}) {
        const Observation row =
            import_text(sbn_receiver(), frame(message({.horizontal_error_cm = unknown,
                                                       .vertical_error_cm = unknown,
                                                       .sdop = 255,
                                                       .vsdop = 0})))
                .rows[0];
        EXPECT_FALSE(row.sigma_east_m || row.sigma_up_m || row.sigma_recorded_velocity_east_m_s ||
                     row.sigma_recorded_velocity_up_m_s);
    }
    // EHVE is of both axes together, and goes before SDOP.
    const Observation row =
        import_text(sbn_receiver(), frame(message({.velocity_error_cmps = 20}))).rows[0];
    EXPECT_NEAR(*row.sigma_recorded_velocity_east_m_s, 0.20 / std::sqrt(2.0), 1e-12);
    const Observation standard =
        import_text(sbn_receiver(), frame(message({.locosys = false}))).rows[0];
    EXPECT_FALSE(standard.sigma_recorded_velocity_east_m_s);
}

TEST(Sbn, KindsOfFix) {
    const FixType kinds[] = {FixType::none,   FixType::dead_reckoning, FixType::dead_reckoning,
                             FixType::single, FixType::single,         FixType::single,
                             FixType::single, FixType::dead_reckoning};
    for (int type = 0; type < 8; ++type) {
        const Observation row =
            import_text(sbn_receiver(), frame(message({.nav_type = type}))).rows[0];
        EXPECT_EQ(row.fix, kinds[type]) << type;
        EXPECT_EQ(row.latitude_deg.has_value(), type != 0) << type;
    }
}

TEST(SbnLeapSecond, TimesAreOfGpsWhateverTheUtcSays) {
    Epoch epoch{.leap_seconds = 14};
    std::string bytes;
    for (int i = 0; i < 10; ++i, epoch.of_week_ms += 1000) {
        if (i == 6) epoch.leap_seconds = 16;
        bytes += frame(message(epoch));
    }
    const Observations read = import_text(sbn_receiver(), bytes);
    for (std::size_t i = 0; i < 10; ++i)
        EXPECT_EQ(read.rows[i].time.nanoseconds, static_cast<std::int64_t>(i) * 1'000'000'000);
    const std::string notes = noted(read);
    EXPECT_NE(
        notes.find("From byte 0 on the recorded UTC is 14 s behind GPS time where 16 s are right"),
        std::string::npos)
        << notes;
    EXPECT_NE(notes.find("From byte 630 on the recorded UTC has the right leap seconds, 16"),
              std::string::npos)
        << notes;
    EXPECT_EQ(noted(import_text(sbn_receiver(), log_of(5))), "");
}

TEST(SbnBad, DamagedMessagesAreCountedAndTheNextOneIsFound) {
    const std::string good = frame(message({}));
    std::string checksum = good;
    checksum[30] = static_cast<char>(checksum[30] ^ 1);
    std::string length = good;
    length[3] = static_cast<char>(length[3] + 1);
    const std::string bytes = log_of(5) + checksum + good + length + good + "rubbish" + good +
                              frame(message({.datum = 178})) + good + frame("\x29short") + good +
                              good.substr(0, 50);
    const Observations read = import_text(sbn_receiver(), bytes);
    EXPECT_EQ(read.rows.size(), 10u);
    EXPECT_EQ(read.records.total, 1 + 5 + 5 + 6);
    ASSERT_EQ(read.records.bad, 6);
    const std::vector<BadRecord>& bad = read.records.bad_records;
    EXPECT_EQ(bad[0].byte, static_cast<std::int64_t>(log_of(5).size()));
    const char* what[] = {"has a checksum", "or length that", "belong to no record",
                          "map datum 178",  "6 bytes long",   "cut off"};
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NE(bad[i].what.find(what[i]), std::string::npos) << bad[i].what;
}

TEST(SbnBad, RoomNeverWrittenIsNoRecord) {
    for (const char blank : {'\xff', '\0'})
        EXPECT_EQ(import_text(sbn_receiver(), log_of(3) + std::string(1000, blank)).records.bad, 0);
}

TEST(SbnBad, EveryTruncationEndsInRowsOrAMessage) {
    const std::string bytes = log_of(2);
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
        const std::string what = failure_of(sbn_receiver(), bytes.substr(0, size));
        EXPECT_EQ(what == "read", size >= identity.size() + 105) << size << what;
    }
}

TEST(SbnRoundTrip, GpsbabelReadsTheSame) {
    if (!gpsbabel_reads("sbn")) GTEST_SKIP() << "no gpsbabel that reads SBN";
    const std::string bytes = log_of(300, {.course = 12'345});
    const Observations ours = import_text(sbn_receiver(), bytes);
    const std::vector<ReferencePoint> theirs = gpsbabel_points("sbn", bytes);
    ASSERT_EQ(ours.rows.size(), 300u);
    ASSERT_EQ(ours.rows.size(), theirs.size());
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const Observation& row = ours.rows[i];
        EXPECT_NEAR(*row.latitude_deg, theirs[i].latitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.longitude_deg, theirs[i].longitude_deg, 0.51e-9);
        // gpsbabel takes the height above the sea, 47.78 m lower.
        EXPECT_NEAR(*row.height_m, theirs[i].altitude_m.value() + 47.78, 0.051);
        EXPECT_NEAR(std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s),
                    theirs[i].speed_m_s.value(), 0.0051);
        EXPECT_NEAR(std::remainder(std::atan2(*row.recorded_velocity_east_m_s,
                                              *row.recorded_velocity_north_m_s) *
                                           180.0 / M_PI -
                                       theirs[i].course_deg.value(),
                                   360.0),
                    0.0, 0.051);
        // gpsbabel takes the recorded UTC, which has the right leap seconds here.
        EXPECT_EQ(to_utc_iso(ours.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds), 0),
                  theirs[i].utc + "Z");
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
