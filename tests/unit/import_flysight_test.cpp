#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "import_test_support.h"
#include "stages/import/inspect.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

const std::string first_header =
    "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,heading,cAcc,gpsFix,numSV\r\n"
    ",(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),(deg),(deg),,\r\n";
const std::string first_row =
    "2023-08-20T18:09:07.40Z,37.5000125,-121.2500375,7.309,3.00,-4.00,12.50,2.000,3.500,0.30,"
    "0.00000,180.00000,3,10\r\n";
const std::string second_header =
    "$FLYS,1\r\n$VAR,FIRMWARE_VER,v2024.08.07\r\n$VAR,DEVICE_ID,004e003a\r\n"
    "$COL,GNSS,time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,numSV\r\n"
    "$UNIT,GNSS,,deg,deg,m,m/s,m/s,m/s,m,m,m/s,\r\n$DATA\r\n";
const std::string second_row =
    "$GNSS,2023-08-20T18:09:07.400Z,37.5000125,-121.2500375,7.309,3.00,-4.00,12.50,2.000,3.500,"
    "0.30,10\r\n";

TEST(Flysight, NegativeMillisecondsAreBeforeTheSecond) {
    const struct {
        const char* written;
        const char* gps;
    } times[] = {{"18:09:20.-002Z", "18:09:37.998"},
                 {"18:09:20.-02Z", "18:09:37.998"},
                 {"18:09:00.-100Z", "18:09:17.900"},
                 {"18:09:20.000Z", "18:09:38.000"},
                 {"00:00:00.-001Z", "00:00:17.999"}};
    for (const auto& time : times) {
        SCOPED_TRACE(time.written);
        const Observations read = import_text(
            pos_receiver(), second_header + replaced(second_row, "18:09:07.400Z", time.written));
        EXPECT_EQ(to_iso(*read.facts.first_epoch), std::string("2023-08-20T") + time.gps);
        EXPECT_DOUBLE_EQ(*read.facts.time_resolution_s, 0.001);
    }
    for (const char* bad : {"18:09:20.-Z", "18:09:20.--2Z", "18:09:20.-2", "18:09:20.-0002Z"})
        EXPECT_NE(complaint_of(pos_receiver(), second_header + second_row + second_row +
                                                   replaced(second_row, "18:09:07.400Z", bad)),
                  "read")
            << bad;
}

TEST(Flysight, AnAccuracyOfSpeedMayBeLabelledMetres) {
    const Observations read =
        import_text(pos_receiver(),
                    replaced(first_header, "(m),(m),(m/s),(deg)", "(m),(m),(m),(deg)") + first_row);
    EXPECT_DOUBLE_EQ(*read.rows.at(0).sigma_recorded_velocity_north_m_s, 0.3 / std::sqrt(3.0));
    EXPECT_TRUE(has(failure_of(pos_receiver(), replaced(first_header, "(m),(m),(m/s),(deg)",
                                                        "(m),(m),(ft/s),(deg)") +
                                                   first_row),
                    "\"sAcc\" is in \"ft/s\""));
    EXPECT_TRUE(
        has(failure_of(pos_receiver(),
                       replaced(first_header, "(m/s),(m/s),(m/s)", "(m),(m/s),(m/s)") + first_row),
            "\"velN\" is in \"m\""));
}

TEST(Flysight, InstrumentOfSeveralFilesIsWhatTheySayAlike) {
    const auto of = [](const std::string& later_header) {
        const std::string first = second_header + second_row;
        const std::string later = later_header + replaced(second_row, "18:09:07", "18:09:08");
        return import_recordings(
                   pos_receiver(),
                   {{.name = "1.csv", .bytes = first}, {.name = "2.csv", .bytes = later}},
                   import_recording)
            .instrument;
    };
    const Instrument whole{.model = "FlySight 2", .serial = "004e003a", .firmware = "v2024.08.07"};
    EXPECT_EQ(of(second_header), whole);
    EXPECT_EQ(of(replaced(second_header, "$VAR,DEVICE_ID,004e003a\r\n", "")), whole);
    EXPECT_EQ(of(replaced(second_header, "v2024.08.07", "v2025.01.01")),
              (Instrument{.model = "FlySight 2", .serial = "004e003a"}));
}

