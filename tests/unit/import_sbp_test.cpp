#include <cmath>
#include <cstdint>

#include "gpsbabel_support.h"
#include "import_test_support.h"
#include "stages/import/format.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver sbp_receiver() {
    Receiver receiver = pos_receiver();
    receiver.format = "sbp";
    return receiver;
}

/// A record as a logger has it; unset ones are of a craft going east at 20 m/s.
struct Fix {
    int satellites = 9;
    CalendarTime utc{2019, 4, 12, 0, 39, 56, 0};
    int milliseconds = 0;  ///< of the second
    std::int32_t latitude = -458'775'671;
    std::int32_t longitude = 1'705'001'113;
    std::int32_t height_cm = 1420;
    int speed_cmps = 2000;
    int course = 9000;
    int climb_cmps = -7;
    int sdop = 31;
    int vsdop = 55;
};

std::string little(std::uint64_t value, int size) {
    std::string bytes;
    for (int i = 0; i < size; ++i)
        bytes += static_cast<char>(value >> (8 * i) & 255);
    return bytes;
}

std::string record(const Fix& fix) {
    const CalendarTime& t = fix.utc;
    const int packed_date = ((t.year - 2000) * 12 + t.month) << 5 | t.day;
    const std::uint64_t packed =
        static_cast<std::uint64_t>(packed_date) << 17 |
        static_cast<std::uint64_t>(t.hour << 12 | t.minute << 6 | t.second);
    const auto u = [](auto value) { return static_cast<std::uint64_t>(value); };
    return little(5, 1) + little(u(fix.satellites), 1) +
           little(u(t.second * 1000 + fix.milliseconds), 2) + little(packed, 4) + little(0x1ff, 4) +
           little(u(fix.latitude), 4) + little(u(fix.longitude), 4) + little(u(fix.height_cm), 4) +
           little(u(fix.speed_cmps), 2) + little(u(fix.course), 2) + little(u(fix.climb_cmps), 2) +
           little(u(fix.sdop), 1) + little(u(fix.vsdop), 1);
}

std::string header(const std::string& id = "GT-31,30003117,1,V1.4") {
    std::string message = "\xa0\xa2";
    message += static_cast<char>(0);
    message += static_cast<char>(id.size() + 1);
    message += '\xfd';
    message += id;
    std::string bytes = little(message.size() + 2, 2) + message;
    bytes.resize(64, '\xff');
    return bytes;
}

/// So many records, `step_ms` apart, moving with their speed along the parallel.
std::string log_of(int count, int step_ms = 1000, Fix fix = {}) {
    std::string bytes = header();
    const double degrees_per_m =
        1.0 / (111'412.84 * std::cos(45.8775671 * M_PI / 180.0));  // WGS 84, at that latitude
    const std::int32_t start = fix.longitude;
    int ms = fix.utc.second * 1000;
    for (int i = 0; i < count; ++i, ms += step_ms) {
        fix.utc.minute = 39 + ms / 60'000;
        fix.utc.second = ms / 1000 % 60;
        fix.milliseconds = ms % 1000;
        fix.longitude = start + static_cast<std::int32_t>(std::lround(
                                    fix.speed_cmps * 1e-5 * step_ms * i * degrees_per_m * 1e7));
        bytes += record(fix);
    }
    return bytes;
}

TEST(Sbp, IsRecognisedByItsHeader) {
    EXPECT_TRUE(find_format("sbp")->recognises(log_of(1)));
    EXPECT_TRUE(find_format("sbp")->recognises(header()));
    EXPECT_FALSE(find_format("sbp")->recognises(header().substr(0, 63)));
    EXPECT_FALSE(find_format("sbp")->recognises(header().substr(2) + log_of(1)));  // that is SBN
    EXPECT_FALSE(find_format("sbp")->recognises(std::string(200, '\xa0')));
}

TEST(Sbp, ReadsEveryField) {
    const Observations read = import_text(sbp_receiver(), log_of(3, 200));
    EXPECT_EQ(read.format, "sbp");
    EXPECT_EQ(read.variant, "SBP with SDOP");
    EXPECT_EQ(read.device, "GT-31, 30003117, 1, V1.4");
    // Its first field is what its owner calls it.
    EXPECT_EQ(read.instrument, (Instrument{.serial = "30003117", .firmware = "V1.4"}));
    for (const char* id : {"", "GT-31", "a,b,c", "a,b,c,d,e"})
        EXPECT_FALSE(import_text(sbp_receiver(), header(id) + log_of(3, 200).substr(64)).instrument)
            << id;
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.accuracy_source, "none");
    EXPECT_EQ(*read.facts.first_epoch, gps_from_utc({2019, 4, 12, 0, 39, 56, 0}));
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 0.2);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.0111, 1e-4);
    EXPECT_EQ(*read.facts.time_resolution_s, 1e-3);
    EXPECT_EQ(read.records.total, 3);
    EXPECT_EQ(read.records.bad, 0);
    ASSERT_EQ(read.rows.size(), 3u);
    const Observation& row = read.rows[1];
    EXPECT_EQ(row.time.nanoseconds, 200'000'000);
    EXPECT_EQ(row.source_byte, 64 + 32);
    EXPECT_FALSE(row.source_line);
    EXPECT_EQ(row.satellites, 9);
    EXPECT_EQ(row.fix, FixType::unknown);
    EXPECT_NEAR(*row.latitude_deg, -45.8775671, 1e-12);
    EXPECT_NEAR(*row.height_m, 14.20, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, 20.0, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, 0.0, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_up_m_s, -0.07, 1e-12);
    // SDOP is of the speed alone: each axis has all of it.
    EXPECT_NEAR(*row.sigma_recorded_velocity_east_m_s, 0.31, 1e-12);
    EXPECT_NEAR(*row.sigma_recorded_velocity_north_m_s, 0.31, 1e-12);
    EXPECT_NEAR(*row.sigma_recorded_velocity_up_m_s, 0.55, 1e-12);
}

