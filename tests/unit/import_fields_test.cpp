#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/text.h"
#include "core/written_unit.h"
#include "import_inspect_support.h"
#include "import_test_support.h"
#include "stages/import/csv/propose.h"
#include "stages/import/novatel/log.h"

// What is known of fields in one place, as pairs of input and table: each way of writing gives the
// same run, read by an attempt and as inspect proposes it.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

// ------------------------------------------------------------------------------------------- units

TEST(FieldUnits, AreReadFromNames) {
    const struct {
        const char *name, *unit;
    } speeds[] = {{"Speed (km/h)", "km/h"},
                  {"speed_kmh", "km/h"},
                  {"gps_speed_kmph", "km/h"},
                  {"SPEED_KPH", "km/h"},
                  {"SpeedKmh", "km/h"},
                  {"speed_km_h", "km/h"},
                  {"Velocity kmh", "km/h"},
                  {"Speed [kilometers per hour]", "km/h"},
                  {"speedkmph", "km/h"},
                  {"KPH", "km/h"},
                  {"speed_mph", "mph"},
                  {"Speed (mi/h)", "mph"},
                  {"sog_kts", "kn"},
                  {"SOG (knots)", "kn"},
                  {"v (kn)", "kn"},
                  {"speed_m_s", "m/s"},
                  {"speed_ms", "m/s"},
                  {"GPS Speed (Meters/second)", "m/s"},
                  {"GPS (2D speed) [m/s]", "m/s"},
                  {"speed_cm_s", "cm/s"},
                  {"gSpeed (mm/s)", "mm/s"},
                  {"speed_fps", "ft/s"},
                  {"speed", ""},
                  {"Speed (OBD)", ""},
                  {"speed_accuracy", ""},
                  {"vE", ""}};
    for (const auto& one : speeds) {
        const auto unit = unit_in_name(one.name, Quantity::speed);
        EXPECT_EQ(unit ? unit->name : "", one.unit) << one.name;
    }
    EXPECT_EQ(unit_in_name("lat_rad", Quantity::angle)->name, "rad");
    EXPECT_EQ(unit_in_name("lon [rad]", Quantity::angle)->name, "rad");
    EXPECT_EQ(unit_in_name("alt_ft", Quantity::length)->name, "ft");
    EXPECT_EQ(unit_in_name("HEIGHT_M", Quantity::length)->name, "m");
    EXPECT_FALSE(unit_in_name("hAccM", Quantity::length));
    EXPECT_FALSE(unit_in_name("grad", Quantity::angle));
    EXPECT_EQ(unit_in_name("latrad", Quantity::angle)->name, "rad");
    EXPECT_EQ(unit_in_name("e_usft", Quantity::length)->name, "US survey ft");
    EXPECT_EQ(unit_in_name("e (US survey feet)", Quantity::length)->factor, 1200.0 / 3937.0);
    EXPECT_EQ(unit_in_name("e_yd", Quantity::length)->factor, 0.9144);
    EXPECT_EQ(unit_in_name("time_ms", Quantity::time)->name, "ms");
}

TEST(FieldUnits, OfSpeedThatAreNotKnownAreRefused) {
    Receiver receiver = csv_receiver();
    receiver.columns["speed"] = "speed (dm/s)";
    const std::string text = "time,lat,lon,h,speed (dm/s)\n0,45,9,1,10\n1,45,9,1,10\n";
    EXPECT_TRUE(has(failure_of(receiver, text), "the unit \"dm/s\" of the column"));
    receiver.speed_unit = "m/s";
    EXPECT_EQ(failure_of(receiver, text), "read");
}

