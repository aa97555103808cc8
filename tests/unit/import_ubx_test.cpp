#include <cmath>

#include "import_ubx_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace ubx_test;

// The .pos of this walk was made from the same messages: its times are those of PVT's year to
// second and nano, in GPS time and cut to the millisecond. iTOW, the nominal time of the epoch,
// would be up to 0.46 ms later, and in the next millisecond.
TEST(Ubx, RealWalkIsItsPosToTheMillisecond) {
    const auto ubx = recorded("ubx_walk/rover.ubx");
    if (!ubx) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations walk = read_ubx(*ubx);
    const Observations pos = import_text(pos_receiver(), *recorded("ubx_walk/rover.pos"));
    EXPECT_EQ(walk.format, "ubx");
    EXPECT_EQ(walk.time_scale, "utc");
    EXPECT_EQ(walk.variant, "UBX with NAV-PVT");
    EXPECT_EQ(walk.accuracy_source, "recording");
    EXPECT_EQ(walk.records.total, 2328 + 536 + 536);  // RXM-SFRBX, RXM-RAWX, NAV-PVT
    EXPECT_EQ(walk.records.bad, 0);
    ASSERT_EQ(walk.rows.size(), 536u);
    ASSERT_EQ(pos.rows.size(), 536u);
    EXPECT_NEAR(walk.facts.nominal_interval_s, 0.25, 1e-6);
    EXPECT_EQ(to_utc_iso(instant(walk, 0), 9), "2025-08-28T17:30:21.749542955Z");
    EXPECT_EQ(to_iso(instant(pos, 0), 3), "2025-08-28T17:30:39.749");
    for (std::size_t i = 0; i < 536; ++i) {
        const Observation &a = walk.rows[i], &b = pos.rows[i];
        const std::int64_t later_ns = instant(walk, i).nanoseconds_since(instant(pos, i));
        EXPECT_TRUE(later_ns >= 0 && later_ns < 1'000'000) << i << ' ' << later_ns;
        EXPECT_NEAR(*a.latitude_deg, *b.latitude_deg, 1e-9) << i;
        EXPECT_NEAR(*a.longitude_deg, *b.longitude_deg, 1e-9) << i;
        // The .pos has the height above mean sea level, 21.39 m less geoid, for one above the
        // ellipsoid.
        EXPECT_NEAR(*b.height_m - *a.height_m, 21.387, 0.01) << i;
        EXPECT_EQ(a.fix, b.fix) << i;
        EXPECT_NEAR(*a.recorded_velocity_east_m_s, *b.recorded_velocity_east_m_s, 1e-9) << i;
        EXPECT_NEAR(*a.recorded_velocity_north_m_s, *b.recorded_velocity_north_m_s, 1e-9) << i;
        EXPECT_NEAR(*a.recorded_velocity_up_m_s, *b.recorded_velocity_up_m_s, 1e-9) << i;
        EXPECT_NEAR(*a.sigma_east_m, *b.sigma_east_m, 1e-6) << i;
    }
}

TEST(Ubx, PvtByHand) {
    const Observations read = read_ubx(pvt_frame(0) + pvt_frame(500));
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(to_utc_iso(instant(read, 0), 9), "2023-07-11T06:04:29.999999600Z");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 500'000'000);
    const Observation& row = read.rows[0];
    EXPECT_DOUBLE_EQ(*row.latitude_deg, 45.5);
    EXPECT_DOUBLE_EQ(*row.longitude_deg, 9.25);
    EXPECT_DOUBLE_EQ(*row.height_m, 167.75);
    EXPECT_EQ(row.satellites, 14);
    EXPECT_EQ(row.fix, FixType::single);
    EXPECT_DOUBLE_EQ(*row.sigma_east_m, 1.5 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*row.sigma_up_m, 2.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_north_m_s, 3.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_east_m_s, -4.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_up_m_s, -0.5);
    EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_up_m_s, 0.3 / std::sqrt(3.0));
    EXPECT_EQ(row.source_byte, 0);
    EXPECT_EQ(read.rows[1].source_byte, 100);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.0111, 1e-4);
    EXPECT_DOUBLE_EQ(*read.facts.time_resolution_s, 1e-9);
    // Protocol versions up to 14 have 84 bytes, and nothing to say about flags3.
    EXPECT_EQ(read_ubx(frame(1, 7, pvt(0, 84).put(78, 1, 1).bytes())).rows[0].fix, FixType::single);
}