TEST(Sbp, SaturatedAndZeroSdopAreUnknown) {
    const std::string bytes = header() + record({.sdop = 255, .vsdop = 255}) +
                              record({.utc = {2019, 4, 12, 0, 39, 57}, .sdop = 0, .vsdop = 0}) +
                              record({.utc = {2019, 4, 12, 0, 39, 58}, .sdop = 254, .vsdop = 1});
    const Observations read = import_text(sbp_receiver(), bytes);
    for (const int i : {0, 1}) {
        const Observation& row = read.rows[static_cast<std::size_t>(i)];
        EXPECT_TRUE(row.recorded_velocity_east_m_s);
        EXPECT_FALSE(row.sigma_recorded_velocity_east_m_s ||
                     row.sigma_recorded_velocity_north_m_s || row.sigma_recorded_velocity_up_m_s);
    }
    EXPECT_NEAR(*read.rows[2].sigma_recorded_velocity_east_m_s, 2.54, 1e-12);
    EXPECT_NEAR(*read.rows[2].sigma_recorded_velocity_up_m_s, 0.01, 1e-12);
}

TEST(Sbp, FlagsOfLoggersWithoutSdopAreNoAccuracy) {
    const std::string bytes = header() + record({.sdop = 1, .vsdop = 0x14}) +
                              record({.utc = {2019, 4, 12, 0, 39, 57}, .sdop = 0, .vsdop = 0});
    const Observations read = import_text(sbp_receiver(), bytes);
    EXPECT_EQ(read.variant, "SBP without SDOP");
    for (const Observation& row : read.rows)
        EXPECT_FALSE(row.sigma_recorded_velocity_east_m_s || row.sigma_recorded_velocity_up_m_s);
    EXPECT_NE(noted(read).find("no accuracy of speed"), std::string::npos);
}

TEST(Sbp, WithoutSatellitesThereIsNoPosition) {
    const std::string bytes =
        header() + record({.satellites = 0}) + record({.utc = {2019, 4, 12, 0, 39, 57}});
    const Observations read = import_text(sbp_receiver(), bytes);
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.rows[0].fix, FixType::none);
    EXPECT_FALSE(read.rows[0].latitude_deg || read.rows[0].recorded_velocity_east_m_s);
    EXPECT_TRUE(read.rows[1].latitude_deg);
    // A logger that never fills in the count says nothing by a zero.
    const Observations uncounted = import_text(sbp_receiver(), log_of(2, 1000, {.satellites = 0}));
    EXPECT_TRUE(uncounted.rows[0].latitude_deg);
    EXPECT_FALSE(uncounted.rows[0].satellites);
}

TEST(Sbp, MonthDecemberAndRoundedMilliseconds) {
    Fix december{.utc = {2018, 12, 31, 23, 59, 59}};
    december.milliseconds = 1000;  // rounded up from 59.9996 s
    const Observations up = import_text(sbp_receiver(), header() + record(december));
    EXPECT_EQ(*up.facts.first_epoch, gps_from_utc({2019, 1, 1, 0, 0, 0, 0}));
    Fix rounded_down{.utc = {2019, 1, 1, 0, 0, 0}};
    rounded_down.milliseconds = -1;  // 65535
    const Observations down = import_text(sbp_receiver(), header() + record(rounded_down));
    EXPECT_EQ(*down.facts.first_epoch, gps_from_utc({2018, 12, 31, 23, 59, 59, 999'000'000}));
}

