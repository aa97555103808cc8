#include <cmath>

#include "core/geodesy.h"
#include "import_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

struct Variant {
    const char* file;
    const char* frame;
    const char* time_scale;
    bool velocity;
};

class PosVariant : public testing::TestWithParam<Variant> {};

// One flight in every variant: the figures are those of degrees.pos, see data/import/README.md.
TEST_P(PosVariant, SaysTheSame) {
    const Variant& variant = GetParam();
    const Observations read = import_text(pos_receiver(), fixture(variant.file), variant.file);
    EXPECT_EQ(read.format, "rtklib-pos");
    EXPECT_EQ(read.frame, variant.frame);
    EXPECT_EQ(read.time_scale, variant.time_scale);
    EXPECT_EQ(read.accuracy_source, "recording");
    EXPECT_EQ(read.facts.receiver, "primary");
    ASSERT_TRUE(read.facts.first_epoch);
    EXPECT_EQ(*read.facts.first_epoch, GpsTime::from_week(2270, 194'670'000'000'000));
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 0.2);

    const double latitude[] = {-0.259871234, -0.259871101, -0.259870987};
    const double longitude[] = {-0.412345678, -0.412345911, -0.412346204};
    const double height[] = {41.4082, 41.4121, 41.4099};
    ASSERT_EQ(read.rows.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const Observation& row = read.rows[i];
        const auto at = [](double lat, double lon, double h) {
            return ecef_from_geodetic({Angle::from_degrees(lat), Angle::from_degrees(lon), h}).m;
        };
        EXPECT_EQ(row.epoch, static_cast<std::int64_t>(i) + 1);
        EXPECT_EQ(row.time.nanoseconds, static_cast<std::int64_t>(i) * 200'000'000);
        EXPECT_LT((at(*row.latitude_deg, *row.longitude_deg, *row.height_m) -
                   at(latitude[i], longitude[i], height[i]))
                      .norm(),
                  1e-3);
        EXPECT_NEAR(*row.sigma_east_m, 0.0046, 1e-7);
        EXPECT_NEAR(*row.sigma_north_m, 0.0049, 1e-7);
        EXPECT_NEAR(*row.sigma_up_m, 0.0102, 1e-7);
        // Covariances, not correlations, are what sdne, sdeu, sdun are the signed roots of.
        EXPECT_NEAR(*row.correlation_east_north, 0.0028 * 0.0028 / (0.0046 * 0.0049), 1e-4);
        EXPECT_NEAR(*row.correlation_east_up, 0.0018 * 0.0018 / (0.0046 * 0.0102), 1e-4);
        EXPECT_NEAR(*row.correlation_north_up, -0.0033 * 0.0033 / (0.0049 * 0.0102), 1e-4);
        EXPECT_EQ(row.fix, FixType::fixed);
        EXPECT_EQ(row.satellites, 16);
        EXPECT_DOUBLE_EQ(*row.age_s, 0.03);
        EXPECT_DOUBLE_EQ(*row.ratio, 6.4);
        EXPECT_EQ(row.recorded_velocity_east_m_s.has_value(), variant.velocity);
        if (!variant.velocity) continue;
        EXPECT_NEAR(*row.recorded_velocity_east_m_s, 1.25, 1e-7);
        EXPECT_NEAR(*row.recorded_velocity_north_m_s, -2.5, 1e-7);
        EXPECT_NEAR(*row.recorded_velocity_up_m_s, 0.125, 1e-7);
        EXPECT_NEAR(*row.sigma_recorded_velocity_east_m_s, 0.03, 1e-7);
        EXPECT_NEAR(*row.sigma_recorded_velocity_north_m_s, 0.04, 1e-7);
        EXPECT_NEAR(*row.sigma_recorded_velocity_up_m_s, 0.05, 1e-7);
    }
}

