#include <cmath>

#include "core/geodesy.h"
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

std::int64_t at(std::string_view payload, std::size_t byte, std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
        value |= std::uint64_t{static_cast<unsigned char>(payload[byte + i])} << (8 * i);
    return size == 4 ? static_cast<std::int32_t>(value) : static_cast<std::int64_t>(value);
}

std::int64_t in_cm(std::int64_t mm) {
    return std::llround(static_cast<double>(mm) / 10.0);
}

/// What a receiver from before PVT would have sent at the instant of a PVT.
struct OldMessages {
    std::string posllh, velned, sol, timegps;
};

OldMessages old_messages(std::string_view pvt, const GpsTime& when) {
    const std::int64_t tow_ms = at(pvt, 0, 4);
    const std::int64_t week = when.nanoseconds_since(GpsTime()) / GpsTime::nanoseconds_per_week;
    const auto rest_ns =
        static_cast<std::int32_t>(when.nanoseconds_since(GpsTime()) -
                                  week * GpsTime::nanoseconds_per_week - tow_ms * 1'000'000);
    const Geodetic place{
        .latitude = Angle::from_degrees(static_cast<double>(at(pvt, 28, 4)) / 1e7),
        .longitude = Angle::from_degrees(static_cast<double>(at(pvt, 24, 4)) / 1e7),
        .height_m = static_cast<double>(at(pvt, 32, 4)) / 1e3};
    const Eigen::Vector3d ecef_m = ecef_from_geodetic(place).m;
    const Eigen::Vector3d enu_m_s(static_cast<double>(at(pvt, 52, 4)) / 1e3,
                                  static_cast<double>(at(pvt, 48, 4)) / 1e3,
                                  -static_cast<double>(at(pvt, 56, 4)) / 1e3);
    const Eigen::Vector3d ecef_m_s =
        rotation_enu_from_ecef(place.latitude, place.longitude).transpose() * enu_m_s;
    Payload posllh(28), velned(36), sol(52), timegps(16);
    posllh.put(0, tow_ms, 4);
    for (std::size_t byte = 24; byte < 48; byte += 4)
        posllh.put(byte - 20, at(pvt, byte, 4), 4);
    velned.put(0, tow_ms, 4).put(28, in_cm(at(pvt, 68, 4)), 4);
    sol.put(0, tow_ms, 4).put(4, rest_ns, 4).put(8, week, 2).put(10, pvt[20], 1);
    sol.put(11, (pvt[21] & 3) | 12, 1).put(24, 300, 4).put(47, pvt[23], 1);
    for (std::size_t i = 0; i < 3; ++i) {
        velned.put(4 + 4 * i, in_cm(at(pvt, 48 + 4 * i, 4)), 4);
        const auto axis = static_cast<Eigen::Index>(i);
        sol.put(12 + 4 * i, std::llround(100.0 * ecef_m[axis]), 4);
        sol.put(28 + 4 * i, std::llround(100.0 * ecef_m_s[axis]), 4);
    }
    timegps.put(0, tow_ms, 4).put(4, rest_ns, 4).put(8, week, 2).put(11, 7, 1);
    return {.posllh = frame(1, 2, posllh.bytes()),
            .velned = frame(1, 0x12, velned.bytes()),
            .sol = frame(1, 6, sol.bytes()),
            .timegps = frame(1, 0x20, timegps.bytes())};
}

/// The walk as older receivers would have recorded it.
struct OldWalk {
    Observations by_pvt;
    std::string with_posllh, with_timegps, of_solutions;
};

std::optional<OldWalk> old_walk() {
    const auto bytes = recorded("ubx_walk/rover.ubx");
    if (!bytes) return std::nullopt;
    OldWalk walk{
        .by_pvt = read_ubx(*bytes), .with_posllh = {}, .with_timegps = {}, .of_solutions = {}};
    for (std::size_t i = 0; i < walk.by_pvt.rows.size(); ++i) {
        const auto start = static_cast<std::size_t>(*walk.by_pvt.rows[i].source_byte) + 6;
        const OldMessages old =
            old_messages(std::string_view(*bytes).substr(start, 92), instant(walk.by_pvt, i));
        walk.with_posllh += old.posllh + old.sol + old.velned;
        walk.with_timegps += old.posllh + old.velned + old.timegps;
        walk.of_solutions += old.sol;
    }
    return walk;
}