TEST(SbpBad, RecordsAreCountedByPlace) {
    std::string bytes = log_of(9);
    bytes.replace(64 + 32 + 4, 4, std::string(4, '\xff'));   // month 1023, hour 31
    bytes.replace(64 + 64 + 12, 4, little(910'000'000, 4));  // latitude 91
    bytes.replace(64 + 96 + 2, 2, little(12'345, 2));        // no such second
    const Observations read = import_text(sbp_receiver(), bytes + record({}).substr(0, 31));
    EXPECT_EQ(read.records.total, 10);
    EXPECT_EQ(read.records.bad, 4);
    ASSERT_EQ(read.records.bad_records.size(), 4u);
    EXPECT_EQ(read.records.bad_records[0].byte, 96);
    EXPECT_EQ(read.records.bad_records[0].epoch, 1);
    EXPECT_NE(read.records.bad_records[1].what.find("91"), std::string::npos);
    EXPECT_NE(read.records.bad_records[2].what.find("12345 ms"), std::string::npos);
    EXPECT_NE(read.records.bad_records[3].what.find("31 bytes of 32"), std::string::npos);
}

TEST(SbpBad, RoomNeverWrittenIsNoRecord) {
    for (const char blank : {'\xff', '\0'}) {
        const Observations read =
            import_text(sbp_receiver(), log_of(4) + std::string(32 * 5 + 7, blank));
        EXPECT_EQ(read.records.total, 4);
        EXPECT_EQ(read.records.bad, 0);
    }
}

TEST(SbpBad, EveryTruncationEndsInRowsOrAMessage) {
    const std::string bytes = log_of(3);
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
        const std::string what = failure_of(sbp_receiver(), bytes.substr(0, size));
        EXPECT_EQ(what == "read", size >= 64 + 32) << size << what;
    }
}

// The receiver's UTC ran 1 s ahead until it received the leap second.
TEST(SbpLeapSecond, StepBackIsNotedWithItsPlaceAndLeft) {
    std::string bytes = log_of(5);
    Fix late{.utc = {2019, 4, 12, 0, 40, 0}};  // again: 5 records led up to 0:40:00
    for (int i = 0; i < 5; ++i, ++late.utc.second)
        bytes += record(late);
    const Observations read = import_text(sbp_receiver(), bytes);
    EXPECT_EQ(read.rows[5].time.nanoseconds, read.rows[4].time.nanoseconds);
    EXPECT_NE(noted(read).find("jumps back by 1 s between the records at byte 192 and byte 224"),
              std::string::npos)
        << noted(read);
}

TEST(SbpLeapSecond, StepAheadIsTheOneThatTheMovementDenies) {
    const auto with_step = [](int missing_metres) {
        Fix fix{.sdop = 31};
        std::string bytes = header();
        for (int i = 0; i < 8; ++i) {
            fix.utc = {2019, 4, 12, 0, 40, i + (i > 4 ? 1 : 0)};
            bytes += record(fix);
            fix.longitude += 2578 + (i == 4 ? missing_metres * 129 : 0);  // 20 m
        }
        return bytes;
    };
    EXPECT_NE(noted(import_text(sbp_receiver(), with_step(0)))
                  .find("jumps ahead by 1 s between the records at byte 192 and byte 224"),
              std::string::npos);
    // 40 m in the 2 s stamped: a record is missing, and nothing is wrong with the times.
    EXPECT_EQ(noted(import_text(sbp_receiver(), with_step(20))).find("jumps"), std::string::npos);
}

TEST(SbpLeapSecond, RepeatedRecordIsNone) {
    const std::string bytes =
        log_of(5) + log_of(5).substr(64 + 32 * 4) + log_of(8).substr(64 + 32 * 5);
    EXPECT_EQ(noted(import_text(sbp_receiver(), bytes)).find("jumps"), std::string::npos);
}

TEST(SbpRoundTrip, GpsbabelReadsTheSame) {
    if (!gpsbabel_reads("sbp")) GTEST_SKIP() << "no gpsbabel that reads SBP";
    const std::string bytes = log_of(500, 200, {.course = 12'345});
    const Observations ours = import_text(sbp_receiver(), bytes);
    const std::vector<ReferencePoint> theirs = gpsbabel_points("sbp", bytes);
    ASSERT_EQ(ours.rows.size(), theirs.size());
    ASSERT_EQ(ours.rows.size(), 500u);
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const Observation& row = ours.rows[i];
        EXPECT_NEAR(*row.latitude_deg, theirs[i].latitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.longitude_deg, theirs[i].longitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.height_m, theirs[i].altitude_m.value(), 0.051);
        EXPECT_NEAR(std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s),
                    theirs[i].speed_m_s.value(), 0.0051);
        const std::string utc = to_utc_iso(
            ours.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds), i % 5 == 0 ? 0 : 3);
        EXPECT_EQ(utc, theirs[i].utc + "Z");
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
