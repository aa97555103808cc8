#include <fmt/format.h>

#include <array>
#include <cmath>

#include "import_test_support.h"

// Tables of programs in wide use, read without a description. Headers are as the programs write
// them; the rows of the small ones are invented.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A receiver that goes north at 36 km/h from 45.25 N 9.125 E, as each header has it.
struct Written {
    const char* name;
    const char* format;
    std::string text;
    const char* time_scale;
    double speed_m_s;  ///< recorded, of the first row; negative where none is used
    std::size_t rows = 3;
};

void PrintTo(const Written& written, std::ostream* out) {
    *out << written.name;
}

const std::string chrono =
    "This file is created using RaceChrono Pro v9.1.3 ( http://racechrono.com/ ).\n";

const Written tables[] = {
    {"RaceChrono1", "racechrono",
     chrono + "\nSession title,Test\nSession type,Lap timing\nTrack name,\nDriver name,\nExport "
              "scope,Whole session\nCreated,31/12/2025,10:03\nNote,\n\n"
              "Lap #,Timestamp (s),Distance (m),Distance (km),Locked satellites,Latitude (deg),"
              "Longitude (deg),Speed (m/s),Speed (kph),Speed (mph),Altitude (m),Bearing (deg)\n"
              "N/A,1767150797.0,0,0,10,45.2500000,9.1250000,10.0,36.0,22.4,120.0,0.0\n"
              "N/A,1767150797.2,2,0.002,10,45.2500181,9.1250000,10.1,36.4,22.6,120.0,0.0\n"
              "1,1767150797.4,4,0.004,10,45.2500360,9.1250000,9.9,35.6,22.1,120.0,0.0\n",
     "utc", 10.0},
    {"RaceChrono2", "racechrono",
     chrono + "Session title,\"Test\"\nNote,\n\n"
              "Time (s),Session fragment #,Lap #,Trap name,X-position (m),Y-position (m),Distance "
              "(m),Speed (m/s),Altitude (m),Bearing (deg),Device update rate (Hz),Elapsed time "
              "(s),Latitude (deg),Longitude (deg),Satellites (sats),Fix type,Accuracy (m),Speed "
              "(m/s) *calc\n"
              "1767150797.0,0,1,,0,0,0,10.0,120.0,0.0,5.0,0.0,45.2500000,9.1250000,12,3,3.0,99\n"
              "1767150797.2,0,1,,0,0,0,10.1,120.0,0.0,5.0,0.2,45.2500181,9.1250000,12,3,3.0,99\n"
              "1767150797.4,0,1,,0,0,0,9.9,120.0,0.0,5.0,0.4,45.2500360,9.1250000,12,3,3.0,99\n",
     "utc", 10.0},
    {"RaceChrono3", "racechrono",
     "\xef\xbb\xbf" + chrono +
         "Format,3\nSession title,\"Test, two\"\nCreated,22/02/2026,10:00\nNote,\n\n"
         "timestamp,fragment_id,lap_number,accuracy,altitude,bearing,latitude,longitude,"
         "satellites,speed,combined_acc,speed,speed\n"
         "unix time,,,m,m,deg,deg,deg,sats,m/s,G,m/s,m/s\n"
         ",,,100: gps,100: gps,100: gps,100: gps,100: gps,100: gps,100: gps,calc,calc,200: obd\n"
         "1767150797.0,0,1,3.0,120.0,0.0,45.2500000,9.1250000,12.0,10.0,0.1,99,77\n"
         "1767150797.2,0,1,3.0,120.0,0.0,45.2500181,9.1250000,12.5,10.1,0.1,99,77\n"
         "1767150797.2,0,1,,,,,,,,0.1,99,78\n"
         "1767150797.4,0,1,3.0,120.0,0.0,45.2500350,9.1250000,13.0,9.9,0.1,99,77\n",
     "utc", 10.0},
    {"RaceBoxOfTelephone", "racebox",
     "Record,Time,Latitude,Longitude,Altitude,Speed,GForceX,GForceY,GForceZ,Lap,GyroX,GyroY,GyroZ\n"
     "1,2026-07-10T13:16:19.400Z,45.2500000,9.1250000,120.0,36.0,-0.1,0.2,1.0,1,0,0,1\n"
     "2,2026-07-10T13:16:19.600Z,45.2500181,9.1250000,120.0,36.1,-0.2,0.3,1.0,1,0,0,2\n"
     "3,2026-07-10T13:16:19.800Z,45.2500360,9.1250000,120.0,36.2,-0.2,0.3,1.0,1,0,0,2\n",
     "utc", -1.0},
    {"RaceBoxWithUnits", "racebox",
     "Format,RaceBox CSV\nTrack,Test\nLap 1, 36.648, sectors, 10.167,12.115,0,14.366\n\n"
     "Record,Time,Latitude,Longitude,Altitude (m),Speed (m/s),GForceX (g),GForceY (g),GForceZ "
     "(g),Lap,Heading,GyroX (deg/s),GyroY (deg/s),GyroZ (deg/s)\n"
     "1,2026-07-10T13:16:19.400Z,45.2500000,9.1250000,120.0,10.0,0,0,1,1,0.0,0,0,0\n"
     "2,2026-07-10T13:16:19.600Z,45.2500181,9.1250000,120.0,10.0,0,0,1,1,0.0,0,0,0\n"
     "3,2026-07-10T13:16:19.800Z,45.2500360,9.1250000,120.0,10.0,0,0,1,1,0.0,0,0,0\n",
     "utc", 10.0},
    {"RaceBoxForRaceRender", "racebox",
     "Record,Time,Latitude,Longitude,Altitude,KPH,X,Y,Z,Lap\n"
     "1,2026-07-10T13:16:19.400Z,45.2500000,9.1250000,120.0,36.0,0,0,1,1\n"
     "2,2026-07-10T13:16:19.600Z,45.2500181,9.1250000,120.0,36.0,0,0,1,1\n"
     "3,2026-07-10T13:16:19.800Z,45.2500360,9.1250000,120.0,36.0,0,0,1,1\n",
     "utc", 10.0},
    {"TrackAddict3", "trackaddict",
     "# RaceRender Data: TrackAddict 3.4.2 on iOS 10.1.1 [iPhone8,4] (Mode: 0)\n"
     "# End Point: 34.871512, -118.263719  @ -1.00 deg\n"
     "\"Time\",\"Lap\",\"Predicted Lap Time\",\"Predicted vs Best Lap\",\"GPS_Update\","
     "\"GPS_Delay\",\"Latitude\",\"Longitude\",\"Altitude (m)\",\"Altitude (ft)\",\"Speed (MPH)\","
     "\"Heading\",\"Accuracy (m)\",\"Accel X\",\"Accel Y\",\"Accel Z\"\n"
     "0.000,0,0,0,1,0.000,45.2500000,9.1250000,120.0,394,22.37,0.0,5.0,0.00,0.00,0.00\n"
     "0.110,0,0,0,0,0.110,45.2500000,9.1250000,120.0,394,22.37,0.0,5.0,0.00,0.00,0.00\n"
     "0.200,0,0,0,1,0.000,45.2500181,9.1250000,120.0,394,22.37,0.0,5.0,0.00,0.00,0.00\n"
     "# Lap 0: 00:02:03.202\n"
     "0.400,0,0,0,1,0.000,45.2500360,9.1250000,120.0,394,22.37,0.0,5.0,0.00,0.00,0.00\n"
     "# Session End\n",
     "relative", 22.37 * 0.44704},
    {"TrackAddict4", "trackaddict",
     "# RaceRender Data: TrackAddict 4.8.2 on Android 14 (Mode: 0)\n# Vehicle: car\n"
     "\"Time\",\"UTC Time\",\"Lap\",\"Predicted Lap Time\",\"Predicted vs Best "
     "Lap\",\"GPS_Update\",\"GPS_Delay\",\"Latitude\",\"Longitude\",\"Altitude (m)\",\"Altitude "
     "(ft)\",\"Speed (Km/h)\",\"Heading\",\"Accuracy (m)\",\"Vehicle Speed (km/h) *OBD\"\n"
     "0.000,1727597624.000,0,0,0,1,0.000,45.2500000,9.1250000,120.0,394,36.0,0.0,3.8,77\n"
     "0.200,1727597624.200,0,0,0,1,0.000,45.2500181,9.1250000,120.0,394,36.0,0.0,3.8,77\n"
     "0.400,1727597624.400,0,0,0,1,0.000,45.2500360,9.1250000,120.0,394,36.0,0.0,3.8,77\n",
     "utc", 10.0},
    {"RaceRender", "trackaddict",
     "# RaceRender Data: logger (Mode -1)\n# GPS: EXT; MODE: SD\n"
     "\"Time\",\"UTC Time\",\"GPS_Update\",\"GPS_Delay\",\"Latitude\",\"Longitude\",\"Altitude "
     "(ft)\",\"Speed (Km/h)\",\"Heading\",\"Accuracy (m)\"\n"
     "0.000,1727597624.000,1,0.000,45.2500000,9.1250000,393.70,36.0,0.0,3.8\n"
     "0.200,1727597624.200,1,0.000,45.2500181,9.1250000,393.70,36.0,0.0,3.8\n"
     "0.400,1727597624.400,1,0.000,45.2500360,9.1250000,393.70,36.0,0.0,3.8\n",
     "utc", 10.0},
    {"AimTwo", "aim",
     "\"Format\",\"AIM CSV File\"\r\n\"Venue\",\"Test\"\r\n\"Sample Rate\",\"5\"\r\n\"Beacon "
     "Markers\",\"95.3\",\"190.6\"\r\n\r\n"
     "\"Time\",\"GPS_Speed\",\"GPS_Nsat\",\"GPS_Latitude\",\"GPS_Longitude\",\"RPM\"\r\n"
     "\"sec\",\"km/h\",\"#\",\"deg\",\"deg\",\"rpm\"\r\n\r\n"
     "\"0.0\",\"36.0\",\"9\",\"45.2500000\",\"9.1250000\",\"5012\"\r\n"
     "\"0.2\",\"36.4\",\"9\",\"45.2500181\",\"9.1250000\",\"5012\"\r\n"
     "\"0.4\",\"36.1\",\"9\",\"45.2500350\",\"9.1250000\",\"5012\"\r\n",
     "relative", 10.0},
    {"AimThree", "aim",
     "\"Format\",\"AiM CSV File\"\n\"Session\",\"Test\"\n\"Date\",\"Saturday, March 14, 2026\"\n"
     "\"Time\",\"10:02 AM\"\n\"Sample Rate\",\"5\"\n\"Duration\",\"0.4\"\n\n"
     "\"Time\",\"GPS Speed\",\"GPS Nsat\",\"GPS LatAcc\",\"GPS LonAcc\",\"GPS Slope\",\"GPS "
     "Heading\",\"GPS Gyro\",\"GPS Altitude\",\"GPS PosAccuracy\",\"GPS SpdAccuracy\",\"GPS "
     "Radius\",\"GPS Latitude\",\"GPS Longitude\"\n"
     "\"s\",\"m/s\",\"#\",\"g\",\"g\",\"deg\",\"deg\",\"deg/s\",\"m\",\"mm\",\"km/"
     "h\",\"m\",\"deg\",\"deg\"\n\n"
     "0.0,10.0,9,0,0,0,0,0,120.0,700,0.5,99,45.2500000,9.1250000\n"
     "0.2,10.2,9,0,0,0,0,0,120.0,700,0.5,99,45.2500181,9.1250000\n"
     "0.4,10.1,9,0,0,0,0,0,120.0,700,0.5,99,45.2500350,9.1250000\n",
     "relative", 10.0},
    {"AimInMiles", "aim",
     "\"Format\",\"AiM CSV File\"\n\"Session\",\"Test\"\n\n"
     "\"Time\",\"GPS Speed\",\"GPS Altitude\",\"GPS Latitude\",\"GPS Longitude\"\n"
     "\"s\",\"mph\",\"ft\",\"deg\",\"deg\"\n\n"
     "0.0,22.37,393.70,45.2500000,9.1250000\n"
     "0.2,22.47,393.70,45.2500181,9.1250000\n"
     "0.4,22.27,393.70,45.2500350,9.1250000\n",
     "relative", 22.37 * 0.44704},
};

