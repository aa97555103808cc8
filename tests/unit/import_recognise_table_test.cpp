#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "core/text.h"
#include "import_inspect_support.h"
#include "import_test_support.h"
#include "stages/import/recognise.h"
#include "store/atomic_file.h"

// What is proposed of tables that other programs write, and what they are found not to say.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Recognition recognised(const std::string& text, const CsvColumns& given = {}) {
    return recognition_of_table({.name = "log.csv", .bytes = text}, given);
}

std::string written_by(const std::string& program) {
    return read_file(std::string(RUNCERT_SOURCE_DIR) + "/tests/chain/data/tables/" + program +
                     ".csv");
}

std::string proposed(const Recognition& is) {
    std::vector<std::string> keys;
    for (const ProposedKey& one : is.proposed) {
        keys.push_back(one.key + "=" + one.value);
        EXPECT_FALSE(one.reason.empty() && is.kind == RecordingKind::positions) << one.key;
    }
    return fmt::format("{}", fmt::join(keys, " "));
}

std::string needed(const Recognition& is) {
    std::vector<std::string> keys;
    for (const NeededKey& one : is.needed)
        if (one.required) keys.push_back(one.key);
    return fmt::format("{}", fmt::join(keys, " "));
}

TEST(RecogniseTable, TablesOfTenPrograms) {
    const struct {
        const char *program, *keys, *needed, *first;
    } tables[] = {
        {"gpslogger_android",
         "frame=geodetic time_format=iso columns.time=time columns.latitude=lat "
         "columns.longitude=lon columns.height=elevation columns.quality_2d=accuracy "
         "columns.speed=speed columns.course=bearing columns.satellites=satellites speed_unit=m/s",
         "accuracy.vertical_m",
         "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, height 44.10 m, "
         "speed 0.22 km/h"},
        {"sensor_logger_ios",
         "frame=geodetic time_format=unix columns.time=time columns.latitude=latitude "
         "columns.longitude=longitude columns.height=altitude "
         "columns.quality_2d=horizontalAccuracy columns.quality_height=verticalAccuracy "
         "columns.speed=speed columns.course=bearing columns.sigma_speed=speedAccuracy "
         "speed_unit=m/s",
         "", "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, height 44.20 m"},
        {"edgetx",
         "frame=geodetic time_format=time_of_day columns.date=Date columns.time=Time "
         "columns.latitude=GPS columns.longitude=GPS columns.height=Alt(m) columns.speed=GSpd(kmh) "
         "columns.course=Hdg(deg)",
         "time_scale accuracy.horizontal_m accuracy.vertical_m",
         "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, height 44.00 m, "
         "speed 0.22 km/h"},
        {"gpsbabel_unicsv",
         "frame=geodetic time_format=time_of_day columns.date=Date columns.time=Time "
         "columns.latitude=Latitude columns.longitude=Longitude columns.height=Altitude "
         "columns.speed=Speed columns.course=Course speed_unit=m/s",
         "time_scale accuracy.horizontal_m accuracy.vertical_m", "2026-03-14T13:00:18.000Z"},
        {"us_dates",
         "frame=geodetic time_format=iso columns.time=Timestamp columns.latitude=Latitude (deg) "
         "columns.longitude=Longitude (deg) columns.speed=Speed (mph)",
         "time_scale height_m accuracy.horizontal_m",
         "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, speed 0.23 km/h"},
        {"laptimer",
         "frame=geodetic time_format=time_of_day columns.date=DATE columns.time=TIME "
         "columns.latitude=LATITUDE columns.longitude=LONGITUDE columns.height=HEIGHT_M "
         "columns.speed=SPEED_KPH columns.course=HEADING_DEG speed_unit=km/h",
         "time_scale accuracy.horizontal_m accuracy.vertical_m",
         "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, height 44.10 m, "
         "speed 0.22 km/h"},
        {"racelogic_export",
         "frame=geodetic time_format=time_of_day columns.time=Time columns.latitude=Latitude "
         "columns.longitude=Longitude columns.height=Height columns.speed=Velocity kmh "
         "columns.course=Heading columns.satellites=Sats",
         "time_scale start_date accuracy.horizontal_m accuracy.vertical_m",
         "2000-01-01T13:00:18.000Z"},
        {"waypoint_export",
         "frame=geodetic time_format=seconds_of_week columns.time=GPSTime columns.week=Week "
         "columns.latitude=Latitude columns.longitude=Longitude columns.height=H-Ell "
         "columns.sigma_east=SDEast columns.sigma_north=SDNorth columns.sigma_up=SDHeight "
         "columns.velocity_east=VEast columns.velocity_north=VNorth columns.velocity_up=VUp "
         "columns.satellites=NS",
         "", "2026-03-14T13:00:18.000Z, latitude 52.1000000, longitude 5.1000000, height 88.41 m"},
        {"utm_survey",
         "time_format=time_of_day columns.date=Date columns.time=Time columns.east=Easting (m) "
         "columns.north=Northing (m) columns.up=Elevation (m) columns.quality_2d=CQ 2D (m) "
         "columns.quality_height=CQ 1D (m)",
         "frame time_scale", "2026-03-14T13:00:18.000Z"},
        {"unclear_date",
         "frame=geodetic time_format=time_of_day columns.date=date columns.time=time "
         "columns.latitude=lat columns.longitude=lon columns.height=alt columns.speed=speed "
         "speed_unit=m/s",
         "time_scale start_date accuracy.horizontal_m accuracy.vertical_m",
         "2026-03-04T13:00:18.000Z"}};
    for (const auto& table : tables) {
        SCOPED_TRACE(table.program);
        const Recognition is = recognised(written_by(table.program));
        EXPECT_EQ(is.kind, RecordingKind::positions) << is.problem;
        EXPECT_EQ(proposed(is), table.keys);
        EXPECT_EQ(needed(is), table.needed);
        ASSERT_EQ(is.rows.size(), 3U);
        EXPECT_EQ(is.rows.front().substr(0, std::string(table.first).size()), table.first);
        ASSERT_TRUE(is.speed_m_s);
        EXPECT_NEAR(*is.speed_m_s, 25.0, 0.1);
    }
}

