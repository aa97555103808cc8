#include <fmt/format.h>

#include <string>

#include "core/random.h"
#include "core/text.h"
#include "import_inspect_support.h"
#include "import_test_support.h"

// What inspect says of a table that no format recognises: lines to paste into an attempt.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

std::string inspected(const std::string& text) {
    try {
        return text_of(recognition_of_table({.name = "log.csv", .bytes = text}));
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.remedy().empty());
        return "no table";
    }
}

/// A run to the north at 10 m/s and 10 Hz; `row(i, latitude)` is one line.
template <class Row>
std::string run_of(const std::string& header, Row row) {
    std::string text = header;
    for (int i = 0; i < 100; ++i)
        text += row(i, 52.1 + 1e-5 * i * 0.8988);
    return text;
}

/// The proposed lines: those that are indented by four.
std::string proposed(const std::string& said) {
    std::string lines;
    for (std::size_t at = 0; at < said.size();) {
        const std::size_t end = std::min(said.find('\n', at), said.size());
        if (said.compare(at, 4, "    ") == 0 && said[at + 4] != ' ')
            lines += said.substr(at + 4, end + 1 - at - 4);
        if (said.compare(at, 3, "Key") == 0) break;
        at = end + 1;
    }
    return lines;
}

TEST(InspectTable, ProposesColumnsTimesAndUnits) {
    const std::string said =
        inspected(run_of("timestamp_ms,lat,lon,speed\n", [](int i, double lat) {
            return fmt::format("{},{:.8f},5.1,36.0\n", 1773482400000 + 100LL * i, lat);
        }));
    EXPECT_EQ(proposed(said),
              "format: csv\ncolumns: {time: timestamp_ms, latitude: lat, longitude: lon, speed: "
              "speed}\nframe: geodetic\ntime_format: unix\nspeed_unit: km/h\nheight_m: "
              "...\naccuracy: {horizontal_m: ...}\n")
        << said;
    EXPECT_TRUE(has(said, "The unit of speeds is not named: km/h fits the positions."));
    EXPECT_TRUE(has(said, "No column holds heights"));
    EXPECT_TRUE(has(said, "- 2026-03-14T10:00:00.000Z, latitude 52.1000000, longitude 5.1000000"))
        << said;
    EXPECT_TRUE(has(said, "Format      csv; latitude, longitude, height, UTC\n"));
    EXPECT_TRUE(has(said, "2026-03-14T10:00:00.000Z"));
}

TEST(InspectTable, ManyTablesOfOneRun) {
    const struct {
        std::string header;
        const char* row;  ///< of latitude and second
        std::string columns, rest;
    } tables[] = {
        {"Date,Time,RxBt(V),GPS,GSpd(kmh),Hdg(deg),Alt(m)\n",
         "2026-03-14,10:00:{1:06.3f},5.2,{0:.7f} 5.1,36.0,0.0,3.0\n",
         "date: Date, time: Time, latitude: GPS, longitude: GPS, height: \"Alt(m)\", "
         "speed: \"GSpd(kmh)\", course: \"Hdg(deg)\"",
         "time_format: time_of_day\ntime_scale: ...\naccuracy: {horizontal_m: ..., vertical_m: "
         "...}\n"},
        {"timestamp,lat,lon,mph\n", "3/14/2026 1:00:{1:06.3f} PM,{0:.8f},5.1,22.369\n",
         "time: timestamp, latitude: lat, longitude: lon, speed: mph",
         "time_format: iso\ntime_scale: ...\nheight_m: ...\naccuracy: {horizontal_m: ...}\n"},
        {"time;latitude;longitude;altitude\ns;deg;deg;m\n", "{1:.1f};{0:.8f};5.1;3.0\n",
         "time: time, latitude: latitude, longitude: longitude, height: altitude",
         "time_format: seconds\naccuracy: {horizontal_m: ..., vertical_m: ...}\n"},
        {"# from a logger\nUTC Time,Latitude (deg),Longitude (deg),Altitude [ft],Speed "
         "(knots),Sats\n",
         "2026-03-14T10:00:{1:06.3f}Z,{0:.8f},5.1,10.0,19.438,12\n",
         "time: \"UTC Time\", latitude: \"Latitude (deg)\", longitude: \"Longitude (deg)\", "
         "height: \"Altitude [ft]\", speed: \"Speed (knots)\", satellites: Sats",
         "time_format: iso\naccuracy: {horizontal_m: ..., vertical_m: ...}\n"},
        {"date\tlat_wgs84\tlon_wgs84\televation\tsog_kn\n",
         "2026-03-14 10:00:{1:06.3f}\t{0:.8f}\t5.1\t3\t19.438\n",
         "time: date, latitude: lat_wgs84, longitude: lon_wgs84, height: elevation, speed: sog_kn",
         "time_format: iso\nspeed_unit: kn\ntime_scale: ...\naccuracy: {horizontal_m: ..., "
         "vertical_m: ...}\n"}};
    for (const auto& table : tables) {
        SCOPED_TRACE(table.header);
        const std::string said = inspected(run_of(table.header, [&](int i, double lat) {
            return fmt::format(fmt::runtime(table.row), lat, 0.1 * i);
        }));
        EXPECT_EQ(proposed(said), fmt::format("format: csv\ncolumns: {{{}}}\nframe: geodetic\n{}",
                                              table.columns, table.rest))
            << said;
        EXPECT_TRUE(has(said, "\nBy position  ") && has(said, "  36.0 km/h over 3.000 s")) << said;
        EXPECT_EQ(has(said, "By recorded velocity  36.0 km/h"), has(table.columns, "speed"))
            << said;
    }
}