TEST(FieldUnits, OfACellCountAndMayNotContradictTheHeader) {
    Receiver receiver = csv_receiver();
    receiver.columns["speed"] = "v";
    const Observations read =
        import_text(receiver, "time,lat,lon,h,v\n0,45,9,100 ft,36 km/h\n1,45,9,30.48 M,10\n");
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_speed_m_s, 10.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].height_m, *read.rows[1].height_m);
    receiver.columns["speed"] = "v (kn)";
    EXPECT_TRUE(has(complaint_of(receiver, "time,lat,lon,h,v (kn)\n0,45,9,1,36 km/h\n1,45,9,1,3\n"),
                    "in another unit than its column"));
}

// ----------------------------------------------------------------------------------------- one run

/// 40 s towards north at 20 m/s and 10 Hz near 31.6 S, 136 E.
struct Instant {
    double t_s, latitude_deg, longitude_deg;
};

std::vector<Instant> run() {
    std::vector<Instant> all;
    for (int i = 0; i < 400; ++i)
        all.push_back({0.1 * i, -31.6 + 20.0 * 0.1 * i / 110'876.0, 136.00012345});
    return all;
}

/// Seconds of the time of day from 10:00:00 on.
std::string clock_text(double t_s) {
    return fmt::format("10:00:{:06.3f}", t_s);
}

template <class Row>
std::string table(const std::string& header, Row row) {
    std::string text = header + "\n";
    for (const Instant& one : run())
        text += row(one) + "\n";
    return text;
}

/// As inspect reads it.
Observations proposed(const std::string& text) {
    auto proposal = csv::propose({.name = "log.csv", .bytes = text});
    if (!proposal || !proposal->read) {
        ADD_FAILURE() << (proposal ? proposal->is.problem : "no table") << "\n"
                      << text.substr(0, 200);
        return {};
    }
    return std::move(*proposal->read);
}

void expect_run(const Observations& read) {
    ASSERT_EQ(read.rows.size(), run().size());
    EXPECT_NEAR(*read.rows[0].latitude_deg, -31.6, 1e-7);
    EXPECT_NEAR(*read.rows[0].longitude_deg, 136.00012345, 1e-7);
    EXPECT_NEAR(*read.rows.back().latitude_deg, run().back().latitude_deg, 1e-7);
    EXPECT_NEAR(read.rows.back().time.seconds(), 39.9, 1e-4);
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch, 0), "2026-03-14T10:00:00Z");
}

/// Degrees, minutes and seconds in a pattern.
std::string dms(double degrees, const char* pattern) {
    const double size = std::abs(degrees);
    const double whole = std::floor(size), minutes = std::floor((size - whole) * 60.0);
    return fmt::format(fmt::runtime(pattern), degrees < 0.0 ? "-" : "", whole, minutes,
                       ((size - whole) * 60.0 - minutes) * 60.0);
}

