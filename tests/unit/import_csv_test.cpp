#include <cmath>

#include "core/geodesy.h"
#include "core/text.h"
#include "import_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

const std::string plain = "time,lat,lon,h\n0.0,35.5,-137.25,40.5\n0.1,35.6,-137.35,41\n";

void expect_plain(const Observations& read) {
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.rows[0].latitude_deg, 35.5);
    EXPECT_EQ(read.rows[0].longitude_deg, -137.25);
    EXPECT_EQ(read.rows[0].height_m, 40.5);
    EXPECT_EQ(read.rows[1].height_m, 41.0);
    EXPECT_EQ(read.rows[1].time.nanoseconds, 100'000'000);
}

TEST(Csv, TheSameTableInManyDresses) {
    const std::string dresses[] = {
        plain,
        "\xef\xbb\xbf" + plain,
        "time;lat;lon;h\n0.0;35.5;-137.25;40.5\n0.1;35.6;-137.35;41\n",
        "time\tlat\tlon\th\n0.0\t35.5\t-137.25\t40.5\n0.1\t35.6\t-137.35\t41\n",
        "# a comment\n#\n\ntime , \"lat\", lon,h\r\n 0.0, 35.5 ,\"-137.25\",40.5\r\n"
        "0.1,35.6,-137.35,41\r\n\r\n",
        "lat,note,time,h,lon\n35.5,\"a, \"\"b\"\"\",0,40.5,-137.25\n35.6,,0.1,41,-137.35",
        "time lat   lon h\n0.0 35.5 -137.25 40.5\n  0.1\t35.6 \t -137.35  41 \t\n",
        "lat note time h lon\n35.5 \"a  b\" 0 40.5 -137.25\n35.6 \"\" 0.1 \"41\" -137.35\n",
    };
    for (const std::string& dress : dresses) {
        SCOPED_TRACE(dress);
        expect_plain(import_text(csv_receiver(), dress));
    }
    const Observations marked = import_text(csv_receiver(), dresses[1]);
    EXPECT_EQ(marked.rows[0].source_byte, 18);
    EXPECT_NE(marked.notes.at(0).find("byte order mark"), std::string::npos);
    const Observations cut = import_text(csv_receiver(), dresses[5]);
    EXPECT_NE(cut.notes.at(0).find("no line end"), std::string::npos);
}

TEST(Csv, BlanksAndTabsAreOneDelimiterWhereTheAttemptSaysSo) {
    Receiver receiver = csv_receiver();
    receiver.delimiter = "blank";
    expect_plain(
        import_text(receiver, "time\tlat  lon h\n0.0 35.5\t-137.25 40.5\n\t0.1 35.6 -137.35 41\n"));
}

TEST(Csv, ColumnsByNumberNeedNoHeader) {
    Receiver receiver = csv_receiver();
    receiver.columns = {{"time", "1"}, {"latitude", "2"}, {"longitude", "3"}, {"height", "4"}};
    expect_plain(import_text(receiver, plain));
    const Observations read = import_text(receiver, plain.substr(plain.find('\n') + 1));
    expect_plain(read);
    EXPECT_EQ(read.rows[0].source_line, 1);
    EXPECT_EQ(read.rows[0].source_byte, 0);
    EXPECT_EQ(read.format, "csv");
    EXPECT_EQ(read.time_scale, "relative");
    EXPECT_FALSE(read.facts.first_epoch);
    EXPECT_EQ(read.accuracy_source, "none");
}

struct TimeCase {
    const char* format;
    const char* scale;
    const char* text;  ///< time cell, and the extra one
    const char* extra;
    const char* gps;
};