TEST(UbxRecorded, OldMessagesAreTheSameWalk) {
    const auto walk = old_walk();
    if (!walk) GTEST_SKIP() << "RUNCERT_DATA is not set";
    for (const std::string* bytes : {&walk->with_posllh, &walk->with_timegps}) {
        const Observations read = read_ubx(*bytes);
        EXPECT_EQ(read.time_scale, "gps");
        ASSERT_EQ(read.rows.size(), 536U);
        for (std::size_t i = 0; i < read.rows.size(); ++i) {
            const Observation &a = walk->by_pvt.rows[i], &b = read.rows[i];
            ASSERT_EQ(instant(walk->by_pvt, i), instant(read, i)) << i;
            ASSERT_DOUBLE_EQ(*a.latitude_deg, *b.latitude_deg) << i;
            ASSERT_DOUBLE_EQ(*a.longitude_deg, *b.longitude_deg) << i;
            ASSERT_DOUBLE_EQ(*a.height_m, *b.height_m) << i;
            ASSERT_DOUBLE_EQ(*a.sigma_east_m, *b.sigma_east_m) << i;
            ASSERT_NEAR(*a.recorded_velocity_east_m_s, *b.recorded_velocity_east_m_s, 0.0051);
            ASSERT_NEAR(*a.recorded_velocity_up_m_s, *b.recorded_velocity_up_m_s, 0.0051);
        }
    }
    EXPECT_EQ(read_ubx(walk->with_posllh).variant, "UBX with NAV-POSLLH, NAV-VELNED, NAV-SOL");
    EXPECT_EQ(read_ubx(walk->with_timegps).rows[0].fix, FixType::unknown);
}

TEST(UbxRecorded, SolutionsAloneAreTheWalkToACentimetre) {
    const auto walk = old_walk();
    if (!walk) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = read_ubx(walk->of_solutions);
    ASSERT_EQ(read.rows.size(), 536U);
    EXPECT_TRUE(has_note(read, "Positions of NAV-SOL, in whole centimetres"));
    for (std::size_t i = 0; i < read.rows.size(); ++i) {
        const Observation &a = walk->by_pvt.rows[i], &b = read.rows[i];
        ASSERT_EQ(instant(walk->by_pvt, i), instant(read, i)) << i;
        ASSERT_NEAR(*a.latitude_deg, *b.latitude_deg, 1e-7) << i;
        ASSERT_NEAR(*a.longitude_deg, *b.longitude_deg, 1.3e-7) << i;
        ASSERT_NEAR(*a.height_m, *b.height_m, 0.01) << i;
        ASSERT_NEAR(*a.recorded_velocity_east_m_s, *b.recorded_velocity_east_m_s, 0.01) << i;
        ASSERT_NEAR(*a.recorded_velocity_north_m_s, *b.recorded_velocity_north_m_s, 0.01) << i;
        ASSERT_NEAR(*a.recorded_velocity_up_m_s, *b.recorded_velocity_up_m_s, 0.01) << i;
        // 3 m of three coordinates together.
        ASSERT_NEAR(*b.sigma_up_m, std::sqrt(3.0), 1e-12);
        ASSERT_NEAR(*b.sigma_east_m, std::sqrt(3.0), 1e-12);
    }
}

TEST(Ubx, StatusIsTheFixWhereThereIsNoSolution) {
    const Payload posllh = Payload(28).put(0, first_tow_ms, 4).put(8, 455'000'000, 4);
    const Payload timegps = Payload(16).put(0, first_tow_ms, 4).put(8, 2270, 2).put(11, 7, 1);
    const std::string rest = frame(1, 2, posllh.bytes()) + frame(1, 0x20, timegps.bytes());
    const auto fix_with = [&](int type, int flags) {
        const Payload status = Payload(16).put(0, first_tow_ms, 4).put(4, type, 1).put(5, flags, 1);
        return read_ubx(frame(1, 3, status.bytes()) + rest).rows.at(0).fix;
    };
    EXPECT_EQ(fix_with(3, 0x0d), FixType::single);
    EXPECT_EQ(fix_with(3, 0x0f), FixType::dgps);
    EXPECT_EQ(fix_with(3, 0x0c), FixType::none);
    EXPECT_EQ(fix_with(1, 0x0d), FixType::dead_reckoning);
    EXPECT_EQ(to_iso(*read_ubx(rest).facts.first_epoch, 3), "2023-07-11T06:04:48.000");
}