TEST(RecogniseTable, SaysWhyATableIsNotRead) {
    const Recognition commas = recognised(written_by("german_sheet"));
    EXPECT_EQ(commas.kind, RecordingKind::table);
    EXPECT_NE(commas.problem.find("has a decimal comma"), std::string::npos) << commas.problem;
    const std::string grid = written_by("utm_survey");
    EXPECT_NE(
        import_test::text_of(recognised(grid)).find("frame: {utm: {zone: ..., hemisphere: ...}}"),
        std::string::npos);
    const std::string sheet = written_by("german_sheet");
    EXPECT_NE(import_test::text_of(recognised(sheet)).find("decimal commas (\"52,1000000\")"),
              std::string::npos);
    const Recognition counts = recognised(written_by("px4_gps"));
    EXPECT_EQ(counts.kind, RecordingKind::table);
    EXPECT_NE(counts.problem.find("521000000"), std::string::npos) << counts.problem;
    const Recognition imu = recognised("ax,ay,az\n0.1,0.2,1.0\n0.1,0.2,1.0\n");
    EXPECT_EQ(imu.kind, RecordingKind::table);
    EXPECT_TRUE(needed(imu).starts_with("columns.time columns.latitude columns.longitude"));
    EXPECT_EQ(imu.rows.front(), "ax 0.1, ay 0.2, az 1.0");
    EXPECT_THROW(recognised("hello to all of you\nwho read this\n"), Failure);
    EXPECT_THROW(recognised(""), Failure);
}

TEST(RecogniseTable, NamesAreNotTakenForWhatTheirColumnsCannotHold) {
    // "lateral" begins as a latitude does, a heading is no height, a count no time.
    std::string text = "count,lateral_g,time_s,Lat_deg,Long_deg,longitudinal_g,Alt_m,Speed_acc\n";
    for (int i = 0; i < 60; ++i)
        text += fmt::format("7,0.1,{:.1f},{:.7f},5.1,0.2,44.0,0.3\n", 0.2 * i, 52.1 + 1e-5 * i);
    const Recognition is = recognised(text);
    EXPECT_EQ(proposed(is),
              "frame=geodetic time_format=seconds columns.time=time_s columns.latitude=Lat_deg "
              "columns.longitude=Long_deg columns.height=Alt_m");
}