INSTANTIATE_TEST_SUITE_P(
    All, PosVariant,
    testing::Values(Variant{"degrees.pos", "geodetic", "gps", false},
                    Variant{"degrees_week.pos", "geodetic", "gps", false},
                    Variant{"degrees_utc.pos", "geodetic", "utc", false},
                    Variant{"degrees_utc_week.pos", "geodetic", "utc", false},
                    Variant{"degrees_jst.pos", "geodetic", "utc", false},
                    Variant{"degrees_velocity_floats.pos", "geodetic", "gps", true},
                    Variant{"degrees_comma.pos", "geodetic", "gps", false},
                    Variant{"degrees_comma_week_crlf.pos", "geodetic", "gps", false},
                    Variant{"degrees_tab.pos", "geodetic", "gps", false},
                    Variant{"dms.pos", "geodetic", "gps", false},
                    Variant{"dms_semicolon.pos", "geodetic", "gps", false},
                    Variant{"ecef.pos", "ecef", "gps", false},
                    Variant{"ecef_velocity_week.pos", "ecef", "gps", true},
                    Variant{"baseline.pos", "ecef", "gps", false},
                    Variant{"baseline_base_dms.pos", "ecef", "gps", false},
                    Variant{"baseline_base_ecef.pos", "ecef", "gps", false}),
    [](const auto& instance) {
        const std::string name = instance.param.file;
        return name.substr(0, name.find('.'));
    });

const std::string header =
    "%  GPST  latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) "
    "sdun(m) age(s) ratio\n";
const std::string row =
    "2270 194670.000 35.165360868 136.881409540 41.4082 1 16 0.0049 0.0046 0.0102 0.0028 0.0018 "
    "-0.0033 0.03 6.4\n";

/// Covariances of axes along unit vectors: u' C v for every pair, by explicit sums.
TEST(PosAccuracy, EarthCentredCovarianceTurnsWithThePlace) {
    const std::string text =
        "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) "
        "age(s) ratio\n"
        "2032 273375.000 -3963426.7841 3350882.1503 3694865.5306 1 21 0.0085 0.0096 0.0072 -0.0074 "
        "0.0060 -0.0067 0.00 10.7\n";
    const Observation read = import_text(pos_receiver(), text).rows.front();
    const double phi = *read.latitude_deg * M_PI / 180.0;
    const double lambda = *read.longitude_deg * M_PI / 180.0;
    const double axes[3][3] = {
        {-std::sin(lambda), std::cos(lambda), 0.0},
        {-std::sin(phi) * std::cos(lambda), -std::sin(phi) * std::sin(lambda), std::cos(phi)},
        {std::cos(phi) * std::cos(lambda), std::cos(phi) * std::sin(lambda), std::sin(phi)}};
    const double xy = -0.0074 * 0.0074, yz = 0.0060 * 0.0060, zx = -0.0067 * 0.0067;
    const double c[3][3] = {
        {0.0085 * 0.0085, xy, zx}, {xy, 0.0096 * 0.0096, yz}, {zx, yz, 0.0072 * 0.0072}};
    double enu[3][3] = {};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    enu[a][b] += axes[a][i] * c[i][j] * axes[b][j];
    EXPECT_NEAR(*read.sigma_east_m, std::sqrt(enu[0][0]), 1e-12);
    EXPECT_NEAR(*read.sigma_north_m, std::sqrt(enu[1][1]), 1e-12);
    EXPECT_NEAR(*read.sigma_up_m, std::sqrt(enu[2][2]), 1e-12);
    EXPECT_NEAR(*read.correlation_east_north, enu[0][1] / std::sqrt(enu[0][0] * enu[1][1]), 1e-9);
    EXPECT_NEAR(*read.correlation_east_up, enu[0][2] / std::sqrt(enu[0][0] * enu[2][2]), 1e-9);
    EXPECT_NEAR(*read.correlation_north_up, enu[1][2] / std::sqrt(enu[1][1] * enu[2][2]), 1e-9);
}

