#include <fmt/format.h>

#include <string>
#include <vector>

#include "import_test_support.h"

// Times as loggers and spreadsheets write them into tables, coordinates with letters or both in one
// cell, and names that an attempt nearly says.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver table_receiver(const std::string& time_format) {
    Receiver receiver = csv_receiver();
    receiver.time_format = time_format;
    receiver.time_scale = "utc";
    return receiver;
}

/// A table of these times, each a row.
std::string table_of(const std::vector<std::string>& times, const std::string& header = "time") {
    std::string text = header + ",lat,lon,h\n";
    for (std::size_t i = 0; i < times.size(); ++i)
        text += fmt::format("{},52.100000{},5.1,3.0\n", times[i], i % 10);
    return text;
}

std::string first_of(const Observations& read, int decimals = 3) {
    return to_utc_iso(*read.facts.first_epoch, decimals);
}

// -------------------------------------------------------------------------------- counts since
// 1970

struct Count {
    const char* first;
    const char* second;
    const char* utc;
    std::int64_t step_ns;
    double resolution_s;
    const char* note;
};

class CsvUnix : public testing::TestWithParam<Count> {};

TEST_P(CsvUnix, UnitIsToldBySize) {
    const Count& count = GetParam();
    const Observations read =
        import_text(table_receiver("unix"), table_of({count.first, count.second}));
    EXPECT_EQ(first_of(read, 9), count.utc);
    EXPECT_EQ(read.rows.at(1).time.nanoseconds, count.step_ns);
    EXPECT_NEAR(*read.facts.time_resolution_s, count.resolution_s, 1e-3 * count.resolution_s);
    EXPECT_EQ(has_note(read, "since 1970, as their size shows"), *count.note != '\0');
    EXPECT_TRUE(*count.note == '\0' || has_note(read, count.note)) << noted(read);
}