TEST(FieldAngles, AreReadHoweverTheyAreWritten) {
    const char* patterns[] = {"{}{:.0f} {:02.0f} {:09.6f}", "{}{:.0f}:{:02.0f}:{:09.6f}",
                              "{}{:.0f}d{:02.0f}m{:09.6f}s", "{}{:.0f}\xc2\xb0{:02.0f}'{:09.6f}"};
    for (const char* pattern : patterns) {
        SCOPED_TRACE(pattern);
        const Observations read = proposed(table("time,lat,lon,alt", [&](const Instant& one) {
            return fmt::format("2026-03-14T{}Z,{},{},100.0", clock_text(one.t_s),
                               dms(one.latitude_deg, pattern), dms(one.longitude_deg, pattern));
        }));
        expect_run(read);
        EXPECT_NEAR(*read.facts.position_resolution_m, 1e-6 / 3600.0 * 110'876.0, 1e-5);
    }
    const auto minutes = [](double degrees) {
        const double whole = std::floor(std::abs(degrees));
        return fmt::format("{:.0f}{:010.7f}", whole, (std::abs(degrees) - whole) * 60.0);
    };
    const Observations read = proposed(table("time,lat,lon,alt", [&](const Instant& one) {
        return fmt::format("2026-03-14T{}Z,-{},{},100.0", clock_text(one.t_s),
                           minutes(one.latitude_deg), minutes(one.longitude_deg));
    }));
    expect_run(read);
    EXPECT_TRUE(has_note(read, "dddmm.mmmm")) << noted(read);
}

// One coordinate alone, or one row, shows nothing of the other: at 60 N it would make a run twice
// as fast as it was.
TEST(FieldAngles, InMinutesAloneBesideDegreesAreRefused) {
    const Receiver receiver = csv_receiver();
    for (const char* row : {"59.5,2430.000004", "5930.0,24.5"}) {
        std::string text = "time,lat,lon,h\n";
        for (int i = 0; i < 20; ++i)
            text += fmt::format("{},{},1\n", i, row);
        EXPECT_TRUE(has(failure_of(receiver, text), "is impossible")) << row;
    }
    std::string text = "time,lat,lon,h\n";
    for (int i = 0; i < 20; ++i)
        text += fmt::format("{},-31.6{:03},{},1\n", i, i, i == 7 ? "2430.1" : "136.0");
    const Observations read = import_text(receiver, text);
    ASSERT_EQ(read.rows.size(), 19U);
    EXPECT_NEAR(*read.rows[0].longitude_deg, 136.0, 1e-12);
}

// A counter or a latency beside one row a second parts nothing.
TEST(FieldTimes, AColumnCalledMsCountsOnlyWhereItPartsSeconds) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "iso";
    receiver.time_scale = "utc";
    std::string text = "time,ms,lat,lon,h\n";
    for (int i = 0; i < 30; ++i)
        text += fmt::format("2026-03-14T10:00:{:02}Z,{},45.{:04},9,1\n", i, 980 - 16 * i, i);
    const Observations read = import_text(receiver, text);
    ASSERT_EQ(read.rows.size(), 30U);
    EXPECT_NEAR(read.rows.back().time.seconds(), 29.0, 1e-9);
    EXPECT_FALSE(has_note(read, "milliseconds"));
}

TEST(FieldUnits, ALineOfUnitsMayNotContradictAName) {
    Receiver receiver = csv_receiver();
    receiver.columns["height"] = "h_m";
    EXPECT_TRUE(has(failure_of(receiver, "time,lat,lon,h_m\n(s),(deg),(deg),(ft)\n0,45,9,1\n"),
                    "m by its name, and ft by the line below"));
}

TEST(FieldAngles, InThreeFieldsUnderOneName) {
    const std::string text = table(
        "Week GPSTime Latitude Longitude H-Ell\n(weeks) (sec) (+/"
        "-D M S) (+/"
        "-D M S) (m)",
        [&](const Instant& one) {
            return fmt::format("2409 {:.2f} {} {} 100.0", 554418.0 + one.t_s,
                               dms(one.latitude_deg, "{}{:.0f} {:02.0f} {:09.6f}"),
                               dms(one.longitude_deg, "{}{:.0f} {:02.0f} {:09.6f}"));
        });
    expect_run(proposed(text));
    Receiver receiver = csv_receiver();
    receiver.columns = {{"time", "GPSTime"},
                        {"week", "Week"},
                        {"latitude", "Latitude"},
                        {"longitude", "Longitude"},
                        {"height", "H-Ell"}};
    receiver.time_format = "seconds_of_week";
    expect_run(import_text(receiver, text));
}