TEST(RecogniseTable, CoordinatesFromTheEarthsCentre) {
    std::string text = "host_time_s,x_ecef_m,y_ecef_m,z_ecef_m\n";
    for (int i = 0; i < 60; ++i)
        text += fmt::format("{:.2f},-2712087.5168,{:.4f},3881014.4539\n", 46408.5 + 0.1 * i,
                            -4261670.0 + 2.0 * i);
    const Recognition is = recognised(text);
    EXPECT_EQ(proposed(is),
              "frame=ecef time_format=seconds columns.time=host_time_s columns.x=x_ecef_m "
              "columns.y=y_ecef_m columns.z=z_ecef_m");
    EXPECT_FALSE(is.first);
}

TEST(RecogniseTable, WithoutAHeaderByTheirValues) {
    std::string text;
    for (int i = 0; i < 60; ++i)
        text += fmt::format("{:.3f} {:.10f} 114.4718661162 21.095 0.010 0.009\n", 456250.0 + i,
                            30.4447858054 + 1e-5 * i);
    const Recognition is = recognised(text);
    EXPECT_EQ(proposed(is),
              "frame=geodetic time_format=seconds columns.time=1 columns.latitude=2 "
              "columns.longitude=3 columns.height=4");
    EXPECT_NEAR(*is.latitude_deg, 30.4447858054, 1e-9);
}

TEST(RecogniseTable, WhatSomebodyNamesCountsBeforeWhatIsFound) {
    const std::string text = "a,b,c,d\n0.0,52.1,5.1,44\n0.2,52.10001,5.1,44\n0.4,52.10002,5.1,44\n";
    EXPECT_EQ(recognised(text).kind, RecordingKind::table);
    const Recognition is = recognised(text, {{"time", "a"}, {"latitude", "b"}, {"longitude", "3"}});
    EXPECT_EQ(is.kind, RecordingKind::positions) << is.problem;
    EXPECT_EQ(proposed(is),
              "frame=geodetic time_format=seconds columns.time=a columns.latitude=b "
              "columns.longitude=c");
    try {
        (void)recognised(text, {{"time", "z"}});
        ADD_FAILURE() << "taken";
    } catch (const Failure& failure) {
        EXPECT_NE(failure.problem().find("no column \"z\""), std::string::npos);
        EXPECT_NE(failure.remedy().find("from 1 to 4"), std::string::npos);
    }
}

/// A table of times of day without a date, read.
Observations timed(const std::string& times, const std::string& start_date,
                   const std::string& scale, std::optional<double> offset_h = std::nullopt) {
    std::string text = "time,lat,lon\n";
    for (const std::string& time : lines_of(times))
        text += time + ",52.1,5.1\n";
    Receiver receiver;
    receiver.id = "r";
    receiver.format = "csv";
    receiver.columns = {{"time", "time"}, {"latitude", "lat"}, {"longitude", "lon"}};
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.time_format = "time_of_day";
    receiver.time_scale = scale;
    receiver.utc_offset_h = offset_h;
    receiver.height_m = 0.0;
    receiver.start_date = start_date;
    return import_recording(receiver, {.name = "log.csv", .bytes = text});
}

std::string first_utc(const Observations& read) {
    return to_utc_iso(*read.facts.first_epoch, 0);
}

TEST(TimesOfDay, WithoutADateCountFromTheAttemptsDate) {
    const Observations night = timed("23:59:59\n00:00:00\n00:00:01", "2026-03-14", "utc");
    EXPECT_EQ(first_utc(night), "2026-03-14T23:59:59Z");
    EXPECT_EQ(night.rows.back().time.seconds(), 2.0);
    // Written out of order around midnight.
    EXPECT_EQ(timed("00:00:00\n23:59:59\n00:00:01", "2026-03-14", "utc").rows.size(), 3U);
    EXPECT_EQ(first_utc(timed("1:00:00.0 PM\n1:00:00.2 PM", "2026-03-14", "utc")),
              "2026-03-14T13:00:00Z");
    // 08:00 at UTC+10 is of the UTC day before, which the attempt names.
    EXPECT_EQ(first_utc(timed("08:00:00\n08:00:01", "2026-03-13", "local", 10.0)),
              "2026-03-13T22:00:00Z");
    EXPECT_THROW(timed("08:00:00\n08:00:01", "", "utc"), Failure);
    EXPECT_THROW(timed("08:00:00\n08:00:01", "2026-02-30", "utc"), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
