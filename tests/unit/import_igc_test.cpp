#include <algorithm>
#include <cmath>
#include <regex>

#include "gpsbabel_support.h"
#include "import_test_support.h"
#include "stages/import/format.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver igc_receiver() {
    Receiver receiver = pos_receiver();
    receiver.format = "igc";
    return receiver;
}

const std::string header =
    "AXLX123 FLIGHT:1\r\nHFFXA035\r\nHFDTEDATE:160701,01\r\nHFFTYFRTYPE:LXNAV,S80\r\n"
    "HFRFWFIRMWAREVERSION:6.4\r\nHFALGALTGPS:ELL\r\nHFDTM100GPSDATUM:WGS-1984\r\n";
const std::string extensions = "I023638FXA3940SIU\r\n";

/// The example of the specification, its place 54 deg 7.121 min N, 2 deg 49.342 min W.
const std::string fix = "B1602405407121N00249342WA0028000421";

Observations import_lines(const std::string& lines) {
    return import_text(igc_receiver(), header + lines);
}

TEST(Igc, IsRecognisedByItsRecords) {
    EXPECT_TRUE(find_format("igc")->recognises(header));
    EXPECT_TRUE(find_format("igc")->recognises("LXSB\n" + fix + "\n"));
    EXPECT_FALSE(find_format("igc")->recognises("AXLX123\nB160240\n"));
    EXPECT_FALSE(find_format("igc")->recognises(""));
}

TEST(Igc, InstrumentIsWhatItsHeaderSays) {
    const auto of = [](const std::string& identity) {
        return import_text(igc_receiver(), identity + "HFDTE160701\r\n" + fix + "\n").instrument;
    };
    // Serial numbers as LXNAV, Filser, XCSoar, SeeYou and Flymaster write them.
    EXPECT_EQ(of("ALXVJF5FLIGHT:1\r\nHFFTYFRTYPE:LXNAV,LX9000\r\nHFRFWFIRMWAREREVISION:4.2\r\n"),
              (Instrument{.make = "LXNAV", .model = "LX9000", .serial = "JF5", .firmware = "4.2"}));
    EXPECT_EQ(of("AFIL01460FLIGHT:1\r\n"), (Instrument{.make = "FIL", .serial = "01460"}));
    EXPECT_EQ(of("AXCSAAA\r\nHFFTYFRTYPE:XCSOAR,XCSOAR ANDROID 7.2\r\n"),
              (Instrument{.make = "XCSOAR", .model = "XCSOAR ANDROID 7.2", .serial = "AAA"}));
    EXPECT_EQ(of("AXCC64BCE1\r\nHFFTYFRTYPE:SeeYou Recorder\r\n"),
              (Instrument{.make = "XCC", .model = "SeeYou Recorder", .serial = "64BCE1"}));
    EXPECT_EQ(of("AXFM\r\n"), (Instrument{.make = "XFM"}));
    EXPECT_EQ(of("AXFM:7\r\n"), (Instrument{.make = "XFM"}));
    EXPECT_FALSE(of(""));
}

TEST(Igc, SaysWhereLeapSecondsAreNotKnown) {
    const std::string later = std::regex_replace(header, std::regex("160701"), "160744");
    const auto notes = import_text(igc_receiver(), later + fix + "\n").notes;
    EXPECT_EQ(std::ranges::count_if(notes,
                                    [](const std::string& note) {
                                        return note.find("leap seconds are not known") !=
                                               std::string::npos;
                                    }),
              1);
}

TEST(Igc, ReadsEveryField) {
    const Observations read = import_lines(extensions + "LXLX comment\r\nE160240PEV\r\n" + fix +
                                           "00509\r\nB1602415407121S00249342EA-002"
                                           "8-001200000\r\nGREJNGJERJKNJKRE\r\nG31895478537\r\n");
    EXPECT_EQ(read.format, "igc");
    EXPECT_EQ(read.device, "LXNAV,S80, XLX123 FLIGHT:1, firmware 6.4");
    EXPECT_EQ(read.instrument,
              (Instrument{.make = "LXNAV", .model = "S80", .serial = "123", .firmware = "6.4"}));
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(*read.facts.first_epoch, gps_from_utc({2001, 7, 16, 16, 2, 40, 0}));
    EXPECT_EQ(*read.facts.time_resolution_s, 1.0);
    EXPECT_NEAR(*read.facts.position_resolution_m, 1.85, 0.01);  // 0.001 minutes
    ASSERT_EQ(read.rows.size(), 2u);
    const Observation& row = read.rows[0];
    EXPECT_EQ(row.source_line, 11);
    EXPECT_EQ(row.fix, FixType::single);
    EXPECT_EQ(row.satellites, 9);
    EXPECT_NEAR(*row.latitude_deg, 54.0 + 7.121 / 60.0, 1e-12);
    EXPECT_NEAR(*row.longitude_deg, -(2.0 + 49.342 / 60.0), 1e-12);
    EXPECT_EQ(*row.height_m, 421.0);  // of the GNSS, not the 280 m of the pressure
    // 95.45 % of a circular normal error are within 2.486 of its standard deviations.
    EXPECT_NEAR(*row.sigma_east_m, 5.0 / 2.48598, 1e-5);
    EXPECT_NEAR(*row.sigma_north_m, 5.0 / 2.48598, 1e-5);
    EXPECT_FALSE(row.sigma_up_m);
    EXPECT_NEAR(*read.rows[1].latitude_deg, -(54.0 + 7.121 / 60.0), 1e-12);
    EXPECT_EQ(*read.rows[1].height_m, -12.0);
    EXPECT_FALSE(read.rows[1].sigma_east_m);  // 000
    const std::string notes = noted(read);
    EXPECT_NE(notes.find("The G record (the recorder's own signature, 2 lines) was not checked."),
              std::string::npos);
    EXPECT_EQ(notes.find("HFFXA"), std::string::npos);
}