TEST(Csv, EveryTimeFormatGivesTheSameInstant) {
    const TimeCase cases[] = {
        {"seconds_of_week", "gps", "194670.2", "2270", "gps"},
        {"seconds_of_week", "utc", "194652.2", "2270.0", "utc"},
        {"unix", "gps", "1689055452.200", "", "utc"},
        {"unix", "utc", "1689055452.2", "", "utc"},
        {"iso", "gps", "2023-07-11T06:04:30.2", "", "gps"},
        {"iso", "utc", "2023-07-11T06:04:12.2", "", "utc"},
        {"iso", "utc", "2023/07/11 06:04:12.200000000Z", "", "utc"},
        {"time_of_day", "gps", "06:04:30.2", "2023-07-11", "gps"},
        {"time_of_day", "utc", "06:04:12.2", "2023/07/11", "utc"},
        {"time_of_day", "local", "20:34:12.2", "2023/07/10", "utc"},
        {"iso", "local", "2023-07-10T20:34:12.2", "", "utc"},
    };
    for (const TimeCase& one : cases) {
        SCOPED_TRACE(std::string(one.format) + " " + one.text);
        Receiver receiver = csv_receiver();
        receiver.time_format = one.format;
        receiver.time_scale = one.scale;
        if (one.scale == std::string("local")) receiver.utc_offset_h = -9.5;
        if (one.format == std::string("seconds_of_week")) receiver.columns["week"] = "extra";
        if (one.format == std::string("time_of_day")) receiver.columns["date"] = "extra";
        const Observations read =
            import_text(receiver, std::string("time,extra,lat,lon,h\n") + one.text + "," +
                                      one.extra + ",1,2,3\n");
        ASSERT_TRUE(read.facts.first_epoch);
        EXPECT_EQ(to_iso(*read.facts.first_epoch, 9), "2023-07-11T06:04:30.200000000");
        EXPECT_EQ(read.time_scale, one.gps);
    }
}

TEST(Csv, LocalTimesNeedTheirOffsetFromUtc) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "iso";
    receiver.time_scale = "local";
    EXPECT_NE(complaint_of(receiver, plain).find("Write utc_offset_h"), std::string::npos);
    receiver.time_format = "unix";
    receiver.utc_offset_h = 2.0;
    EXPECT_NE(complaint_of(receiver, plain).find("of no use with time_format unix"),
              std::string::npos);
}

TEST(Csv, RelativeTimeWithAStartIsGpsTime) {
    Receiver receiver = csv_receiver();
    receiver.start_gps = parse_gps_iso("2022-03-18T08:51:22.300");
    const Observations read = import_text(receiver, replaced(plain, "\n0.0,", "\n-0.3,"));
    EXPECT_EQ(to_iso(*read.facts.first_epoch, 9), "2022-03-18T08:51:22.000000000");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 400'000'000);
    EXPECT_EQ(read.time_scale, "gps");
}

TEST(Csv, EarthCentred) {
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::ecef};
    receiver.columns = {{"time", "t"}, {"x", "X"}, {"y", "Y"}, {"z", "Z"}};
    const Observations read =
        import_text(receiver, "t,X,Y,Z\n0,-3810228.582,3567868.547,3652903.300\n");
    // The line of the reference recording's own latitude, longitude and height for that point.
    EXPECT_NEAR(*read.rows[0].latitude_deg, 35.16536109, 1e-8);
    EXPECT_NEAR(*read.rows[0].longitude_deg, 136.88140866, 1e-8);
    EXPECT_NEAR(*read.rows[0].height_m, 41.391, 1e-3);
    EXPECT_EQ(read.frame, "ecef");
}