TEST(Flysight, BothVersionsSayTheSame) {
    for (const bool first : {true, false}) {
        const Observations read = import_text(
            pos_receiver(), first ? first_header + first_row : second_header + second_row);
        EXPECT_EQ(read.format, "flysight");
        EXPECT_EQ(read.variant, first ? "FlySight 1" : "FlySight 2");
        EXPECT_EQ(read.device, first ? "" : "FlySight 2, firmware v2024.08.07, device 004e003a");
        EXPECT_EQ(read.instrument, first ? std::nullopt
                                         : std::optional(Instrument{.model = "FlySight 2",
                                                                    .serial = "004e003a",
                                                                    .firmware = "v2024.08.07"}));
        EXPECT_EQ(read.frame, "geodetic");
        EXPECT_EQ(read.time_scale, "utc");
        EXPECT_EQ(read.accuracy_source, "recording");
        EXPECT_EQ(read.records.total, 1);
        EXPECT_TRUE(has_note(read, "above mean sea level"));
        EXPECT_EQ(to_iso(*read.facts.first_epoch), "2023-08-20T18:09:25.400");
        EXPECT_DOUBLE_EQ(*read.facts.time_resolution_s, first ? 0.01 : 0.001);
        EXPECT_NEAR(*read.facts.position_resolution_m, 0.0111, 1e-4);
        ASSERT_EQ(read.rows.size(), 1u);
        const Observation& row = read.rows[0];
        EXPECT_DOUBLE_EQ(*row.latitude_deg, 37.5000125);
        EXPECT_DOUBLE_EQ(*row.longitude_deg, -121.2500375);
        EXPECT_DOUBLE_EQ(*row.height_m, 7.309);
        EXPECT_DOUBLE_EQ(*row.recorded_velocity_east_m_s, -4.0);
        EXPECT_DOUBLE_EQ(*row.recorded_velocity_north_m_s, 3.0);
        EXPECT_DOUBLE_EQ(*row.recorded_velocity_up_m_s, -12.5);
        EXPECT_DOUBLE_EQ(*row.sigma_east_m, 2.0 / std::sqrt(2.0));
        EXPECT_DOUBLE_EQ(*row.sigma_up_m, 3.5);
        EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_north_m_s, 0.3 / std::sqrt(3.0));
        EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_up_m_s, 0.3 / std::sqrt(3.0));
        EXPECT_EQ(row.fix, first ? FixType::single : FixType::unknown);
        EXPECT_EQ(row.satellites, 10);
        EXPECT_EQ(row.source_line, first ? 3 : 7);
    }
}

TEST(Flysight, AnEarlierHeaderAndColumnsOfALaterOne) {
    std::string text =
        "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,gpsFix,numSV,later\n" + first_row;
    text = replaced(replaced(text, ",0.00000,180.00000", ""), ",10\r", ",10,x\r");
    EXPECT_EQ(import_text(pos_receiver(), text).rows.at(0).satellites, 10);
}

TEST(Flysight, WithoutAFixThereIsNoPosition) {
    const std::string zeros = "0.0000000,0.0000000,0.000,0.00,0.00,0.00,4294967.295,";
    for (const std::string& text :
         {first_header + replaced(first_row, ",3,10", ",0,0"),
          first_header + replaced(first_row, ",3,10", ",5,4"),
          first_header + replaced(replaced(first_row, ",3,10", ",0,0"),
                                  "37.5000125,-121.2500375,7.309,3.00,-4.00,12.50,2.000,", zeros),
          second_header + replaced(second_row, ",10\r", ",0\r")}) {
        const Observations read = import_text(pos_receiver(), text);
        EXPECT_EQ(read.rows[0].fix, FixType::none);
        EXPECT_FALSE(read.rows[0].latitude_deg || read.rows[0].sigma_east_m ||
                     read.rows[0].recorded_velocity_up_m_s);
    }
    EXPECT_EQ(import_text(pos_receiver(), first_header + replaced(first_row, ",3,10", ",1,10"))
                  .rows[0]
                  .fix,
              FixType::dead_reckoning);
}

TEST(Flysight, ZeroAndSaturatedAccuraciesAreUnknown) {
    for (const char* unknown : {"0.000", "4294967.295"}) {
        const std::string accuracies = std::string(unknown) + "," + unknown + "," + unknown;
        const Observations read = import_text(
            pos_receiver(), first_header + replaced(first_row, "2.000,3.500,0.30", accuracies));
        EXPECT_EQ(read.accuracy_source, "none");
        EXPECT_FALSE(read.rows[0].sigma_up_m || read.rows[0].sigma_recorded_velocity_up_m_s);
        EXPECT_TRUE(read.rows[0].recorded_velocity_up_m_s);
    }
}