TEST(Igc, FurtherExtensions) {
    const Observations read =
        import_lines("I083636LAD3738LOD3941TDS4245GSP4648TRT4951VXA5254FXA5557ENL\r\n" + fix +
                     "5"
                     "25"
                     "250"
                     "1235"
                     "090"
                     "008"
                     "999"
                     "123\r\n" +
                     fix +
                     "6"
                     "25"
                     "500"
                     "0000"
                     "---"
                     "999"
                     "   "
                     "123\r\n");
    const Observation& row = read.rows[0];
    EXPECT_NEAR(*row.latitude_deg, 54.0 + 7.1215 / 60.0, 1e-12);
    EXPECT_NEAR(*row.longitude_deg, -(2.0 + 49.34225 / 60.0), 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, 123.5 / 3.6, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, 0.0, 1e-12);
    EXPECT_NEAR(*row.sigma_up_m, 4.0, 1e-12);
    EXPECT_FALSE(row.sigma_east_m);  // 999: the field is full
    EXPECT_EQ(*read.facts.first_epoch, gps_from_utc({2001, 7, 16, 16, 2, 40, 250'000'000}));
    EXPECT_EQ(read.rows[1].time.nanoseconds, 250'000'000);
    EXPECT_EQ(read.rows[1].recorded_velocity_east_m_s, 0.0);  // what stands needs no track
    EXPECT_FALSE(read.rows[1].sigma_up_m);
    EXPECT_EQ(*read.facts.time_resolution_s, 0.001);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.185, 0.001);  // of the latitude, 0.0001 min
    EXPECT_EQ(read.records.bad, 0);
}

TEST(Igc, FixesInThePlaneAndNone) {
    const Observations read = import_lines(
        extensions + fix + "00509\r\n" + replaced(fix, "WA", "WV") + "00509\r\n" +
        replaced(fix, "WA", "WV") + "00502\r\nB1602410000000N00000000EV002800000000000\r\n");
    EXPECT_EQ(read.rows[1].fix, FixType::unknown);
    EXPECT_TRUE(read.rows[1].latitude_deg);
    EXPECT_FALSE(read.rows[1].height_m);
    for (const std::size_t i : {2u, 3u}) {
        EXPECT_EQ(read.rows[i].fix, FixType::none);
        EXPECT_FALSE(read.rows[i].latitude_deg);
    }
    EXPECT_NE(noted(read).find("1 records are marked V"), std::string::npos);
}