TEST(Ubx, PositionsWithoutDateAndUnknownTimesAreRefusedInWords) {
    const std::string posllh =
        frame(1, 2, Payload(28).put(0, first_tow_ms, 4).put(8, 455'000'000, 4).bytes());
    EXPECT_TRUE(has(failure_of(pos_receiver(), posllh), "nothing that says their date"));
    EXPECT_TRUE(has(failure_of(pos_receiver(), posllh), "Switch UBX-NAV-SOL on"));
    const std::string timeless =
        frame(1, 0x20, Payload(16).put(0, first_tow_ms, 4).put(8, 2270, 2).put(11, 1, 1).bytes());
    EXPECT_TRUE(has(failure_of(pos_receiver(), posllh + timeless), "the receiver knew the time"));
    const std::string far =
        frame(1, 6, Payload(52).put(0, first_tow_ms, 4).put(10, 3, 1).put(11, 13, 1).bytes());
    EXPECT_TRUE(has(failure_of(pos_receiver(), far), "0 km from the centre of the Earth"));
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

TEST(Ubx, InstrumentIsWhatVersionAndIdentitySay) {
    const auto version = [](const std::string& software, const std::string& hardware,
                            const std::vector<std::string>& extensions) {
        std::string payload = software + std::string(30 - software.size(), '\0') + hardware +
                              std::string(10 - hardware.size(), '\0');
        for (const std::string& each : extensions)
            payload += each + std::string(30 - each.size(), '\0');
        return frame(0x0a, 0x04, payload);
    };
    const std::string f9p =
        version("EXT CORE 1.00 (3fda8e)", "00190000",
                {"ROM BASE 0x118B2060", "FWVER=HPG 1.12", "PROTVER=27.11", "MOD=ZED-F9P"});
    const std::string identity =
        frame(0x27, 0x03, std::string("\x01\0\0\0\xf9\x0a\x00\x3b\x7e", 9));
    const Instrument expected{
        .make = "u-blox", .model = "ZED-F9P", .serial = "F90A003B7E", .firmware = "HPG 1.12"};
    EXPECT_EQ(read_ubx(f9p + identity + pvt_frame()).instrument, expected);
    EXPECT_EQ(read_ubx(identity + pvt_frame() + f9p).instrument, expected);
    // Its hardware version is no model; its software's version is that of its firmware.
    EXPECT_EQ(read_ubx(version("7.03 (45969)", "00040007", {}) + pvt_frame()).instrument,
              (Instrument{.make = "u-blox", .firmware = "7.03 (45969)"}));
    EXPECT_EQ(read_ubx(frame(0x27, 0x03, std::string("\x02\0\0\0\1\2\3\4\5\6", 10)) + pvt_frame())
                  .instrument,
              (Instrument{.make = "u-blox", .serial = "010203040506"}));
    // Truncated, of an unknown version or empty: no serial number is read.
    for (const std::string& odd : {std::string("\x01\0\0\0\xf9\x0a", 6),
                                   std::string("\x07\0\0\0\1\2\3\4\5\6", 10), std::string()})
        EXPECT_EQ(read_ubx(frame(0x27, 0x03, odd) + pvt_frame()).instrument->serial, "");
    EXPECT_FALSE(read_ubx(pvt_frame()).instrument);
}

// NAV-PVT off, and what says date and fix type once a second.
TEST(UbxWithoutPvt, HpposllhIsDatedByTimegpsAndItsFixTypeIsThatOfTheSecondsStatus) {
    std::string text;
    for (int i = 0; i < 30; ++i) {
        const int ms = 100 * i;
        text += frame(1, 0x14, hpposllh(ms).bytes());
        text +=
            frame(1, 0x12,
                  Payload(36).put(0, first_tow_ms + ms, 4).put(8, 2000, 4).put(28, 5, 4).bytes());
        if (i % 10 != 5) continue;
        text += frame(1, 0x20,
                      Payload(16)
                          .put(0, first_tow_ms + ms, 4)
                          .put(8, 2270, 2)
                          .put(10, 18, 1)
                          .put(11, 7, 1)
                          .bytes());
        text += frame(1, 3,
                      Payload(16)
                          .put(0, first_tow_ms + ms, 4)
                          .put(4, 3, 1)
                          .put(5, 0x0f, 1)
                          .put(7, 0x80, 1)
                          .bytes());
    }
    const Observations read = read_ubx(text);
    ASSERT_EQ(read.rows.size(), 30U);
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2023-07-11T06:04:30.000Z");
    EXPECT_EQ(read.rows[29].time.nanoseconds, 2'900'000'000);
    EXPECT_EQ(read.rows[4].fix, FixType::unknown);
    EXPECT_EQ(read.rows[5].fix, FixType::fixed);
    EXPECT_EQ(read.rows[14].fix, FixType::fixed);
    EXPECT_NEAR(*read.rows[0].recorded_velocity_east_m_s, 20.0, 1e-9);
    EXPECT_TRUE(has_note(read, "whose week is that of the NAV-TIMEGPS nearest to them: 27."))
        << noted(read);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