TEST(Ubx, HighPrecisionPositionAndCovariancesOfTheEpoch) {
    const Observations read =
        read_ubx(frame(1, 0x14, hpposllh(0).bytes()) + pvt_frame(0) +
                 frame(1, 0x36, cov(0).bytes()) + frame(1, 0x04, std::string(18, '\0')) +
                 pvt_frame(500) + frame(1, 0x14, hpposllh(500).put(3, 1, 1).bytes()) +
                 frame(1, 0x36, cov(500).put(5, 0, 2).bytes()) + pvt_frame(750));
    ASSERT_EQ(read.rows.size(), 3u);
    EXPECT_EQ(read.records.total, 8);
    EXPECT_EQ(read.variant, "UBX with NAV-PVT, NAV-HPPOSLLH, NAV-COV");
    const Observation& row = read.rows[0];
    EXPECT_DOUBLE_EQ(*row.latitude_deg, 45.500000242);
    EXPECT_DOUBLE_EQ(*row.longitude_deg, 9.250000063);
    EXPECT_DOUBLE_EQ(*row.height_m, 167.7501);
    EXPECT_DOUBLE_EQ(*row.sigma_east_m, 3.0);
    EXPECT_DOUBLE_EQ(*row.sigma_north_m, 2.0);
    EXPECT_DOUBLE_EQ(*row.sigma_up_m, 4.0);
    EXPECT_DOUBLE_EQ(*row.correlation_east_north, 1.0 / 6.0);
    EXPECT_DOUBLE_EQ(*row.correlation_east_up, -2.0 / 12.0);
    EXPECT_DOUBLE_EQ(*row.correlation_north_up, 0.5 / 8.0);
    EXPECT_NEAR(*row.sigma_recorded_velocity_east_m_s, 0.3, 1e-8);
    EXPECT_NEAR(*row.sigma_recorded_velocity_north_m_s, 0.2, 1e-8);
    // Where they are marked invalid, PVT's own count.
    EXPECT_DOUBLE_EQ(*read.rows[1].longitude_deg, 9.25);
    EXPECT_DOUBLE_EQ(*read.rows[1].sigma_east_m, 1.5 / std::sqrt(2.0));
    EXPECT_FALSE(read.rows[1].correlation_east_north);
    EXPECT_DOUBLE_EQ(*read.rows[1].sigma_recorded_velocity_east_m_s, 0.3 / std::sqrt(3.0));
}

TEST(Ubx, AccuracyOfHighPrecisionPosition) {
    const Observations read = read_ubx(pvt_frame() + frame(1, 0x14, hpposllh().bytes()));
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_east_m, 0.0141 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_up_m, 0.0255);
    EXPECT_NEAR(*read.facts.position_resolution_m, 1.11e-4, 1e-6);
}

struct Flags {
    const char* name;
    int type, flags, flags3;
    FixType fix;
};
class UbxFix : public testing::TestWithParam<Flags> {};

TEST_P(UbxFix, IsTheKindOfSolution) {
    const Flags& flags = GetParam();
    const Observation row = read_ubx(frame(1, 7,
                                           pvt()
                                               .put(20, flags.type, 1)
                                               .put(21, flags.flags, 1)
                                               .put(78, flags.flags3, 1)
                                               .bytes()))
                                .rows.at(0);
    EXPECT_EQ(row.fix, flags.fix);
    EXPECT_EQ(row.latitude_deg.has_value(), flags.fix != FixType::none);
    EXPECT_EQ(row.recorded_velocity_east_m_s.has_value(), flags.fix != FixType::none);
}

INSTANTIATE_TEST_SUITE_P(All, UbxFix,
                         testing::Values(Flags{"none", 0, 0x01, 0, FixType::none},
                                         Flags{"dead_reckoning", 1, 0x01, 0,
                                               FixType::dead_reckoning},
                                         Flags{"plane", 2, 0x01, 0, FixType::single},
                                         Flags{"space", 3, 0x01, 0, FixType::single},
                                         Flags{"corrected", 3, 0x03, 0, FixType::dgps},
                                         Flags{"floating", 3, 0x43, 0, FixType::float_ambiguities},
                                         Flags{"fixed", 3, 0x83, 0, FixType::fixed},
                                         Flags{"combined", 4, 0x83, 0, FixType::dead_reckoning},
                                         Flags{"time", 5, 0x01, 0, FixType::none},
                                         Flags{"masked", 3, 0x82, 0, FixType::none},
                                         Flags{"invalid", 3, 0x01, 1, FixType::none}),
                         [](const auto& instance) { return instance.param.name; });