TEST(PosAccuracy, ZeroIsUnknownAndTheAttemptsIsTakenInstead) {
    const std::string zeros = header + replaced(row, "0.0049 0.0046 0.0102 0.0028 0.0018 -0.0033",
                                                "0.0000 0.0000 0.0000 0.0000 0.0000 0.0000");
    const Observations none = import_text(pos_receiver(), zeros);
    EXPECT_EQ(none.accuracy_source, "none");
    EXPECT_FALSE(none.rows[0].sigma_east_m || none.rows[0].sigma_north_m ||
                 none.rows[0].sigma_up_m || none.rows[0].correlation_east_north);

    Receiver receiver = pos_receiver();
    receiver.accuracy = AttemptAccuracy{.horizontal_m = 0.01, .vertical_m = 0.02};
    const Observations stated = import_text(receiver, zeros);
    EXPECT_EQ(stated.accuracy_source, "attempt");
    EXPECT_EQ(stated.rows[0].sigma_east_m, 0.01);
    EXPECT_EQ(stated.rows[0].sigma_north_m, 0.01);
    EXPECT_EQ(stated.rows[0].sigma_up_m, 0.02);
    ASSERT_FALSE(stated.notes.empty());
    EXPECT_NE(stated.notes[0].find("attempt's is used"), std::string::npos);

    const Observations own = import_text(receiver, header + row);
    EXPECT_EQ(own.accuracy_source, "recording");
    EXPECT_DOUBLE_EQ(*own.rows[0].sigma_east_m, 0.0046);
}

TEST(PosAccuracy, AnImpossibleCorrelationIsKeptForScreening) {
    const Observations read =
        import_text(pos_receiver(), header + replaced(row, "0.0028", "-0.0100"));
    EXPECT_NEAR(*read.rows[0].correlation_east_north, -1e-4 / (0.0046 * 0.0049), 1e-12);
}

TEST(Pos, LongitudesAreBroughtToWestNegative) {
    const Observations read =
        import_text(pos_receiver(), header + replaced(row, "136.881409540", "236.5"));
    EXPECT_DOUBLE_EQ(*read.rows[0].longitude_deg, -123.5);
}

TEST(Pos, KeepsOrderLinesAndBytes) {
    const std::string text =
        "% program : x\n" + header + replaced(row, "670.000", "671.000") + header + "% ...\n" + row;
    const Observations read = import_text(pos_receiver(), text);
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.rows[1].time.nanoseconds, -1'000'000'000);
    EXPECT_EQ(read.facts.nominal_interval_s, 0.0);
    EXPECT_EQ(read.rows[0].source_line, 3);
    EXPECT_EQ(read.rows[1].source_line, 6);
    EXPECT_EQ(static_cast<std::size_t>(*read.rows[1].source_byte), text.size() - row.size());
    EXPECT_EQ(read.notes.at(0), "The file holds 2 solutions, one after the other.");
}

TEST(Pos, EveryKindOfSolution) {
    const FixType kinds[] = {FixType::none, FixType::fixed,         FixType::float_ambiguities,
                             FixType::sbas, FixType::dgps,          FixType::single,
                             FixType::ppp,  FixType::dead_reckoning};
    for (int q = 0; q < 8; ++q)
        EXPECT_EQ(
            import_text(pos_receiver(), header + replaced(row, " 1 16", fmt::format(" {} 16", q)))
                .rows[0]
                .fix,
            kinds[q]);
}

TEST(Pos, AnEpochWithoutSolutionHasNoPosition) {
    const Observations read = import_text(
        pos_receiver(),
        header + replaced(row, "35.165360868 136.881409540 41.4082 1", "0.0 0.0 0.0 0"));
    EXPECT_FALSE(read.rows[0].latitude_deg);
    EXPECT_EQ(read.rows[0].fix, FixType::none);
}