TEST(Csv, UtmComesBackToTheEllipsoid) {
    const UtmZone zone{.zone = 55, .northern = false};
    const Geodetic place{Angle::from_degrees(-37.8), Angle::from_degrees(149.5), 210.25};
    const UtmCoordinates grid = utm_from_geodetic(zone, place);
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::utm};
    receiver.frame->utm_zone = zone;
    receiver.columns = {{"time", "t"},           {"east", "E"},
                        {"north", "N"},          {"up", "h"},
                        {"sigma_east", "sE"},    {"sigma_north", "sN"},
                        {"velocity_east", "vE"}, {"velocity_north", "vN"}};
    const std::string text = "t,E,N,h,sE,sN,vE,vN\n0," + format_fixed(grid.easting_m, 6) + "," +
                             format_fixed(grid.northing_m, 6) + ",210.25,0.03,0.01,3,4\n";
    const Observation read = import_text(receiver, text).rows[0];
    EXPECT_NEAR(*read.latitude_deg, -37.8, 1e-10);
    EXPECT_NEAR(*read.longitude_deg, 149.5, 1e-10);
    EXPECT_EQ(read.height_m, 210.25);
    // The variances along the grid's axes, by the textbook formulas of a turn by the convergence.
    const UtmGeometry geometry = utm_geometry(zone, grid.easting_m, grid.northing_m);
    const double g = geometry.convergence.radians();
    const double e = 0.03 * 0.03, n = 0.01 * 0.01, s = std::sin(g), c = std::cos(g);
    EXPECT_GT(std::abs(g), 0.02);
    EXPECT_NEAR(*read.sigma_east_m, std::sqrt(c * c * e + s * s * n) / geometry.scale, 1e-12);
    EXPECT_NEAR(*read.sigma_north_m, std::sqrt(s * s * e + c * c * n) / geometry.scale, 1e-12);
    const double covariance = *read.correlation_east_north * *read.sigma_east_m *
                              *read.sigma_north_m * geometry.scale * geometry.scale;
    EXPECT_NEAR(covariance, s * c * (n - e), 1e-12);
    EXPECT_EQ(read.recorded_velocity_east_m_s, 3.0);
    EXPECT_EQ(read.recorded_velocity_north_m_s, 4.0);
}

/// Grid north is clockwise of true north east of the central meridian in the north: a step along
/// the grid's north, taken back to the ellipsoid, shows it without any formula of convergence.
TEST(Csv, TheGridTurnsTheRightWay) {
    const UtmZone zone{.zone = 33, .northern = true};
    const auto at = [&](double north_m) {
        return geodetic_from_utm(zone, 800'000.0, 5'500'000.0 + north_m, 0.0);
    };
    const Eigen::Vector3d step = LocalFrame(at(0.0)).enu_from_geodetic(at(10.0)).m;
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::utm};
    receiver.frame->utm_zone = zone;
    receiver.height_m = 0.0;
    receiver.columns = {
        {"time", "1"}, {"east", "2"}, {"north", "3"}, {"sigma_east", "4"}, {"sigma_north", "5"}};
    const Observations read = import_text(receiver, "0,800000,5500000,0.0001,10\n");
    const Observation& row = read.rows[0];
    EXPECT_GT(step.x(), 0.1);
    EXPECT_NEAR(*row.sigma_east_m, step.x(), 1e-4);
    EXPECT_NEAR(*row.sigma_north_m, step.y(), 1e-4);
    EXPECT_NEAR(*row.correlation_east_north, 1.0, 1e-3);
    EXPECT_FALSE(read.facts.vertical_measured);
    EXPECT_EQ(row.height_m, 0.0);
    EXPECT_FALSE(row.sigma_up_m);
}

TEST(Csv, LocalPlane) {
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::local_plane};
    receiver.columns = {{"time", "t"}, {"east", "e"}, {"north", "n"}};
    receiver.accuracy = AttemptAccuracy{.horizontal_m = 0.012, .vertical_m = 0.02};
    const Observations read = import_text(receiver, "t,e,n\n0,1000.5,-20\n1,,\n");
    EXPECT_FALSE(read.facts.georeferenced);
    EXPECT_FALSE(read.facts.vertical_measured);
    EXPECT_EQ(read.rows[0].plane_east_m, 1000.5);
    EXPECT_EQ(read.rows[0].plane_north_m, -20.0);
    EXPECT_FALSE(read.rows[0].plane_up_m || read.rows[0].latitude_deg || read.rows[0].sigma_up_m);
    EXPECT_EQ(read.rows[0].sigma_east_m, 0.012);
    EXPECT_EQ(read.accuracy_source, "attempt");
    // An empty coordinate: the epoch is kept, without position.
    EXPECT_FALSE(read.rows[1].plane_east_m || read.rows[1].sigma_east_m);
    EXPECT_EQ(read.rows[1].fix, FixType::none);
}