TEST(Flysight, BadLinesAreCountedAndListed) {
    const struct {
        std::string from, to, what;
    } cases[] = {
        {"37.5000125", "37,5000125", "15 fields"},
        {"37.5000125", "0x10", "latitude \"0x10\" is not a number"},
        {"37.5000125", "97.8", "latitude of 97.8 degrees"},
        {"7.309", "nan", "no number"},
        {"12.50", "", "velD is missing"},
        {"0.30,", "0.30 m/s,", "sAcc \"0.30 m/s\" is not a number"},
        {"2.000,", "-2.000,", "hAcc -2.000 cannot be one"},
        {"18:09:07.40Z", "18:09:61.40Z", "does not exist"},
        {"T18:09:07.40Z", "", "not a date and time"},
        {",3,10", ",6,10", "gpsFix \"6\""},
        {",3,10", ",3,1.5", "count of satellites"},
    };
    for (const auto& bad : cases) {
        const Observations read = import_text(
            pos_receiver(), first_header + first_row + replaced(first_row, bad.from, bad.to));
        ASSERT_EQ(read.records.bad, 1) << bad.what;
        EXPECT_EQ(read.records.total, 2);
        EXPECT_EQ(read.rows.size(), 1u);
        EXPECT_EQ(read.records.bad_records[0].line, 4);
        EXPECT_TRUE(has(read.records.bad_records[0].what, bad.what))
            << read.records.bad_records[0].what;
    }
}

TEST(Flysight, OtherRowsOfASecondFlysight) {
    const std::string text =
        replaced(second_header, "$DATA", "$COL,BARO,time,pressure\r\n$UNIT,BARO,s,Pa\r\n$DATA") +
        "$BARO,1.0,99000\r\n" + second_row + second_row + "$BAR\x01,1.0,99000\r\n" +
        second_row.substr(1);
    const Observations read = import_text(pos_receiver(), text);
    EXPECT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.records.total, 4);
    ASSERT_EQ(read.records.bad, 2);
    EXPECT_TRUE(has(read.records.bad_records[0].what, "\"$BAR\\x01\", which no $COL line names"));
    EXPECT_EQ(read.records.bad_records[1].line, 13);
}

TEST(Flysight, CutOffAnywhere) {
    for (const std::string& whole : {first_header + first_row, second_header + second_row})
        for (std::size_t size = 0; size < whole.size(); ++size) {
            const std::string message = failure_of(pos_receiver(), whole.substr(0, size));
            // Cut within the last digits or the line end, the row is still whole in itself.
            if (size + 4 < whole.size()) {
                EXPECT_NE(message, "read") << size;
            }
        }
    const Observations read = import_text(
        pos_receiver(), first_header + first_row + first_row.substr(0, first_row.size() - 5));
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_TRUE(
        has(read.records.bad_records[0].what, "the last line is cut off: it has 13 fields"));
    EXPECT_TRUE(has_note(read, "no line end"));
}

TEST(FlysightRefused, SaysWhere) {
    const struct {
        std::string text, where, what;
    } cases[] = {
        {first_header, "f:1:1", "no epochs"},
        {replaced(first_header, "time,", "timeXXX,") + first_row, "f:1:1", "no column \"time\""},
        {replaced(first_header, "vAcc", "velN") + first_row, "f:1:39", "\"velN\" stands twice"},
        {replaced(first_header, "(m)", "(ft)") + first_row, "f:2:14", "hMSL\" is in \"ft\""},
        {replaced(second_header, ",deg,deg,m,", ",deg,deg,ft,") + second_row, "f:5:21", "\"ft\""},
        {replaced(second_header, "$COL,GNSS", "$COL,BARO") + second_row, "f:1:1",
         "sensor readings and no positions"},
        {replaced(second_header, "$COL,GNSS", "$CXX,GNSS") + second_row, "f:1:1",
         "no line names the columns"},
        {"1.5,\"----------\"\r\n1.6,\"640/2048 slots used in GNSS buffer\"\r\n", "f:1:1",
         "log of its own workings"},
    };
    for (const auto& bad : cases) {
        Receiver receiver = pos_receiver();
        const std::string message = failure_of(receiver, bad.text);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_TRUE(has(message, bad.what)) << message;
        receiver.format = "flysight";
        EXPECT_EQ(failure_of(receiver, bad.text), message);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