TEST(Pos, AnglesInThreeFields) {
    const std::string dms = "%  GPST;latitude(d'\");longitude(d'\");height(m);Q\n";
    const auto read = [&](const std::string& fields) {
        return import_text(pos_receiver(), dms + "2270;194670.000;" + fields + "\n").rows.at(0);
    };
    // RTKLIB rounds seconds for print.
    EXPECT_DOUBLE_EQ(*read("-0;15;60.00000;136;52;60.00000;41.4;1").latitude_deg, -16.0 / 60.0);
    EXPECT_FALSE(read("0;0;0.0;0;0;0.0;0.0;0").latitude_deg);
    // Near the equator degrees of 0 alone are no missing position.
    EXPECT_DOUBLE_EQ(*read("-0;15;0.0;-0;24;0.0;41.4;0").latitude_deg, -0.25);
}

TEST(Pos, ALeapSecondOfUtc) {
    const std::string text = replaced(header, "GPST", "UTC") +
                             replaced(row, "2270 194670.000", "2016/12/31 23:59:60.500");
    EXPECT_EQ(to_iso(*import_text(pos_receiver(), text).facts.first_epoch),
              "2017-01-01T00:00:17.500");
}

struct Bad {
    const char* from;
    const char* to;
    const char* where;
    const char* what;
};

class PosRefused : public testing::TestWithParam<Bad> {};

TEST_P(PosRefused, SaysWhere) {
    const Bad& bad = GetParam();
    const std::string text = replaced(header + row + row, bad.from, bad.to);
    const std::string message = complaint_of(pos_receiver(), text);
    EXPECT_EQ(message.rfind(std::string("f:") + bad.where + ": ", 0), 0u) << message;
    EXPECT_NE(message.find(bad.what), std::string::npos) << message;
}

INSTANTIATE_TEST_SUITE_P(
    All, PosRefused,
    testing::Values(
        Bad{"35.165360868 136", "95.0 136", "2:17", "latitude of 95 degrees is impossible"},
        Bad{"35.165360868 136.881409540", "136.88 35.1653", "2:17",
            "latitude and longitude swapped?"},
        Bad{" 136.881409540", " 400", "2:30", "longitude of 400 degrees is impossible"},
        Bad{"41.4082", "100001", "2:44", "height of 100001 m is impossible"},
        Bad{"41.4082", "nan", "2:44", "\"nan\", which is no number"},
        Bad{"41.4082", "-inf", "2:44", "\"-inf\", which is no number"},
        Bad{"41.4082", "41,4082", "2:44", "decimal comma"},
        Bad{"41.4082", "abc", "2:44", "height \"abc\" is not a number"},
        Bad{" 1 16", " 8 16", "2:52", "Q \"8\" is not a fix type"},
        Bad{" 1 16", " 1.5 16", "2:52", "Q \"1.5\""},
        Bad{" 1 16", " 1 16.5", "2:54", "count of satellites"},
        Bad{"0.0049", "-0.0049", "2:57", "cannot be one"},
        Bad{"2270 194670.000", "2270 604800.001", "2:6", "time"},
        Bad{"2270 194670.000", "2270 1e5", "2:6", "nine decimals"},
        Bad{"2270 194670.000", "2023/02/30 06:04:30", "2:12", "day 30"},
        Bad{"2270 194670.000", "2023/07/11 24:04:30", "2:12", "hour 24"},
        Bad{"2270 194670.000", "2023/7/11 06:04:30", "2:1", "not a date"},
        Bad{"2270 194670.000", "2023/07/11 6:04:30", "2:12", "not a time of day"},
        Bad{" 0.03 6.4\n", " 0.03\n", "2:1", "14 fields; its header names 15"},
        Bad{" 0.03 6.4\n", " 0.03 6.4 7\n", "2:1", "16 fields; its header names 15"},
        Bad{"GPST", "LMT", "1:4", "LMT"}, Bad{"GPST", "TAI", "1:4", "not a time system"},
        Bad{"sdne(m)", "sdxn(m)", "1:75", "\"sdxn(m)\" is not known"},
        Bad{"sdne(m)", "sdn(m)", "1:75", "stands twice"},
        Bad{"sdne(m)", "sdne(ft)", "1:75", "unit of sdne(m)"},
        Bad{"sdne(m)", "", "1:4", "only 5 are there"}, Bad{" Q ", " ", "1:4", "column Q"},
        Bad{"longitude(deg)", "longitude(d'\")", "1:4", "one unit"},
        Bad{"longitude(deg)", "x-ecef(m)", "1:4", "only 2 are there"}));