TEST(FieldHemispheres, AreUsedWhereverTheyStand) {
    const char* headers[] = {"time,lat,ns,lon,ew,alt", "time,latitude,N/S,longitude,E/W,alt",
                             "time,lat,latdir,lon,londir,alt"};
    for (const char* header : headers) {
        SCOPED_TRACE(header);
        const std::string text = table(header, [](const Instant& one) {
            return fmt::format("2026-03-14T{}Z,{:.9f},S,{:.9f},E,100", clock_text(one.t_s),
                               -one.latitude_deg, one.longitude_deg);
        });
        expect_run(proposed(text));
        Receiver receiver = csv_receiver();
        receiver.time_format = "iso";
        receiver.time_scale = "utc";
        receiver.columns = {
            {"time", "time"}, {"latitude", "2"}, {"longitude", "4"}, {"height", "alt"}};
        const Observations read = import_text(receiver, text);
        expect_run(read);
        EXPECT_TRUE(has_note(read, "Hemispheres are those of")) << noted(read);
    }
    for (const auto& [latitude, longitude] :
         {std::pair{"{:.9f}S", "{:.9f}E"}, {"S{:.9f}", "E {:.9f}"}})
        expect_run(proposed(table("time,lat,lon,alt", [&](const Instant& one) {
            return fmt::format("2026-03-14T{}Z,{},{},100", clock_text(one.t_s),
                               fmt::format(fmt::runtime(latitude), -one.latitude_deg),
                               fmt::format(fmt::runtime(longitude), one.longitude_deg));
        })));
    Receiver receiver = csv_receiver();
    EXPECT_TRUE(
        has(complaint_of(receiver, "time,lat,ns,lon,h\n0,45,N,9,1\n1,45,N,9,1\n2,-45,N,9,1\n"),
            "has a minus, and its hemisphere is \"N\""));
    EXPECT_TRUE(has(failure_of(
                        [] {
                            Receiver swapped = csv_receiver();
                            swapped.columns["latitude"] = "lon";
                            swapped.columns["longitude"] = "lat";
                            return swapped;
                        }(),
                        "time,lat,lon,h\n0,45,9,1\n"),
                    "is named for latitude, and its own name says longitude"));
}

TEST(FieldTimes, AreReadHoweverTheyAreWritten) {
    const struct {
        const char* pattern;  ///< of the seconds, and of days of a spreadsheet
    } patterns[] = {
        {"2026-03-14T10:00:{0:06.3f}Z"},           {"2026-03-14T10:00:{0:06.3f}+0000"},
        {"2026-03-14T20:30:{0:06.3f}+10:30"},      {"2026-03-14 05:00:{0:06.3f}-05"},
        {"2026-03-14 10:00:{0:06.3f} UTC"},        {"14.03.2026 20:00:{0:06.3f} AEST"},
        {"2026-03-14 11:00:{0:06.3f} CET"},        {"14-MAR-26 10:00:{0:06.3f}"},
        {"14-Mar-2026 10:00:{0:06.3f}"},           {"Sat Mar 14 10:00:{0:06.3f} GMT 2026"},
        {"\"March 14, 2026 10:00:{0:06.3f} AM\""}, {"2026-Mar-14 10:00:{0:06.3f}"},
        {"14. M\xc3\xa4rz 2026 10:00:{0:06.3f}"},  {"{1:.10f}"}};
    for (const auto& one : patterns) {
        SCOPED_TRACE(one.pattern);
        expect_run(proposed(table("time,lat,lon,alt", [&](const Instant& at) {
            return fmt::format("{},{:.9f},{:.9f},100",
                               fmt::format(fmt::runtime(one.pattern), at.t_s,
                                           46'095.0 + (36'000.0 + at.t_s) / 86'400.0),
                               at.latitude_deg, at.longitude_deg);
        })));
    }
    expect_run(proposed(table("date,time,ms,lat,lon,alt", [](const Instant& at) {
        const double whole = std::floor(at.t_s + 1e-6);
        return fmt::format("14-MAR-26,10:00:{:02.0f},{:.0f},{:.9f},{:.9f},100", whole,
                           1000.0 * (at.t_s - whole), at.latitude_deg, at.longitude_deg);
    })));
}

TEST(FieldTimes, WithAnExponentCountWhereTheyShowWholeSeconds) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "unix";
    EXPECT_EQ(to_utc_iso(*import_text(receiver, "time,lat,lon,h\n1.773482400500e+09,45,9,1\n")
                              .facts.first_epoch),
              "2026-03-14T10:00:00.500Z");
    EXPECT_TRUE(has(failure_of(receiver, "time,lat,lon,h\n1.773482e+09,45,9,1\n"), "rounded it"));
}