class Presets : public testing::TestWithParam<Written> {};

TEST_P(Presets, AreReadWithoutADescription) {
    const Written& written = GetParam();
    Receiver receiver = pos_receiver();
    receiver.height_m = 120.0;
    for (const char* format : {"auto", written.format}) {
        receiver.format = format;
        const Observations read = import_text(receiver, written.text);
        EXPECT_EQ(read.format, written.format);
        EXPECT_EQ(read.time_scale, written.time_scale);
        EXPECT_EQ(read.records.bad, 0) << noted(read);
        ASSERT_EQ(read.rows.size(), written.rows) << noted(read);
        EXPECT_DOUBLE_EQ(*read.rows[0].latitude_deg, 45.25);
        EXPECT_DOUBLE_EQ(*read.rows[0].longitude_deg, 9.125);
        EXPECT_NEAR(*read.rows[0].height_m, 120.0, 0.01);
        EXPECT_NEAR(static_cast<double>(read.rows[2].time.nanoseconds) * 1e-9, 0.4, 1e-9);
        const Observation& first = read.rows[0];
        const auto speed =
            first.recorded_speed_m_s ? first.recorded_speed_m_s : first.recorded_velocity_north_m_s;
        EXPECT_EQ(speed.has_value(), written.speed_m_s > 0.0);
        EXPECT_NEAR(speed ? *speed : -1.0, written.speed_m_s, 1e-9);
    }
}