TEST(IgcTime, MidnightPassesAndOneWrongHourDoesNot) {
    const auto at = [](const std::string& time) { return replaced(fix, "160240", time) + "\r\n"; };
    const Observations night =
        import_lines(at("235958") + at("235959") + at("000000") + at("000001"));
    EXPECT_EQ(night.rows[3].time.nanoseconds, 3'000'000'000);
    const Observations disordered =
        import_lines(at("235959") + at("000001") + at("235958") + at("000002"));
    EXPECT_EQ(disordered.rows[2].time.nanoseconds, -1'000'000'000);
    EXPECT_EQ(disordered.rows[3].time.nanoseconds, 3'000'000'000);
    const Observations wrong = import_lines(at("100000") + at("231001") + at("100002"));
    EXPECT_EQ(wrong.rows[2].time.nanoseconds, 2'000'000'000);
    // 2016 ended in a leap second.
    const Observations leap =
        import_text(igc_receiver(), "HFDTE311216\n" + at("235959") + at("235960") + at("000000"));
    EXPECT_EQ(leap.rows[2].time.nanoseconds, 2'000'000'000);
    const Observations dates = import_text(
        igc_receiver(), "HFDTE010599\n" + at("235959") + "HFDTE030599\n" + at("000000"));
    EXPECT_EQ(*dates.facts.first_epoch, gps_from_utc({1999, 5, 1, 23, 59, 59, 0}));
    EXPECT_EQ(dates.rows[1].time.nanoseconds, 86'401'000'000'000);
}

TEST(IgcTime, WithoutADateTheAttemptsIsTaken) {
    const std::string lines = fix + "\r\n" + fix + "\r\n";
    EXPECT_NE(failure_of(igc_receiver(), lines).find("HFDTE"), std::string::npos);
    Receiver receiver = igc_receiver();
    receiver.start_date = "2012-07-15";
    EXPECT_EQ(*import_text(receiver, lines).facts.first_epoch,
              gps_from_utc({2012, 7, 15, 16, 2, 40, 0}));
}

TEST(Igc, SaysWhatHeightsAreAbove) {
    const std::string line = fix + "\r\n";
    EXPECT_EQ(noted(import_lines(line)).find("ellipsoid"), std::string::npos);
    EXPECT_NE(noted(import_text(igc_receiver(), replaced(header, "GPS:ELL", "GPS:GEO") + line))
                  .find("above the geoid"),
              std::string::npos);
    EXPECT_NE(noted(import_text(igc_receiver(), replaced(header, "GPS:ELL", "GPS:NKN") + line))
                  .find("does not say"),
              std::string::npos);
    const Observations none =
        import_text(igc_receiver(), replaced(header, "GPS:ELL", "GPS:NIL") + line);
    EXPECT_FALSE(none.facts.vertical_measured);
}

TEST(IgcBad, RecordsAreCountedByPlace) {
    const std::string bad[] = {"B16024054",
                               replaced(fix, "160240", "166040"),
                               replaced(fix, "5407121N", "5467121N"),
                               replaced(fix, "5407121N", "9507121N"),
                               fix.substr(0, 33) + "x1",
                               "rubbish",
                               "I01363"};
    const char* what[] = {"cut off or garbled", "not a time of day", "67121 thousandths",
                          "latitude of 95.",    "GNSS altitude",     "no IGC record",
                          "as many extensions"};
    std::string lines;
    for (const std::string& one : bad)
        lines += one + "\r\n" + fix + "\r\n" + fix + "\r\n";
    const Observations read = import_lines(lines);
    EXPECT_EQ(read.rows.size(), 14u);
    EXPECT_EQ(read.records.total, 21);
    ASSERT_EQ(read.records.bad, 7);
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(read.records.bad_records[i].line, 8 + 3 * static_cast<std::int64_t>(i));
        EXPECT_NE(read.records.bad_records[i].what.find(what[i]), std::string::npos)
            << read.records.bad_records[i].what;
    }
}

TEST(IgcBad, EveryTruncationEndsInRowsOrAMessage) {
    const std::string text = header + extensions + fix + "00509\r\n" + fix + "00509\r\n";
    const std::size_t whole = header.size() + extensions.size() + fix.size() + 5;
    for (std::size_t size = 0; size <= text.size(); ++size) {
        const std::string what = failure_of(igc_receiver(), text.substr(0, size));
        EXPECT_EQ(what == "read", size >= whole) << size << what;
    }
}

TEST(IgcRoundTrip, GpsbabelReadsTheSame) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    std::string text = header;
    for (int i = 0; i < 300; ++i) {
        const auto padded = [](int value, std::size_t size) {
            const std::string digits = std::to_string(value);
            return std::string(size - digits.size(), '0') + digits;
        };
        text += "B16" + padded(i / 60, 2) + padded(i % 60, 2) + "54" + padded(7'121 + 37 * i, 5) +
                "N002" + padded(59'342 - 41 * i, 5) + "WA00280" + padded(421 + i, 5) + "\r\n";
    }
    const Observations ours = import_text(igc_receiver(), text);
    const std::vector<ReferencePoint> theirs = gpsbabel_points("igc", text);
    ASSERT_EQ(ours.rows.size(), 300u);
    // gpsbabel gives two tracks, of the pressure's heights and of the GNSS's.
    ASSERT_EQ(theirs.size(), 600u);
    std::size_t gnss = 0;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const Observation& row = ours.rows[i % 300];
        EXPECT_NEAR(*row.latitude_deg, theirs[i].latitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.longitude_deg, theirs[i].longitude_deg, 0.51e-9);
        EXPECT_EQ(to_utc_iso(ours.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds), 0),
                  theirs[i].utc + "Z");
        if (std::abs(*row.height_m - theirs[i].altitude_m.value()) < 0.051) ++gnss;
    }
    EXPECT_EQ(gnss, 300u);
}

TEST(IgcRoundTrip, ReadsWhatGpsbabelWritesOfARecording) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    for (const char* file : {"nmea_gst/static_f9p.nmea", "nmea_gst/static_skytraq.nmea"}) {
        const auto bytes = recorded(file);
        if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
        const std::vector<ReferencePoint> reference = gpsbabel_points("nmea", *bytes);
        const Observations read =
            import_text(igc_receiver(), gpsbabel_converted("nmea", *bytes, "igc"));
        ASSERT_GT(reference.size(), 20u);
        ASSERT_EQ(read.rows.size(), reference.size()) << file;
        for (std::size_t i = 0; i < reference.size(); ++i) {
            // Half of a thousandth of a minute.
            EXPECT_NEAR(*read.rows[i].latitude_deg, reference[i].latitude_deg, 0.5001e-3 / 60.0);
            EXPECT_NEAR(*read.rows[i].longitude_deg, reference[i].longitude_deg, 0.5001e-3 / 60.0);
            EXPECT_EQ(
                to_utc_iso(read.facts.first_epoch->plus_nanoseconds(read.rows[i].time.nanoseconds),
                           0),
                reference[i].utc.substr(0, 19) + "Z");
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