// Midnight may be written without a point; an exponent is no part of a day that has one.
TEST(FieldTimes, ACountOfDaysIsReadWithOrWithoutAPoint) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "iso";
    const auto with_midnight_as = [](const std::string& text) {
        std::string table = "time,lat,lon,h\n";
        for (int i = -10; i <= 10; ++i)
            table += (i == 0 ? text : fmt::format("{:.10f}", 46'096.0 + i / 172'800.0)) +
                     fmt::format(",45.{:05},9,1\n", i + 10);
        return table;
    };
    const Observations read = import_text(receiver, with_midnight_as("46096"));
    ASSERT_EQ(read.rows.size(), 21U);
    EXPECT_NEAR(read.rows[10].time.seconds(), 5.0, 1e-5);
    for (const char* other : {"4.6096e4", "-46096.5", ".5"})
        EXPECT_TRUE(has(complaint_of(receiver, with_midnight_as(other)), "not a count of days"))
            << other;
}

TEST(FieldTimes, ThatContradictTheAttemptAreRefused) {
    Receiver receiver = csv_receiver();
    receiver.time_format = "iso";
    receiver.time_scale = "gps";
    EXPECT_TRUE(has(failure_of(receiver, "time,lat,lon,h\n2026-03-14T10:00:00+02:00,45,9,1\n"),
                    "the attempt says GPS time"));
    receiver.time_scale = "utc";
    EXPECT_TRUE(has(failure_of(receiver, "time,lat,lon,h\n2026-03-14T10:00:00 EST,45,9,1\n"),
                    "ends in \"EST\""));
    receiver.time_format = "seconds";
    EXPECT_TRUE(has(failure_of(receiver,
                               "time,lat,lon,h\n46095.4166666667,45,9,1\n46095.4166678241,45,9,1\n"
                               "46095.4166689815,45,9,1\n"),
                    "days of a spreadsheet"));
}

TEST(FieldRows, NewestFirstArePutInOrder) {
    std::string text = "time,lat,lon,h\n";
    for (int i = 50; i-- > 0;)
        text += fmt::format("{}.0,45.{:04},9,1\n", i, i);
    const Observations read = import_text(csv_receiver(), text + "x,45,9,1\n");
    ASSERT_EQ(read.rows.size(), 50U);
    EXPECT_EQ(read.rows.front().time.seconds(), 0.0);
    EXPECT_EQ(read.rows.front().epoch, 1);
    EXPECT_EQ(read.rows.front().source_line, 51);
    EXPECT_EQ(read.rows.back().time.seconds(), 49.0);
    EXPECT_EQ(read.facts.nominal_interval_s, 1.0);
    EXPECT_EQ(read.records.bad_records.at(0).epoch, 0);
    EXPECT_TRUE(has_note(read, "newest first"));
    EXPECT_EQ(inspect(read).backward_times, 0U);
}

TEST(FieldRows, OfOtherSensorsAreNoEpochs) {
    std::string text =
        "\"Interval\"|\"ms\"|0|0|1,\"Utc\"|\"ms\"|0|0|1,\"AccelX\"|\"G\"|-3.0|3.0|50,"
        "\"Latitude\"|\"Degrees\"|-180.0|180.0|10,"
        "\"Longitude\"|\"Degrees\"|-180.0|180.0|10,\"Speed\"|\"mph\"|0.0|150.0|10,"
        "\"Altitude\"|\"ft\"|0.0|4000.0|10\n";
    for (int i = 0; i < 200; ++i)
        text += i % 5 == 0 ? fmt::format("{0},{1},0.1,45.{0:06},9,10,100\n", 20 * i,
                                         1773482400000 + 20LL * i)
                           : fmt::format("{},{},0.1,,,,\n", 20 * i, 1773482400000 + 20LL * i);
    const Observations read = proposed(text);
    ASSERT_EQ(read.rows.size(), 40U);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_speed_m_s, 4.4704);
    EXPECT_DOUBLE_EQ(*read.rows[0].height_m, 30.48);
    EXPECT_TRUE(has_note(read, "160 of 200 rows have no position"));
}