INSTANTIATE_TEST_SUITE_P(EveryHeader, Presets, testing::ValuesIn(tables),
                         [](const auto& one) { return std::string(one.param.name); });

// What is said of speeds without a unit is true when it is done.
TEST(PresetSpeeds, AreUsedInTheUnitThatTheNoteNames) {
    const std::string& text = tables[3].text;
    Receiver receiver = pos_receiver();
    EXPECT_TRUE(has_note(import_text(receiver, text),
                         "write speed_unit: km/h in the receiver, which fits the positions"));
    receiver.speed_unit = "km/h";
    const Observations read = import_text(receiver, text);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_speed_m_s, 10.0);
    EXPECT_FALSE(has_note(read, "write speed_unit"));
    receiver.speed_unit = "kn";
    EXPECT_NE(failure_of(receiver, tables[4].text)
                  .find("the header says m/s, and the attempt's speed_unit kn"),
              std::string::npos);
}

TEST(PresetTimes, LocalOnesMustBeStated) {
    std::string text = tables[3].text;
    for (std::size_t at; (at = text.find("Z,")) != std::string::npos;)
        text.erase(at, 1);
    Receiver receiver = pos_receiver();
    EXPECT_NE(failure_of(receiver, text).find("Write time_scale: local and utc_offset_h"),
              std::string::npos);
    receiver.time_scale = "local";
    receiver.utc_offset_h = 2.0;
    const Observations local = import_text(receiver, text);
    receiver.time_scale = "utc";
    const Observations utc = import_text(receiver, text);
    EXPECT_EQ(utc.facts.first_epoch->nanoseconds() - local.facts.first_epoch->nanoseconds(),
              std::int64_t{7200} * 1'000'000'000);
}

// A receiver of 5 Hz beside sensors of 20 Hz: three of four rows lie between its fixes.
TEST(PresetRows, BetweenFixesAreLeftOut) {
    std::string text = tables[2].text.substr(0, tables[2].text.find("1767150797.0"));
    const auto noise = [](int fix) { return static_cast<double>(fix * fix * 7 % 13 - 6); };
    for (int row = 0; row <= 4 * 30; ++row) {
        const int fix = row / 4;
        const double share = static_cast<double>(row % 4) / 4.0;
        const double mixed = (1.0 - share) * noise(fix) + share * noise(fix + 1);
        text += fmt::format("{:.2f},0,1,3.0,120.0,0.0,{:.7f},9.1250000,12.5,{:.5f},0.1,99,77\n",
                            1767150797.0 + 0.05 * row, 45.25 + 4.5e-6 * row + 2e-7 * mixed,
                            10.0 + 0.02 * mixed);
    }
    const Observations read = import_text(pos_receiver(), text);
    EXPECT_EQ(read.rows.size(), 31U);
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 0.2);
    EXPECT_TRUE(has_note(read, "90 of 121 rows are interpolated between fixes")) << noted(read);
    // Too few to know the interval of the fixes by.
    std::size_t end = 0;
    for (int line = 0; line < 20; ++line)
        end = text.find('\n', end) + 1;
    EXPECT_FALSE(has_note(import_text(pos_receiver(), text.substr(0, end)), "interpolated"));
}