TEST(Ubx, UnknownAccuracyIsEmpty) {
    const Observation row =
        read_ubx(frame(1, 7, pvt().put(40, 0, 4).put(44, -1, 4).put(68, -1, 4).bytes())).rows[0];
    EXPECT_FALSE(row.sigma_east_m || row.sigma_up_m || row.sigma_recorded_velocity_east_m_s);
    const Observation infinite =
        read_ubx(pvt_frame() + frame(1, 0x36, cov().real(16, INFINITY).real(40, NAN).bytes()))
            .rows[0];
    EXPECT_DOUBLE_EQ(*infinite.sigma_east_m, 1.5 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*infinite.sigma_recorded_velocity_east_m_s, 0.3 / std::sqrt(3.0));
}

TEST(Ubx, OldReceiversWithoutPvt) {
    const auto tow = [](Payload payload) { return payload.put(0, first_tow_ms, 4); };
    const Payload posllh = tow(Payload(28))
                               .put(4, 92'500'000, 4)
                               .put(8, 455'000'000, 4)
                               .put(12, 167'750, 4)
                               .put(20, 3'000, 4)
                               .put(24, 5'000, 4);
    const Payload sol = tow(Payload(52)).put(10, 3, 1).put(11, 0x0f, 1).put(47, 9, 1);
    const Payload velned =
        tow(Payload(36)).put(4, 300, 4).put(8, -400, 4).put(12, 50, 4).put(28, 30, 4);
    const Payload timeutc = tow(Payload(20))
                                .put(8, -400, 4)
                                .put(12, 2023, 2)
                                .put(14, 7, 1)
                                .put(15, 11, 1)
                                .put(16, 6, 1)
                                .put(17, 4, 1)
                                .put(18, 30, 1)
                                .put(19, 7, 1);
    const std::string position = frame(1, 2, posllh.bytes());
    const std::string rest = frame(1, 0x12, velned.bytes()) + frame(1, 0x21, timeutc.bytes());
    const Observations read = read_ubx(position + frame(1, 6, sol.bytes()) + rest);
    ASSERT_EQ(read.rows.size(), 1u);
    const Observation& row = read.rows[0];
    EXPECT_EQ(to_utc_iso(instant(read, 0), 9), "2023-07-11T06:04:29.999999600Z");
    EXPECT_DOUBLE_EQ(*row.latitude_deg, 45.5);
    EXPECT_DOUBLE_EQ(*row.height_m, 167.75);
    EXPECT_DOUBLE_EQ(*row.sigma_up_m, 5.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_east_m_s, -4.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_up_m_s, -0.5);
    EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_up_m_s, 0.3 / std::sqrt(3.0));
    EXPECT_EQ(row.fix, FixType::dgps);
    EXPECT_EQ(row.satellites, 9);
    EXPECT_TRUE(has_note(read, "no NAV-PVT"));
    EXPECT_EQ(read_ubx(position + rest).rows[0].fix, FixType::unknown);
}

TEST(Ubx, RawMeasurementsAloneAreRefusedInWords) {
    const std::string message =
        failure_of(pos_receiver(), frame(0x02, 0x15, std::string(48, '\x11')));
    EXPECT_NE(message.find("raw measurements (1 RXM-RAWX) and no NAV-PVT"), std::string::npos);
    EXPECT_NE(message.find("convbin"), std::string::npos);
    EXPECT_NE(failure_of(pos_receiver(), frame(0x01, 0x35, std::string(8, '\0'))).find("NAV-PVT"),
              std::string::npos);
}

TEST(Ubx, PositionsMayBeInTheNmeaSentences) {
    const std::string rmc =
        "$GNRMC,003956.00,A,4552.65403,S,17030.00668,E,0.025,,120419,,,A,V*07\r\n";
    EXPECT_EQ(read_ubx(frame(0x02, 0x15, std::string(48, '\x11')) + rmc).format, "nmea");
    EXPECT_EQ(read_ubx(rmc + pvt_frame()).format, "ubx");
}

TEST(Ubx, VersionNamesTheDevice) {
    std::string version(40 + 60, '\0');
    version.replace(0, 8, "EXT CORE").replace(30, 8, "00190000");
    version.replace(40, 14, "FWVER=HPG 1.13").replace(70, 11, "MOD=ZED-F9P");
    EXPECT_EQ(read_ubx(frame(0x0a, 0x04, version) + pvt_frame()).device,
              "u-blox ZED-F9P, firmware HPG 1.13");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