TEST(FieldRows, ThatAreNoSatellitesPositionsAreNone) {
    std::string text = "time,lat,lon,elevation,provider,isMockLocation\n";
    for (int i = 0; i < 20; ++i)
        text += fmt::format("2026-03-14T10:00:{:02}Z,45.{:03},9,1,{},false\n", i, i,
                            i == 7 ? "network" : "gps");
    const Observations read = proposed(text);
    EXPECT_EQ(read.rows.at(7).fix, FixType::none);
    EXPECT_FALSE(read.rows.at(7).latitude_deg);
    EXPECT_TRUE(read.rows.at(8).latitude_deg);
    EXPECT_FALSE(read.simulated);
    EXPECT_TRUE(proposed(replaced(text, "gps,false", "gps,true")).simulated);
}

TEST(FieldRows, StampsInBurstsAreSaid) {
    std::string text = "time,lat,lon,h\n";
    for (int i = 0; i < 120; ++i)
        text += fmt::format("{:.3f},45.{:05},9,1\n", 0.3 * (i / 3) + 0.001 * (i % 3), i);
    const Observations read = import_text(csv_receiver(), text);
    EXPECT_EQ(bursts_in(read.rows), "3 within 0.002 s, then 0.298 s");
    EXPECT_TRUE(has(inspection_text(read), "Time stamps come in bursts"));
    // A recording with gaps, or at two rates, has none.
    text = "time,lat,lon,h\n";
    for (int i = 0; i < 120; ++i)
        text += fmt::format("{:.3f},45.{:05},9,1\n", 0.02 * i + (i / 40) * 5.0, i);
    EXPECT_EQ(bursts_in(import_text(csv_receiver(), text).rows), "");
}

TEST(FieldRows, SinglePrecisionCountsAsTheStepThatIsWritten) {
    std::string text = "time,lat,lon,h\n", fine = text;
    for (int i = 0; i < 60; ++i) {
        const double latitude = -31.6 + 1.7e-5 * i, longitude = 136.0 + 2.3e-5 * i;
        text += fmt::format("{},{:.7f},{:.7f},1\n", i,
                            static_cast<double>(static_cast<float>(latitude)),
                            static_cast<double>(static_cast<float>(longitude)));
        fine += fmt::format("{},{:.7f},{:.7f},1\n", i, latitude, longitude);
    }
    const Observations read = import_text(csv_receiver(), text);
    EXPECT_NEAR(*read.facts.position_resolution_m, 1.45, 0.02);
    EXPECT_TRUE(has_note(read, "went through single precision")) << noted(read);
    EXPECT_NEAR(*import_text(csv_receiver(), fine).facts.position_resolution_m, 0.011, 1e-3);
}

TEST(FieldColumns, OfOtherProgramsAreFound) {
    const std::string text = table(
        "Date (UTC),Time (UTC),Position latitude (deg),Position longitude (deg),Position altitude "
        "(m),North position accuracy (m),East position accuracy (m),Down position accuracy "
        "(m),Velocity north (m/s),Velocity east (m/s),Velocity down (m/s),GNSS position mode",
        [](const Instant& one) {
            return fmt::format(
                "14/03/2026,{},{:.9f},{:.9f},100,0.01,0.02,0.03,20,0,-0.5,RTK Integer",
                clock_text(one.t_s), one.latitude_deg, one.longitude_deg);
        });
    const Observations read = proposed(text);
    expect_run(read);
    EXPECT_EQ(read.rows[0].height_m, 100.0);
    EXPECT_EQ(read.rows[0].recorded_velocity_up_m_s, 0.5);
    EXPECT_EQ(read.rows[0].sigma_east_m, 0.02);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
}