// Fixes of 25 Hz at multiples of 0.04 s, by the grid that an independent script counted: 1576 rows
// of 2488 lie on it to 0.4 ms, two more to 1 ms, and 61 of them stand there twice.
TEST(PresetsRecorded, RaceChronosInterpolatedRowsAreLeftOut) {
    const auto bytes = recorded("other_programs/racechrono_v3.csv");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes);
    EXPECT_EQ(read.format, "racechrono");
    EXPECT_EQ(read.rows.size(), 1517U);
    EXPECT_TRUE(has_note(read, "61 of 2488 rows stand there twice")) << noted(read);
    std::size_t off = 0;
    for (const Observation& row : read.rows) {
        const double intervals = static_cast<double>(row.time.nanoseconds) / 40e6;
        off += std::abs(intervals - std::round(intervals)) > 0.05 ? 1 : 0;
    }
    EXPECT_LE(off, 2U);
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 0.04);
    EXPECT_DOUBLE_EQ(*read.rows[0].latitude_deg, 31.0781678);
    EXPECT_NEAR(std::hypot(*read.rows[0].recorded_velocity_east_m_s,
                           *read.rows[0].recorded_velocity_north_m_s),
                33.453, 1e-9);
    EXPECT_TRUE(has_note(read, "910 of 2488 rows are interpolated between fixes")) << noted(read);
}

