#include <algorithm>
#include <cmath>

#include "import_inspect_support.h"
#include "import_test_support.h"
#include "stages/import/resolution.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// The larger of the lengths of a degree along meridian and parallel, by the radii of curvature
/// M = a (1 - e^2) / (1 - e^2 sin^2 phi)^(3/2) and N = a / (1 - e^2 sin^2 phi)^(1/2) of WGS 84.
double longest_degree_m(double latitude_deg) {
    const double a = 6378137.0, f = 1.0 / 298.257223563, e2 = f * (2.0 - f);
    const double phi = latitude_deg * M_PI / 180.0;
    const double w2 = 1.0 - e2 * std::sin(phi) * std::sin(phi);
    const double meridian = a * (1.0 - e2) / std::pow(w2, 1.5);
    const double parallel = a / std::sqrt(w2) * std::cos(phi);
    return std::max(meridian, parallel) * M_PI / 180.0;
}

void expect_resolution(const RecordingFacts& facts, double position_m, double time_s) {
    ASSERT_TRUE(facts.position_resolution_m && facts.time_resolution_s);
    EXPECT_NEAR(*facts.position_resolution_m, position_m, 1e-6 * position_m);
    EXPECT_NEAR(*facts.time_resolution_s, time_s, 1e-12);
}

struct PosCase {
    const char* file;
    double position_m;
};

class PosResolution : public testing::TestWithParam<PosCase> {};