TEST(Csv, TwoDimensionalQualityIsSharedByTheCoordinates) {
    Receiver receiver = csv_receiver();
    receiver.columns["quality_2d"] = "CQ2D";
    receiver.columns["quality_height"] = "CQ1D";
    const Observations read = import_text(
        receiver, "time,lat,lon,h,CQ2D,CQ1D\n0,35,137,40,0.0141421356,0.02\n1,35,137,40,0,0\n");
    EXPECT_NEAR(*read.rows[0].sigma_east_m, 0.01, 1e-9);
    EXPECT_NEAR(*read.rows[0].sigma_north_m, 0.01, 1e-9);
    EXPECT_EQ(read.rows[0].sigma_up_m, 0.02);
    EXPECT_FALSE(read.rows[1].sigma_east_m || read.rows[1].sigma_up_m);
    EXPECT_NE(read.notes.at(0).find("two-dimensional"), std::string::npos);
}

TEST(Csv, FixSatellitesAndVelocity) {
    Receiver receiver = csv_receiver();
    receiver.columns["fix"] = "fix";
    receiver.columns["satellites"] = "ns";
    receiver.columns["velocity_east"] = "ve";
    receiver.columns["velocity_north"] = "vn";
    const Observations read = import_text(receiver,
                                          "time,lat,lon,h,fix,ns,ve,vn\n0,1,2,3,fixed,12,1,2\n"
                                          "1,1,2,3,2,7.0,,\n2,1,2,3,,,,\n3,1,,3,fixed,5,1,2\n");
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_EQ(read.rows[0].satellites, 12);
    EXPECT_EQ(read.rows[0].recorded_velocity_north_m_s, 2.0);
    EXPECT_EQ(read.rows[1].fix, FixType::float_ambiguities);
    EXPECT_EQ(read.rows[1].satellites, 7);
    EXPECT_FALSE(read.rows[1].recorded_velocity_east_m_s);
    EXPECT_EQ(read.rows[2].fix, FixType::unknown);
    EXPECT_EQ(read.rows[3].fix, FixType::none);
    EXPECT_FALSE(read.rows[3].latitude_deg || read.rows[3].height_m);
}

TEST(Csv, OwnTablesAreRead) {
    const Observations first = import_text(csv_receiver(), plain);
    Receiver receiver = csv_receiver();
    receiver.columns = {{"time", "time"},
                        {"latitude", "latitude"},
                        {"longitude", "longitude"},
                        {"height", "height"},
                        {"fix", "fix"}};
    expect_plain(import_text(receiver, write_observations(first)));
}