// GPS_Update is 1 in 196 of 3991 rows, by a script.
TEST(PresetsRecorded, TrackAddictsRepeatedPositionsAreLeftOut) {
    const auto bytes = recorded("other_programs/trackaddict.csv");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes);
    EXPECT_EQ(read.format, "trackaddict");
    ASSERT_EQ(read.rows.size(), 196U);
    EXPECT_TRUE(has_note(read, "3795 of 3991 rows repeat the last position")) << noted(read);
    EXPECT_NEAR(*read.rows[0].sigma_east_m, 6.0 / std::sqrt(2.0), 1e-12);
}

// GPS week 1984's first second, by the calendar: 2018-01-14; the file has seconds of week alone.
TEST(PresetsRecorded, TablesByBlanksHaveColumnsByNumber) {
    const auto bytes = recorded("other_programs/kfgins_spaces.txt");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    Receiver receiver = csv_receiver();
    receiver.columns = {{"time", "1"},    {"latitude", "2"},    {"longitude", "3"},
                        {"height", "4"},  {"sigma_north", "5"}, {"sigma_east", "6"},
                        {"sigma_up", "7"}};
    const Observations read = import_text(receiver, *bytes);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(read.rows.size(),
              static_cast<std::size_t>(std::count(bytes->begin(), bytes->end(), '\n')));
    EXPECT_DOUBLE_EQ(*read.rows[0].latitude_deg, 30.4447858054);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_east_m, 0.009);
    EXPECT_EQ(read.rows[1].time.nanoseconds, 1'000'000'000);
    EXPECT_FALSE(has_note(read, "above the table's header"));
}

TEST(TableHead, IsFoundUnderWhatStandsAboveIt) {
    const std::string rows = "1.5,45.25,9.125,120\n2.5,45.26,9.125,121\n";
    for (const std::string& above :
         {std::string(), std::string("logger 7, of today\nserial,12,34\n\n"),
          std::string("# comment\n\"key, quoted\",1\nunpaired \"\n"),
          std::string("1,2,3,4\n5,6,7,8\n")}) {
        const Observations read = import_text(csv_receiver(), above + "time,lat,lon,h\n" + rows);
        ASSERT_EQ(read.rows.size(), 2U) << above;
        EXPECT_DOUBLE_EQ(*read.rows[1].height_m, 121.0);
        EXPECT_EQ(has_note(read, "above the table's header"), !above.empty());
    }
    // In a comment, as numerical programs write it; and with units under it.
    EXPECT_EQ(import_text(csv_receiver(), "# time,lat,lon,h\n" + rows).rows.size(), 2U);
    const Observations units =
        import_text(csv_receiver(), "time,lat,lon,h\n(s),(deg),(deg),(m)\n\n" + rows);
    EXPECT_EQ(units.rows.size(), 2U);
    EXPECT_EQ(units.records.bad, 0);
    EXPECT_TRUE(has_note(units, "1 line under the table's header holds no numbers"));
    // A first row that is damaged is a row.
    EXPECT_EQ(import_text(csv_receiver(), "time,lat,lon,h\nx,45,9,120\n" + rows).records.bad, 1);
}