INSTANTIATE_TEST_SUITE_P(
    All, CsvUnix,
    testing::Values(Count{"1773482400", "1773482401", "2026-03-14T10:00:00.000000000Z",
                          1'000'000'000, 1.0, ""},
                    Count{"1773482400.0", "1773482400.1", "2026-03-14T10:00:00.000000000Z",
                          100'000'000, 0.1, ""},
                    Count{"1773482400000", "1773482400100", "2026-03-14T10:00:00.000000000Z",
                          100'000'000, 1e-3, "milliseconds"},
                    Count{"1773482400000.25", "1773482400100.25", "2026-03-14T10:00:00.000250000Z",
                          100'000'000, 1e-5, "milliseconds"},
                    Count{"946684800123", "946684800223", "2000-01-01T00:00:00.123000000Z",
                          100'000'000, 1e-3, "milliseconds"},
                    Count{"1773482400000000", "1773482400100001", "2026-03-14T10:00:00.000000000Z",
                          100'001'000, 1e-6, "microseconds"},
                    Count{"1773482400000000007", "1773482400100000000",
                          "2026-03-14T10:00:00.000000007Z", 99'999'993, 1e-9, "nanoseconds"}));

TEST(CsvUnix, ARowBeforeTheFirstFixDoesNotDecide) {
    const Observations read =
        import_text(table_receiver("unix"), table_of({"0", "1773482400000", "1773482400100"}));
    EXPECT_TRUE(has_note(read, "milliseconds"));
    EXPECT_EQ(read.rows.at(2).time.nanoseconds - read.rows.at(1).time.nanoseconds, 100'000'000);
}

TEST(CsvUnix, HeadersMayNameTheUnit) {
    EXPECT_EQ(first_of(import_text(
                  [] {
                      Receiver receiver = table_receiver("unix");
                      receiver.columns["time"] = "time (ms)";
                      return receiver;
                  }(),
                  table_of({"1773482400000", "1773482400100"}, "time (ms)"))),
              "2026-03-14T10:00:00.000Z");
    Receiver receiver = csv_receiver();
    receiver.columns["time"] = "time [ms]";
    const Observations relative = import_text(receiver, table_of({"12", "112.5"}, "time [ms]"));
    EXPECT_EQ(relative.rows.at(1).time.nanoseconds, 100'500'000);
    EXPECT_NEAR(*relative.facts.time_resolution_s, 1e-4, 1e-9);
}

TEST(CsvUnix, WhoSaysSecondsIsToldOfMilliseconds) {
    const std::string message =
        failure_of(csv_receiver(), table_of({"1773482400000", "1773482400100"}));
    EXPECT_TRUE(has(message, "counts milliseconds or less since 1970")) << message;
    EXPECT_TRUE(has(message, "Write time_format: unix in the receiver")) << message;
}

// ------------------------------------------------------------------------------------ written
// dates

struct Written {
    std::vector<std::string> times;
    const char* first;
    double resolution_s = 1.0;
    const char* start_date = "";
};

class CsvDates : public testing::TestWithParam<Written> {};

TEST_P(CsvDates, OfOneCell) {
    const Written& written = GetParam();
    Receiver receiver = table_receiver("iso");
    receiver.start_date = written.start_date;
    const Observations read = import_text(receiver, table_of(written.times));
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(first_of(read), written.first) << noted(read);
    EXPECT_NEAR(*read.facts.time_resolution_s, written.resolution_s, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    All, CsvDates,
    testing::Values(
        Written{{"3/14/2026 1:00:00.000 PM"}, "2026-03-14T13:00:00.000Z", 1e-3},
        Written{{"3/14/2026 1:00 PM"}, "2026-03-14T13:00:00.000Z"},
        Written{{"3/14/2026 12:00:00.5 AM"}, "2026-03-14T00:00:00.500Z", 0.1},
        Written{{"3/14/2026 12:00:00.5 pm"}, "2026-03-14T12:00:00.500Z", 0.1},
        Written{{"3/14/2026 12:59:59PM"}, "2026-03-14T12:59:59.000Z"},
        Written{{"3/14/2026 11:59:59.25 p.m."}, "2026-03-14T23:59:59.250Z", 0.01},
        Written{{"03/14/2026 09:05:07"}, "2026-03-14T09:05:07.000Z"},
        Written{{"14/03/2026 13:00:00.1"}, "2026-03-14T13:00:00.100Z", 0.1},
        Written{{"14.03.2026 13:00:00"}, "2026-03-14T13:00:00.000Z"},
        Written{{"4.3.2026 13:00:00"}, "2026-03-04T13:00:00.000Z"},
        Written{{"14-03-2026 13:00:00"}, "2026-03-14T13:00:00.000Z"},
        Written{{"2026-03-14 1:00:00 PM"}, "2026-03-14T13:00:00.000Z"},
        Written{{"2026/3/4 13:00:00"}, "2026-03-04T13:00:00.000Z"},
        Written{{"20260314 130000.5"}, "2026-03-14T13:00:00.500Z", 0.1},
        Written{{"20260314T130000"}, "2026-03-14T13:00:00.000Z"},
        Written{{"3/14/26 13:00:00"}, "2026-03-14T13:00:00.000Z"},
        Written{{"3/14/2026 13:00:00Z"}, "2026-03-14T13:00:00.000Z"},
        // Which part is the day shows later, or the attempt says it, or it makes no difference.
        Written{{"12/3/2026 23:59:59", "13/3/2026 0:00:00"}, "2026-03-12T23:59:59.000Z"},
        Written{{"3/12/2026 23:59:59", "3/13/2026 0:00:00"}, "2026-03-12T23:59:59.000Z"},
        Written{{"3/4/2026 13:00:00"}, "2026-03-04T13:00:00.000Z", 1.0, "2026-03-04"},
        Written{{"3/4/2026 13:00:00"}, "2026-04-03T13:00:00.000Z", 1.0, "2026-04-03"},
        Written{{"3/4/2026 13:00:00"}, "2026-03-04T13:00:00.000Z", 1.0, "2026-03-05"},
        Written{{"3/3/2026 13:00:00"}, "2026-03-03T13:00:00.000Z"},
        Written{{"2026-03-14 13:00:00", "2026-03-14 13:00:01"}, "2026-03-14T13:00:00.000Z"}));

TEST(CsvDates, WithoutAnyRowThatShowsTheDayAreRefused) {
    for (const char* start : {"", "2026-08-08"}) {
        Receiver receiver = table_receiver("iso");
        receiver.start_date = start;
        const std::string message =
            failure_of(receiver, table_of({"3/4/2026 1:00:00 PM", "3/4/2026 1:00:01 PM"}));
        EXPECT_TRUE(has(message, "may be 2026-03-04 or 2026-04-03")) << message;
        EXPECT_TRUE(has(message, "Write start_date in the receiver")) << message;
    }
}

TEST(CsvDates, ThatAreNoneAreBadRecords) {
    for (const char* bad :
         {"14/14/2026 1:00:00 PM", "3/14/2026 13:00:00 PM", "3/14/2026 0:00:00 AM",
          "3/14/2026 1:60:00 PM", "3/14/2026 1:00:61 PM", "3/14/2026 noon", "3/14/2026",
          "2/29/2026 1:00:00 PM", "3/14/1926 1:00:00 PM"}) {
        SCOPED_TRACE(bad);
        const Observations read = import_text(
            table_receiver("iso"), table_of({"3/14/2026 1:00:00 PM", "3/14/2026 1:00:01 PM", bad,
                                             "3/14/2026 1:00:02 PM"}));
        EXPECT_EQ(read.rows.size(), 3U);
        EXPECT_EQ(read.records.bad, 1);
    }
}

TEST(CsvDates, InAColumnOfTheirOwn) {
    Receiver receiver = table_receiver("time_of_day");
    receiver.columns["date"] = "date";
    for (const auto& [date, time, utc] :
         {std::array<const char*, 3>{"3/14/2026", "1:00:00 PM", "2026-03-14T13:00:00.000Z"},
          {"260314", "130000", "2026-03-14T13:00:00.000Z"},
          {"20260314", "130000.25", "2026-03-14T13:00:00.250Z"},
          {"14.3.2026", "13:00:00.25", "2026-03-14T13:00:00.250Z"},
          {"2026-03-14", "1:00 pm", "2026-03-14T13:00:00.000Z"}}) {
        SCOPED_TRACE(date);
        receiver.start_date = std::string(date) == "260314" ? "2026-03-14" : "";
        const Observations read = import_text(
            receiver, fmt::format("date,time,lat,lon,h\n{},{},52.1,5.1,3\n", date, time));
        EXPECT_EQ(first_of(read), utc);
    }
    receiver.start_date.clear();
    EXPECT_TRUE(has(failure_of(receiver, "date,time,lat,lon,h\n260314,130000,52.1,5.1,3\n"),
                    "may be 2014-03-26 or 2026-03-14"));
}

TEST(CsvDates, LocalTimesAreTurned) {
    Receiver receiver = table_receiver("iso");
    receiver.time_scale = "local";
    receiver.utc_offset_h = 9.5;
    EXPECT_EQ(first_of(import_text(receiver, table_of({"3/14/2026 1:00:00 PM"}))),
              "2026-03-14T03:30:00.000Z");
}

TEST(CsvDates, OfAnotherTimeFormatAreSaid) {
    for (const char* format : {"seconds", "unix", "time_of_day"}) {
        Receiver receiver = table_receiver(format);
        if (receiver.time_format == "time_of_day") receiver.columns["date"] = "time";
        EXPECT_TRUE(
            has(failure_of(receiver, table_of({"3/14/2026 1:00:00 PM"})), "Write time_format: iso"))
            << format;
    }
}

// --------------------------------------------------------------------------------------
// coordinates

TEST(CsvCoordinates, MayHaveTheLettersOfTheirHemispheres) {
    for (const auto& [latitude, longitude, signs] :
         {std::array<const char*, 3>{"52.1N", "5.1E", "++"},
          {"52.1S", "005.1W", "--"},
          {"N52.1", "W 5.1", "+-"},
          {"52.1 s", "e5.1", "-+"},
          {"52.1\xc2\xb0N", "5.1\xc2\xb0W", "+-"},
          {"-52.1", "5.1", "-+"}}) {
        SCOPED_TRACE(latitude);
        const Observations read = import_text(
            csv_receiver(), fmt::format("time,lat,lon,h\n0,{},{},3\n", latitude, longitude));
        EXPECT_EQ(*read.rows.at(0).latitude_deg, signs[0] == '-' ? -52.1 : 52.1);
        EXPECT_EQ(*read.rows.at(0).longitude_deg, signs[1] == '-' ? -5.1 : 5.1);
        EXPECT_NEAR(*read.facts.position_resolution_m, 11'000.0, 200.0);
    }
    for (const auto& [latitude, longitude] : {std::array<const char*, 2>{"-52.1N", "5.1"},
                                              {"52.1E", "5.1"},
                                              {"52.1", "5.1N"},
                                              {"52.1NN", "5.1"},
                                              {"N", "5.1"}})
        EXPECT_NE(failure_of(csv_receiver(),
                             fmt::format("time,lat,lon,h\n0,{},{},3\n", latitude, longitude)),
                  "read")
            << latitude;
}

TEST(CsvCoordinates, MayStandInOneCell) {
    Receiver receiver = csv_receiver();
    receiver.columns["latitude"] = receiver.columns["longitude"] = "GPS";
    for (const char* cell : {"52.1 5.1", "\"52.1,5.1\"", "52.1; 5.1", "52.1/5.1", "52.1N 5.1E"}) {
        SCOPED_TRACE(cell);
        const Observations read =
            import_text(receiver, fmt::format("time,GPS,h\n0,{},3\n1,,3\n", cell));
        EXPECT_EQ(*read.rows.at(0).latitude_deg, 52.1);
        EXPECT_EQ(*read.rows.at(0).longitude_deg, 5.1);
        EXPECT_FALSE(read.rows.at(1).latitude_deg);
        EXPECT_TRUE(has_note(read, "The column \"GPS\" holds both coordinates"));
    }
    EXPECT_TRUE(has(failure_of(receiver, "time,GPS,h\n0,52.1,3\n"), "longitude is missing"));
    receiver.columns["longitude"] = "lon";
    const std::string message = failure_of(receiver, "time,GPS,lon,h\n0,52.1 5.1,5.1,3\n");
    EXPECT_TRUE(has(message,
                    "both coordinates in one cell. Name this column for latitude and for "
                    "longitude"))
        << message;
}

// --------------------------------------------------------------------------------------------
// names

TEST(CsvNames, TheNearestBeginsAsTheAttemptsDoes) {
    for (const auto& [wanted, header, meant] :
         {std::array<const char*, 3>{"Alt", "Date,Time,lat,lon,Alt(m)", "Alt(m)"},
          {"alt", "Date,Time,lat,lon,Altitude", "Altitude"},
          {"speed", "Date,lat,lon,Speed GPS,h", "Speed GPS"},
          {"hight", "time,lat,lon,height", "height"}}) {
        Receiver receiver = csv_receiver();
        receiver.columns["height"] = wanted;
        if (std::string(header).starts_with("Date")) receiver.columns["time"] = "Date";
        const std::string message = failure_of(receiver, fmt::format("{}\n1,2,3,4,5\n", header));
        EXPECT_TRUE(has(message, fmt::format("Did you mean \"{}\"?", meant))) << message;
    }
}

TEST(CsvRows, MayEndWithADelimiterThatTheHeaderLacks) {
    const Observations read =
        import_text(csv_receiver(), "time,lat,lon,h\n0,52.1,5.1,3,\n1,52.1,5.1,3\n");
    EXPECT_EQ(read.rows.size(), 2U);
    EXPECT_EQ(
        import_text(csv_receiver(), "time,lat,lon,h\n0,52.1,5.1,3\n1,52.1,5.1,3,9\n").records.bad,
        1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