// ------------------------------------------------------------------------------------- NMEA,
// others

std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body)
        sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

std::string gga(int tenth, const std::string& separation, double altitude_m = 50.0) {
    return sentence(
        fmt::format("GNGGA,1000{:02}.{}0,5236.0000{},N,00518.00000,E,4,14,0.7,{:.2f},M,{},M,,",
                    tenth / 10, tenth % 10, tenth % 10, altitude_m, separation));
}

std::string rmc(int tenth) {
    return sentence(
        fmt::format("GNRMC,1000{:02}.{}0,A,5236.0000{},N,00518.00000,E,1.0,0.0,140326,,,R",
                    tenth / 10, tenth % 10, tenth % 10));
}

TEST(FieldHeights, AreTakenBetweenSentencesOfALowerRate) {
    std::string text;
    for (int i = 0; i < 40; ++i)
        text += (i % 10 == 0 ? gga(i, "42.0", 50.0 + 0.1 * i) : "") + rmc(i);
    const Observations read = import_text(pos_receiver(), text);
    ASSERT_EQ(read.rows.size(), 40U);
    EXPECT_NEAR(*read.rows[5].height_m, 92.5, 1e-9);
    EXPECT_NEAR(*read.rows[39].height_m, 95.0, 1e-9);
    EXPECT_TRUE(has_note(read, "36 positions have no height of their own"));
}

TEST(FieldHeights, WithoutTheirSeparationGetThatOfTheEpochsBeside) {
    for (const char* missing : {"", "0.0"}) {
        std::string text;
        for (int i = 0; i < 30; ++i)
            text += gga(i, i < 5 || i > 20 ? missing : "42.0");
        const Observations read = import_text(pos_receiver(), text);
        for (const Observation& row : read.rows)
            EXPECT_EQ(row.height_m, 92.0) << row.epoch;
        EXPECT_TRUE(has_note(read,
                             "separation is missing, or zero where others have one: that of "
                             "the epochs beside them was added: 14."))
            << noted(read);
    }
    const Observations never = import_text(pos_receiver(), gga(1, "") + gga(2, ""));
    EXPECT_EQ(never.rows[0].height_m, 50.0);
    EXPECT_TRUE(has_note(never, "Heights written without a geoid separation"));
}

TEST(FieldLogs, OfUnicoreAreReadAsNovatels) {
    const auto log = [](const std::string& body) {
        return fmt::format("#{}*{:08x}\r\n", body, novatel::crc32(body));
    };
    const std::string place =
        "SOL_COMPUTED,NARROW_INT,-31.5,136.25,112.9951,-3.0,WGS84,0.01,0.02,0.03,\"0\",1.0,0.0,20,"
        "18,"
        "18,18,0,06,11,33";
    std::string text;
    for (int i = 0; i < 3; ++i)
        text +=
            log(fmt::format("BESTNAVA,97,GPS,FINE,2409,{},0,0,18,12;{},SOL_COMPUTED,"
                            "DOPPLER_VELOCITY,0.0,0.0,28.5,90.0,0.25,0.03,0.02",
                            554446000 + 100 * i, place));
    const Observations read = import_text(pos_receiver(), text);
    ASSERT_EQ(read.rows.size(), 3U);
    EXPECT_EQ(read.variant, "BESTNAVA");
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), "2026-03-14T10:00:28.000Z");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 100'000'000);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_NEAR(*read.rows[0].height_m, 109.9951, 1e-9);
    EXPECT_NEAR(*read.rows[0].recorded_velocity_east_m_s, 28.5, 1e-12);
    EXPECT_EQ(read.rows[0].sigma_recorded_velocity_east_m_s, 0.02);
    EXPECT_EQ(read.rows[0].sigma_recorded_velocity_up_m_s, 0.03);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