TEST(PosColumns, OfAnotherProgramBehindRtklibsArePassedOver) {
    // GINav's attitude, whose standard deviation of the yaw is called as one of RTKLIB's.
    std::string text = header + row;
    const auto insert = [&](const std::string& before, const std::string& what) {
        text.insert(text.find(before) + before.size(), what);
    };
    insert("ratio", " pitch(deg) yaw(deg) sdn sdpr");
    insert("0.03 6.4", " 1.5 334.0 0.5 -0.01");
    text.insert(0, "% mode      : PPK/INS TC\n");
    const Observations read = import_text(pos_receiver(), text);
    const Observations plain = import_text(pos_receiver(), header + row);
    ASSERT_EQ(read.rows.size(), 1U);
    EXPECT_EQ(read.rows[0].latitude_deg, plain.rows[0].latitude_deg);
    EXPECT_EQ(read.rows[0].sigma_north_m, plain.rows[0].sigma_north_m);
    ASSERT_EQ(read.notes.size(), plain.notes.size() + 2);
    EXPECT_EQ(read.notes[0], "Columns that are not used: pitch(deg), yaw(deg), sdn, sdpr.");
    EXPECT_NE(read.notes[1].find("inertial unit"), std::string::npos);
}

TEST(PosColumns, OfGinavAreReadAsItWritesThem) {
    const auto ginav = recorded("other_programs/ginav_attitude.pos");
    if (!ginav) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *ginav);
    EXPECT_EQ(read.rows.size(), 1228U);
    EXPECT_EQ(read.frame, "ecef");
    EXPECT_EQ(read.rows[1].fix, FixType::fixed);
    EXPECT_EQ(read.rows[1].satellites, 20);
    EXPECT_TRUE(read.rows[1].recorded_velocity_east_m_s.has_value());
}

TEST(PosRefused, WholeFiles) {
    const struct {
        std::string text, where, what;
    } cases[] = {
        {header + row + row.substr(0, 60), "f:3:1", "the last line is cut off: it has 8 fields"},
        {row + row, "f:1:1", "no header line that names the columns"},
        {"% program : x\n" + row, "f:2:1", "no header line that names the columns"},
        {header, "f:1:1", "no epochs"},
        {"% (lat/lon/height=Tokyo/ellipsoidal)\n" + header + row, "f:1:1", "Tokyo"},
        {"% (lat/lon/height=WGS84/geodetic,Q=1:fix)\n" + header + row, "f:1:1", "geoid"},
        {header + row + replaced(header, "GPST", "UTC") + row, "f:3:1", "another time system"},
        {"%  GPST e-baseline(m) n-baseline(m) u-baseline(m) Q\n2270 1.0 1 2 3 1\n", "f:1:1",
         "no line \"% ref pos\""},
        {"% ref pos : 1 2\n%  GPST e-baseline(m) n-baseline(m) u-baseline(m) Q\n", "f:1:1",
         "base position"},
        {"%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q\n2270 1.0 1000 2000 3000 1\n", "f:2:10",
         "km from the centre"},
        {"%  GPST,latitude(deg),longitude(deg),height(m),Q\n2270,1.0,,2,3,1\n", "f:2:10",
         "a field is empty"},
        {"%  GPST latitude(d'\") longitude(d'\") height(m) Q\n2270 1.0 -0 60 0 1 0 0 5 1\n",
         "f:2:13", "count of minutes \"60\""},
    };
    for (const auto& bad : cases) {
        Receiver receiver = pos_receiver();
        const std::string message = complaint_of(receiver, bad.text);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_NE(message.find(bad.what), std::string::npos) << message;
        receiver.format = "rtklib-pos";
        EXPECT_EQ(complaint_of(receiver, bad.text), message);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