TEST(TableHead, ColumnsByNumberBeginWithTheFirstRow) {
    Receiver receiver = csv_receiver();
    receiver.columns = {
        {"time", "1"}, {"latitude", "2"}, {"longitude", "3"}, {"height", "4"}, {"speed", "5"}};
    const std::string rows = "1.5 45.25  9.125 120 36\n2.5 45.26  9.125 121 36\n";
    const Observations plain = import_text(receiver, "solution of today\n\n" + rows);
    EXPECT_EQ(plain.rows.size(), 2U);
    EXPECT_DOUBLE_EQ(*plain.rows[0].recorded_speed_m_s, 36.0);
    const Observations named = import_text(receiver, "t lat lon h km/h\n" + rows);
    EXPECT_DOUBLE_EQ(*named.rows[0].recorded_speed_m_s, 10.0);
}

TEST(TableUnits, OfHeaderAndUnitsLineAreUsed) {
    Receiver receiver = csv_receiver();
    receiver.columns["speed"] = "v (kn)";
    receiver.columns["quality_2d"] = "acc";
    const Observations read = import_text(
        receiver, "time,lat,lon,h,v (kn),acc\n,,,ft,,mm\n0,45,9,100,10,30\n1,45,9,100,10,30\n");
    EXPECT_DOUBLE_EQ(*read.rows[0].height_m, 30.48);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_speed_m_s, 10.0 * 1852.0 / 3600.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_east_m, 0.03 / std::sqrt(2.0));
    EXPECT_TRUE(has_note(read, "The column \"v (kn)\" is in kn, and was turned to m/s"));
    Receiver other = csv_receiver();
    other.columns["latitude"] = "lat [rad]";
    const std::string text = "time,lat [rad],lon,h\n0,0.5,0.1,100\n1,0.5,0.1,100\n";
    EXPECT_TRUE(has(failure_of(other, text),
                    "the coordinate \"lat [rad]\" is in rad. Give the recording with "
                    "coordinates in degrees"))
        << failure_of(other, text);
    Receiver plane = csv_receiver();
    plane.frame = StatedFrame{CoordinateFrame::local_plane};
    plane.columns = {{"time", "time"}, {"east", "e [ft]"}, {"north", "n [ft]"}};
    EXPECT_NE(failure_of(plane, "time,e [ft],n [ft]\n0,1,2\n1,2,3\n").find("is in ft"),
              std::string::npos);
}

TEST(TableTimes, ThatEndInZSayThemselvesThatTheyAreUtc) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "iso";
    receiver.time_scale.clear();
    const std::string text =
        "time,lat,lon,h\n2023-07-11T06:04:30Z,45,9,1\n2023-07-11T06:04:31Z,45,9,1\n";
    const Observations read = import_text(receiver, text);
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.facts.first_epoch->calendar().second, 48);  // 18 leap seconds
    receiver.time_scale = "gps";
    EXPECT_NE(failure_of(receiver, text).find("the attempt says GPS time"), std::string::npos);
}

TEST(TableFixes, RowsThatRepeatThePositionAreNotUsed) {
    Receiver receiver = csv_receiver();
    receiver.columns["new_fix"] = "n";
    const std::string text = "time,lat,lon,h,n\n0,45,9,1,1\n0.5,45,9,1,0\n1,45,9,1,1\n";
    const Observations read = import_text(receiver, text);
    EXPECT_EQ(read.rows.size(), 2U);
    EXPECT_EQ(read.records.total, 3);
    EXPECT_TRUE(has_note(read, "by the column new_fix: 1."));
    EXPECT_EQ(import_text(receiver, text + "2,45,9,1,yes\n3,45,9,1,1\n").records.bad, 1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