// What is pasted into an attempt is not broken into lines, whatever the terminal's width; the rest
// is.
TEST(InspectTable, ProposedLinesStayWholeOnANarrowTerminal) {
    const std::string text = run_of("timestamp_ms,lat,lon,speed\n", [](int i, double lat) {
        return fmt::format("{},{:.8f},5.1,36.0\n", 1773482400000 + 100LL * i, lat);
    });
    const Recognition is = recognition_of_table({.name = "log.csv", .bytes = text});
    const Document document = description_of(is, "log.csv");
    ASSERT_EQ(document.sections[0].blocks.at(1).kind, BlockKind::code);
    EXPECT_EQ(document.sections[0].blocks[1].items.size(), 7U);
    const std::string said = text_of(is, 50);
    EXPECT_TRUE(has(said,
                    "\n    columns: {time: timestamp_ms, latitude: lat, longitude: lon, speed: "
                    "speed}\n    frame: geodetic\n"))
        << said;
    for (const std::string& line : lines_of(said))
        EXPECT_TRUE(line.size() <= 50 || line.starts_with("    columns: ")) << line;
}

TEST(InspectTable, SaysWhatItDoesNotKnow) {
    const std::string said = inspected("a,b,c,d\n1,2,3,4\n2,3,4,5\n");
    EXPECT_TRUE(has(said, "columns: {time: ..., latitude: ..., longitude: ...}")) << said;
    for (const char* key : {"time", "latitude", "longitude"})
        EXPECT_TRUE(has(said, fmt::format("No column's name says which holds the {}", key)));
    EXPECT_TRUE(has(said, "- a 1, b 2, c 3, d 4"));
    EXPECT_FALSE(has(said, "so described"));
    const std::string bare = inspected("0.0,52.1,5.1,3\n0.1,52.1,5.1,3\n");
    EXPECT_TRUE(has(bare, "no header line: give columns by number")) << bare;
    EXPECT_TRUE(has(bare, "- 1: 0.0, 2: 52.1"));
    const std::string wrong = inspected("time,lat,lon\n0,99999,5.1\n1,99999,5.2\n");
    EXPECT_TRUE(has(wrong, "So described, it cannot be read. log.csv:2")) << wrong;
    EXPECT_EQ(inspected("hello to all of you\nwho read this\n"), "no table");
    EXPECT_EQ(inspected(""), "no table");
}

TEST(InspectTable, OddNamesAreQuotedOrCounted) {
    const std::string said =
        inspected("\"time: s\",lat,lat,Longitude's,h\n0,52.1,5,5.1,3\n1,52.1,5,5.1,3\n");
    EXPECT_TRUE(has(said, "latitude: 2, longitude: \"Longitude's\"")) << said;
}

TEST(InspectTable, DamagedTablesNeverCrashIt) {
    const std::string good = run_of("timestamp,lat,lon,speed\n", [](int i, double lat) {
        return fmt::format("{},{:.8f},5.1,36.0\n", 1773482400000 + 100LL * i, lat);
    });
    RandomGenerator random(7);
    for (int i = 0; i < 500; ++i) {
        std::string text = good;
        for (int changes = 0; changes < 5; ++changes) {
            const auto at =
                static_cast<std::size_t>(random.uniform() * static_cast<double>(text.size() - 1));
            text[at] = static_cast<char>(1.0 + 254.0 * random.uniform());
        }
        text.resize(static_cast<std::size_t>(random.uniform() * static_cast<double>(text.size())));
        (void)inspected(text);
    }
}

TEST(InspectWords, NoSpeedsAndSharedStampsAreSaid) {
    std::string text = "time,lat,lon,h\n";
    for (int i = 0; i < 100; ++i)
        text += fmt::format("{},52.1,5.1,3\n", i / 10);
    const std::string said = inspection_text(import_text(csv_receiver(), text));
    EXPECT_TRUE(has(said, "Up to 10 positions share one time stamp")) << said;
    EXPECT_TRUE(has(said, "The recording has no speeds, its positions come 1.00 times a second"))
        << said;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