// All are near the equator, where a degree along it is 111 319.49 m. The times have three decimals.
TEST_P(PosResolution, IsThatOfItsText) {
    const Observations read = import_text(pos_receiver(), fixture(GetParam().file));
    expect_resolution(read.facts, GetParam().position_m, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(
    All, PosResolution,
    testing::Values(PosCase{"degrees.pos", 1e-9 * longest_degree_m(-0.2598)},
                    PosCase{"degrees_week.pos", 1e-9 * longest_degree_m(-0.2598)},
                    PosCase{"degrees_jst.pos", 1e-9 * longest_degree_m(-0.2598)},
                    PosCase{"degrees_comma.pos", 1e-9 * longest_degree_m(-0.2598)},
                    PosCase{"dms.pos", 1e-5 / 3600.0 * longest_degree_m(-0.2598)},
                    PosCase{"dms_semicolon.pos", 1e-5 / 3600.0 * longest_degree_m(-0.2598)},
                    PosCase{"ecef.pos", 1e-4}, PosCase{"ecef_velocity_week.pos", 1e-4},
                    PosCase{"baseline.pos", 1e-4}, PosCase{"baseline_base_ecef.pos", 1e-4}),
    [](const auto& instance) {
        const std::string name = instance.param.file;
        return name.substr(0, name.find('.'));
    });

struct TimeCase {
    const char* format;
    const char* scale;
    const char* text;
    const char* extra;
    double step_s;
};

TEST(CsvResolution, OfEveryTimeFormat) {
    const TimeCase cases[] = {
        {"seconds", "gps", "12", "", 1.0},
        {"seconds", "gps", "12.", "", 1.0},
        {"seconds", "gps", "-12.0500", "", 1e-4},
        {"seconds_of_week", "gps", "194670.2", "2270.000", 0.1},
        {"unix", "utc", "1689055452", "", 1.0},
        {"unix", "utc", "1689055452.200", "", 1e-3},
        {"iso", "gps", "2023-07-11T06:04:30", "", 1.0},
        {"iso", "utc", "2023-07-11T06:04:12.20Z", "", 1e-2},
        {"iso", "utc", "2023/07/11 06:04:12.200000000Z", "", 1e-9},
        {"time_of_day", "gps", "06:04:30", "2023-07-11", 1.0},
        {"time_of_day", "utc", "06:04:12.2", "2023/07/11", 0.1},
        // Zeros beyond the nanosecond are no finer than it.
        {"seconds", "gps", "0.100000000000", "", 1e-9},
    };
    for (const TimeCase& one : cases) {
        SCOPED_TRACE(one.text);
        Receiver receiver = csv_receiver();
        receiver.time_format = one.format;
        receiver.time_scale = one.scale;
        if (one.format == std::string("seconds_of_week")) receiver.columns["week"] = "extra";
        if (one.format == std::string("time_of_day")) receiver.columns["date"] = "extra";
        const Observations read =
            import_text(receiver, std::string("time,extra,lat,lon,h\n") + one.text + "," +
                                      one.extra + ",1.25,2.25,3\n");
        expect_resolution(read.facts, 1e-2 * longest_degree_m(1.25), one.step_s);
    }
}

/// Against the lengths of a degree that tables of WGS 84 give, to the metre.
TEST(CsvResolution, OfLatitudeAndLongitude) {
    const struct {
        const char* rows;
        double position_m;
    } cases[] = {
        {"0,45.00000000,137.1234567,40\n", 1e-7 * 78'847.0},   // along the parallel
        {"0,45.0000000,137.12345678,40\n", 1e-7 * 111'132.0},  // along the meridian
        {"0,45.0000000,137.1234567,40.5\n", 1e-7 * 111'132.0},
        {"0,-60.0000,2.000,40\n", 1e-3 * 55'800.0},
        {"0,-60.0000,2.0000,40\n", 1e-4 * 111'412.0},
        {"0,0,2,3\n", 111'319.5},
        {"0,-90,0,0\n", 111'694.0},
    };
    for (const auto& one : cases) {
        SCOPED_TRACE(one.rows);
        const Observations read =
            import_text(csv_receiver(), std::string("time,lat,lon,h\n") + one.rows);
        ASSERT_TRUE(read.facts.position_resolution_m);
        EXPECT_NEAR(*read.facts.position_resolution_m, one.position_m, 1e-5 * one.position_m);
    }
}

Receiver metre_receiver(CoordinateFrame frame) {
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{frame};
    receiver.columns = {{"time", "1"}, {"east", "2"}, {"north", "3"}, {"up", "4"}};
    receiver.frame->utm_zone = UtmZone{.zone = 55, .northern = false};
    return receiver;
}

TEST(CsvResolution, OfMetres) {
    const Receiver plane = metre_receiver(CoordinateFrame::local_plane);
    expect_resolution(import_text(plane, "0.0,1000.125,20.25,1.5\n").facts, 1e-2, 0.1);
    expect_resolution(import_text(plane, "0.0,1000,20,1.5\n").facts, 1.0, 0.1);
    const Receiver utm = metre_receiver(CoordinateFrame::utm);
    expect_resolution(import_text(utm, "0.0,544036.123,5815882.12,2\n").facts, 1e-2, 0.1);

    Receiver ecef = csv_receiver();
    ecef.frame = StatedFrame{CoordinateFrame::ecef};
    ecef.columns = {{"time", "1"}, {"x", "2"}, {"y", "3"}, {"z", "4"}};
    expect_resolution(import_text(ecef, "0.0,-3810228.582,3567868.547,3652903.30\n").facts, 1e-2,
                      0.1);
}

/// A writer that leaves trailing zeros out shows its decimals in some rows only, and each column
/// in rows of its own.
TEST(CsvResolution, IsOfTheRowWithTheMostDecimals) {
    const Receiver plane = metre_receiver(CoordinateFrame::local_plane);
    const Observations read = import_text(plane, "0,1.5,2,0\n0.25,1.125,3.5,0\n0.5,2,4.625,0\n");
    expect_resolution(read.facts, 1e-3, 1e-2);
}

TEST(CsvResolution, AnExponentLeavesItOpen) {
    const Receiver plane = metre_receiver(CoordinateFrame::local_plane);
    for (const char* rows : {"0.0,1.5e3,2.25,0\n", "0.0,1.5,2.25,0\n0.1,1.5,225E-2,0\n"}) {
        const Observations read = import_text(plane, rows);
        EXPECT_FALSE(read.facts.position_resolution_m) << rows;
        EXPECT_EQ(read.facts.time_resolution_s, 0.1);
    }
}

TEST(CsvResolution, EpochsWithoutPositionSayNothing) {
    const std::string names = "time,lat,lon,h\n";
    EXPECT_FALSE(import_text(csv_receiver(), names + "0.0,,,\n").facts.position_resolution_m);
    const Observations read =
        import_text(csv_receiver(), names + "0.0,,1e1,3\n0.1,40.5,2.5,3\n0.2,40.1234567,,3\n");
    expect_resolution(read.facts, 0.1 * longest_degree_m(40.5), 0.1);
}

/// Programs print doubles with all their digits; the table's own decimals do not hold less.
TEST(CsvResolution, IsNotBelowANanometre) {
    const Receiver plane = metre_receiver(CoordinateFrame::local_plane);
    const Observations read = import_text(plane, "0.0,0.30000000000000004,0.1000000000000000,0\n");
    expect_resolution(read.facts, 1e-9, 0.1);
}

TEST(Resolution, OfNoRowsIsOpen) {
    EXPECT_FALSE(WrittenResolution().time_s());
    EXPECT_FALSE(WrittenResolution().position_m(Angle::from_degrees(45.0)));
}

TEST(Resolution, IsInTheTableAndInTheInspection) {
    const Observations read =
        import_text(csv_receiver(), "time,lat,lon,h\n0.0,35.1234567,137.1234567,1\n");
    const Observations back = read_observations(write_observations(read), "f");
    EXPECT_EQ(back.facts.position_resolution_m,
              std::round(*read.facts.position_resolution_m * 1e9) / 1e9);
    EXPECT_EQ(back.facts.time_resolution_s, 0.1);
    EXPECT_NE(inspection_text(read).find(
                  "Written    positions in steps of 0.011 m, times in steps of 0.1 s\n"),
              std::string::npos)
        << inspection_text(read);
    const Observations unclear =
        import_text(csv_receiver(), "time,lat,lon,h\n0,35.1234567,1371234567e-7,1\n");
    EXPECT_NE(inspection_text(unclear).find("positions in unclear steps, times in steps of 1 s\n"),
              std::string::npos);
}

struct Real {
    const char* file;
    double position_m;
};

class RealResolution : public testing::TestWithParam<Real> {};

// The decimals were counted in the files apart from this code. All have three in their times.
TEST_P(RealResolution, IsThatOfItsText) {
    const auto bytes = recorded(GetParam().file);
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    expect_resolution(import_text(pos_receiver(), *bytes).facts, GetParam().position_m, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(
    All, RealResolution,
    testing::Values(Real{"ppk_urban_car/rover.pos", 1e-9 * longest_degree_m(35.165360868)},
                    Real{"rtk_imu_drive/rover.pos", 1e-7 * longest_degree_m(40.0966268)},
                    Real{"ubx_walk/rover.pos", 1e-7 * longest_degree_m(40.0966916)},
                    Real{"ppk_tokyo_ecef/rover.pos", 1e-4}),
    [](const auto& instance) {
        const std::string name = instance.param.file;
        return name.substr(0, name.find('/'));
    });

TEST(RealCsvResolution, TheReferenceOfTheUrbanCar) {
    const auto bytes = recorded("ppk_urban_car/reference.csv");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    Receiver receiver = csv_receiver();
    receiver.time_format = "seconds_of_week";
    receiver.columns = {
        {"time", "1"}, {"week", "2"}, {"latitude", "3"}, {"longitude", "4"}, {"height", "5"}};
    expect_resolution(import_text(receiver, *bytes).facts, 1e-8 * longest_degree_m(35.16536109),
                      0.1);
    receiver.frame = StatedFrame{CoordinateFrame::ecef};
    receiver.columns = {{"time", "1"}, {"week", "2"}, {"x", "6"}, {"y", "7"}, {"z", "8"}};
    expect_resolution(import_text(receiver, *bytes).facts, 1e-3, 0.1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