TEST(CsvRefused, ByPlace) {
    const struct {
        const char* text;
        const char* where;
        const char* what;
    } cases[] = {
        {"time,lat,lon,h\n0,1,2,3\n1,1,x,3\n", "f:3:5", "longitude \"x\" is not a number"},
        {"time,lat,lon,h\n0,1,2,nan\n", "f:2:7", "no number"},
        {"time,lat,lon,h\n0,95,2,3\n", "f:2:3", "latitude and longitude swapped"},
        {"time,lat,lon,h\n0,1,-181,3\n", "f:2:5", "longitude of -181"},
        {"time;lat;lon;h\n0;1,5;2;3\n", "f:2:3",
         "\"1,5\" has a decimal comma. Export the recording with decimal points (1.5)"},
        {"time;lat;lon;h\n0,5;1;2;3\n", "f:2:1",
         "\"0,5\" has a decimal comma. Export the recording with decimal points (0.5)"},
        {"time,lat,lon,h\n0,1,5,2,3\n", "f:2:1",
         "decimal comma (\"1,5\"), export them with points"},
        {"time,lat,lon,h\n0,1,2\n1,1,2,3\n", "f:2:1",
         "3 fields; the first line of the table has 4"},
        {"time,lat,lon,h\n0,1,2,3\n1,1", "f:3:1", "the last line is cut off"},
        {"time lat  lon h\n0 1 2 3\n1  1 2\n2 1 2 3\n", "f:3:1",
         "3 fields; the first line of the table has 4"},
        {"time lat  lon h\n0 1   x 3\n", "f:2:7", "longitude \"x\" is not a number"},
        {"time lat lon h\n0 1 \"2\"x 3\n", "f:2:8", "follows a closing quotation mark"},
        {"time,lat,lon,h\n,1,2,3\n", "f:2:1", "time is missing"},
        {"time,lat,lon,h\n0.1234567891,1,2,3\n", "f:2:1", "nine decimals"},
        {"time,lat,lon,h\n1e3,1,2,3\n", "f:2:1", "nine decimals"},
        {"time,lat,lon,h\n9e,1,2,3\n", "f:2:1", "not a number"},
        {"time,lat,lon,h\n", "f:1:1", "the recording has no epochs"},
        {"# only\n", "f:1:1", "the recording has no epochs"},
        {"time,lat,long,h\n0,1,2,3\n", "f:1:1", "Did you mean \"long\""},
        {"time,lat,lon,h,lat\n0,1,2,3,4\n", "f:1:6", "two columns have the name \"lat\""},
        {"0,1,2,3\n1,1,2,3\n", "f:1:1", "there is no header line"},
        {"time,lat,lon,\"h\n0,1,2,3\n", "f:1:14", "not closed"},
        {"time,lat,lon,h\n0,1,\"2\"x,3\n", "f:2:8", "follows a closing quotation mark"},
        {"time,lat,lon,h\n9000000000,1,2,3\n-9000000000,1,2,3\n", "f:3:1", "292 years"},
        {"", "f:1:1", "empty"},
        {" \r\n\n", "f:1:1", "nothing but blanks"},
    };
    for (const auto& bad : cases) {
        const std::string message = complaint_of(csv_receiver(), bad.text);
        EXPECT_EQ(message.rfind(std::string(bad.where) + ": ", 0), 0u) << message;
        EXPECT_NE(message.find(bad.what), std::string::npos) << message;
    }
}

TEST(CsvRefused, ByTheAttempt) {
    struct Case {
        void (*change)(Receiver&);
        const char* what;
    };
    const Case cases[] = {
        {[](Receiver& r) { r.frame.reset(); }, "frame is not stated"},
        {[](Receiver& r) {
             r.columns.clear();
             r.format = "csv";
         },
         "no columns are named"},
        {[](Receiver& r) { r.columns.erase("time"); }, "\"time\", which time_format seconds needs"},
        {[](Receiver& r) { r.columns.erase("latitude"); }, "\"latitude\", which frame geodetic"},
        {[](Receiver& r) { r.columns.erase("height"); }, "no column of heights"},
        {[](Receiver& r) { r.frame = StatedFrame{CoordinateFrame::ecef}; },
         "of no use with frame ecef"},
        {[](Receiver& r) { r.columns["east"] = "lon"; }, "\"east\", which is of no use"},
        {[](Receiver& r) { r.columns["week"] = "h"; }, "\"week\", which is of no use"},
        {[](Receiver& r) { r.time_format = "seconds_of_week"; }, "\"week\", which time_format"},
        {[](Receiver& r) { r.time_format = "time_of_day"; }, "\"date\", which time_format"},
        {[](Receiver& r) { r.columns["sigma_east"] = "h"; }, "only one is named"},
        {[](Receiver& r) { r.columns["heading"] = "h"; }, "no member \"heading\""},
        {[](Receiver& r) { r.format = "kml"; }, "the format \"kml\" is not read"},
        {[](Receiver& r) { r.delimiter = "pipe"; }, "delimiter \"pipe\""},
    };
    for (const Case& bad : cases) {
        Receiver receiver = csv_receiver();
        bad.change(receiver);
        const std::string message = complaint_of(receiver, plain);
        EXPECT_EQ(message.rfind("attempt.yaml:5:5: ", 0), 0u) << message;
        EXPECT_NE(message.find(bad.what), std::string::npos) << message;
    }
    Receiver iso = csv_receiver();
    iso.time_format = "iso";
    EXPECT_NE(
        complaint_of(iso, "time,lat,lon,h\n2023-07-11T06:04:12Z,1,2,3\n").find("time_scale: utc"),
        std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
