#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gpsbabel_support.h"
#include "import_test_support.h"
#include "stages/import/format.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

Receiver gpx_receiver() {
    Receiver receiver = pos_receiver();
    receiver.format = "gpx";
    return receiver;
}

const std::string begin =
    "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"Maker &amp; Son\">\n<trk><trkseg>\n";
const std::string end = "</trkseg></trk></gpx>\n";

std::string point(const std::string& time, const std::string& more = "",
                  const std::string& place = "lat=\"-45.8775671\" lon=\"170.5001113\"") {
    return "<trkpt " + place + "><ele>14.2</ele><time>" + time + "</time>" + more + "</trkpt>\n";
}

const std::string first = point("2019-04-12T00:39:56Z");
const std::string second = point("2019-04-12T00:39:57Z");

Observations import_points(const std::string& points) {
    return import_text(gpx_receiver(), begin + points + end);
}

TEST(Gpx, IsRecognisedByItsRoot) {
    EXPECT_TRUE(find_format("gpx")->recognises(begin));
    EXPECT_TRUE(find_format("gpx")->recognises("\xef\xbb\xbf<gpx>"));
    EXPECT_TRUE(
        find_format("gpx")->recognises("<!-- <kml> --><!DOCTYPE gpx [<!ENTITY a \"]>\">]><g:gpx>"));
    EXPECT_FALSE(find_format("gpx")->recognises("<kml><gpx>"));
    EXPECT_FALSE(find_format("gpx")->recognises("see <gpx>"));
    EXPECT_FALSE(find_format("gpx")->recognises("<gpx"));
    EXPECT_FALSE(find_format("gpx")->recognises(""));
}

TEST(Gpx, SaysWhereLeapSecondsAreNotKnown) {
    const auto told = [](const std::string& year) {
        const auto notes =
            import_points(point(year + "-04-12T00:39:56Z") + point(year + "-04-12T00:39:57Z"))
                .notes;
        return std::ranges::count_if(notes, [](const std::string& note) {
            return note.find("leap seconds are not known") != std::string::npos;
        });
    };
    EXPECT_EQ(told("2019"), 0);
    EXPECT_EQ(told("2044"), 1);
}

TEST(Gpx, ReadsEveryField) {
    const Observations read = import_points(
        first + point("2019-04-12T00:39:56.25Z",
                      "<fix>dgps</fix><sat>11</sat><hdop>0.6</hdop><geoidheight>1.8</geoidheight>"
                      "<extensions><x:TrackPointExtension><x:hr>90</x:hr><x:speed> 12.5 </x:speed>"
                      "<x:course>270</x:course></x:TrackPointExtension></extensions>"));
    EXPECT_EQ(read.format, "gpx");
    EXPECT_EQ(read.variant, "GPX 1.1");
    EXPECT_EQ(read.device, "Maker & Son");
    EXPECT_FALSE(read.instrument);  // a creator may be a device, an app, or a program that converts
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.accuracy_source, "none");
    EXPECT_EQ(*read.facts.first_epoch, gps_from_utc({2019, 4, 12, 0, 39, 56, 0}));
    EXPECT_EQ(*read.facts.time_resolution_s, 0.01);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.0111, 1e-4);
    ASSERT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.rows[0].fix, FixType::unknown);
    EXPECT_FALSE(read.rows[0].recorded_velocity_east_m_s || read.rows[0].satellites);
    EXPECT_NEAR(*read.rows[0].height_m, 14.2, 1e-12);
    const Observation& row = read.rows[1];
    EXPECT_EQ(row.time.nanoseconds, 250'000'000);
    EXPECT_EQ(row.source_line, 5);
    EXPECT_EQ(row.source_byte, static_cast<std::int64_t>(begin.size() + first.size()));
    EXPECT_EQ(row.fix, FixType::dgps);
    EXPECT_EQ(row.satellites, 11);
    EXPECT_EQ(*row.latitude_deg, -45.8775671);
    EXPECT_EQ(*row.longitude_deg, 170.5001113);
    EXPECT_NEAR(*row.height_m, 16.0, 1e-12);  // above the ellipsoid: the geoid is 1.8 m above it
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, -12.5, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, 0.0, 1e-12);
    EXPECT_FALSE(row.sigma_east_m || row.sigma_recorded_velocity_east_m_s);
}

struct Zone {
    const char* text;
    CalendarTime utc;
};

TEST(GpxTime, ZonesAndDecimalsAreExact) {
    const Zone zones[] = {
        {"2019-04-12T02:39:56.123456789+02:00", {2019, 4, 12, 0, 39, 56, 123'456'789}},
        {"2019-04-11T18:09:56-06:30", {2019, 4, 12, 0, 39, 56, 0}},
        {"2019-04-11T18:09:56-0630", {2019, 4, 12, 0, 39, 56, 0}},
        {"2019-04-12T00:39:56+0000", {2019, 4, 12, 0, 39, 56, 0}},
        {"2019-04-12T00:39:56+00:00", {2019, 4, 12, 0, 39, 56, 0}},
        // The zone's date is one after a leap second that the instant is before.
        {"2017-01-01T00:59:59.5+01:00", {2016, 12, 31, 23, 59, 59, 500'000'000}},
        {"2016-12-31T23:59:60.5Z", {2016, 12, 31, 23, 59, 60, 500'000'000}},
        {"2019-04-12T00:39:56", {2019, 4, 12, 0, 39, 56, 0}}};
    for (const Zone& zone : zones)
        EXPECT_EQ(*import_points(point(zone.text)).facts.first_epoch, gps_from_utc(zone.utc))
            << zone.text;
    EXPECT_NE(noted(import_points(point("2019-04-12T00:39:56"))).find("1 times do not say"),
              std::string::npos);
    EXPECT_EQ(noted(import_points(first)).find("do not say in which"), std::string::npos);
}

TEST(GpxTime, AWrongZoneIsRefusedAtItsPlace) {
    for (const std::string zone : {"+2500", "+1x", "-05:3", "+0a:00", "-05:60", "+02:00Z", "+"}) {
        const std::string text = begin + point("2019-04-12T00:39:56" + zone) + end;
        const std::size_t at = text.find(zone + "<");
        const std::string message = failure_of(gpx_receiver(), text);
        EXPECT_TRUE(message.starts_with(fmt::format("f:4:{}: \"{}\" is not an offset from UTC",
                                                    at - text.rfind('\n', at), zone)))
            << message;
    }
}

TEST(Gpx, SpeedOfVersion10AndOfUnknownCourse) {
    const Observations read =
        import_points(point("2019-04-12T00:39:56Z", "<course>90.0</course><speed>3.5</speed>") +
                      point("2019-04-12T00:39:57Z", "<speed>3.5</speed>") +
                      point("2019-04-12T00:39:58Z", "<course>-1</course><speed>-1</speed>"));
    EXPECT_NEAR(*read.rows[0].recorded_velocity_east_m_s, 3.5, 1e-12);
    EXPECT_FALSE(read.rows[1].recorded_velocity_east_m_s);
    EXPECT_EQ(read.rows[1].recorded_speed_m_s, 3.5);
    EXPECT_FALSE(read.rows[2].recorded_velocity_east_m_s || read.rows[2].recorded_speed_m_s);
    EXPECT_NE(noted(read).find("1 of 2 recorded velocities come without a course"),
              std::string::npos);
}

TEST(Gpx, WithoutFixOrHeight) {
    const Observations read =
        import_points(point("2019-04-12T00:39:56Z", "<fix>none</fix>", "lat=\"0\" lon=\"0\"") +
                      "<trkpt lat='1' lon='2'><time>2019-04-12T00:39:57Z</time></trkpt>" + second);
    ASSERT_EQ(read.rows.size(), 3u);
    EXPECT_EQ(read.rows[0].fix, FixType::none);
    EXPECT_FALSE(read.rows[0].latitude_deg);
    EXPECT_TRUE(read.rows[1].latitude_deg);
    EXPECT_FALSE(read.rows[1].height_m);
    const Observations flat =
        import_points("<trkpt lat='1' lon='2'><time>2019-04-12T00:39:57Z</time></trkpt>");
    EXPECT_FALSE(flat.facts.vertical_measured);
    EXPECT_NE(noted(flat).find("Heights are not recorded"), std::string::npos);
}

// What a comment, CDATA, an instruction or an entity holds is no track point.
TEST(Gpx, OnlyElementsArePoints) {
    const std::string hidden =
        "<!-- " + second + " --><![CDATA[" + second + "]]><?note " + second + "?>";
    EXPECT_EQ(import_points(hidden + first + hidden).rows.size(), 1u);
    const std::string bomb =
        "<!DOCTYPE gpx [<!ENTITY a \"" + replaced(second, "\n", "") +
        "\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\"><!-- it's ]> --><!ENTITY c \"&b;&b;&b;\">]>";
    const Observations read =
        import_text(gpx_receiver(), bomb + "<gpx>" + first + "&c;&c;" + "</gpx>");
    EXPECT_EQ(read.rows.size(), 1u);
    EXPECT_EQ(read.records.bad, 0);
}

TEST(GpxBad, PointsAreCountedWithLineAndColumn) {
    const std::string bad[] = {point("2019-04-12T00:39:56Z", "", "lat=\"91\" lon=\"1\""),
                               point("2019-04-12T00:39:56Z", "", "lat=\"1,5\" lon=\"1\""),
                               point("2019-04-12T00:39:56Z", "", "lon=\"1\""),
                               point("2019-13-12T00:39:56Z"),
                               "<trkpt lat=\"1\" lon=\"2\"><ele>3</ele></trkpt>\n",
                               point("2019-04-12T00:39:56Z", "<a><b></a>"),
                               "<trkpt lat=\"1\" lon=\"2>\n",
                               "<trkpt lat=\"1\" lon=\"2\"><ele>3</ele>\n",
                               point("2019-04-12T00:39:56Z", "<sat>many</sat>")};
    const char* what[] = {"latitude of 91", "decimal comma", "no lat",
                          "month 13",       "no time",       "not well-formed",
                          "tag is broken",  "no end tag",    "\"many\" is not a number"};
    std::string points;
    for (const std::string& one : bad)
        points += one + first + second;
    const Observations read = import_points(points);
    EXPECT_EQ(read.rows.size(), 18u);
    EXPECT_EQ(read.records.total, 27);
    ASSERT_EQ(read.records.bad, 9);
    for (std::size_t i = 0; i < 9; ++i) {
        const BadRecord& record = read.records.bad_records[i];
        EXPECT_EQ(record.line, 4 + 3 * static_cast<std::int64_t>(i)) << i;
        EXPECT_EQ(record.epoch, 2 * static_cast<std::int64_t>(i)) << i;
        EXPECT_NE(record.what.find(what[i]), std::string::npos) << record.what;
    }
    const std::string alone = failure_of(gpx_receiver(), begin +
                                                             "<trkpt lat='1'\n   lon='x'>"
                                                             "<time>2019-04-12T00:39:56Z"
                                                             "</time></trkpt>" +
                                                             end);
    EXPECT_TRUE(alone.starts_with("f:5:9: the longitude \"x\" is not a number")) << alone;
}

TEST(GpxBad, WithoutTimesOrTracksItIsRefused) {
    EXPECT_NE(
        failure_of(gpx_receiver(), begin + "<trkpt lat='1' lon='2'/><trkpt lat='1' lon='2'/>" + end)
            .find("none of the 2 track points has a time, and a track without times cannot "
                  "show a speed"),
        std::string::npos);
    EXPECT_NE(failure_of(gpx_receiver(), "<gpx><rte><rtept lat='1' lon='2'/></rte></gpx>")
                  .find("but 1 points of routes or places"),
              std::string::npos);
    EXPECT_NE(failure_of(gpx_receiver(), "<gpx/>").find("no track point"), std::string::npos);
}

TEST(GpxBad, DeepNestingAndLongPointsAreOneBadRecord) {
    std::string deep;
    for (int i = 0; i < 20'000; ++i)
        deep += "<a>";
    const Observations read =
        import_points(first + point("2019-04-12T00:39:57Z", deep) + second +
                      point("2019-04-12T00:39:58Z", std::string(300'000, ' ')) +
                      point("2019-04-12T00:39:59Z", "<extensions>" + deep + "</extensions>") +
                      point("2019-04-12T00:39:59Z"));
    EXPECT_EQ(read.rows.size(), 3u);
    EXPECT_EQ(read.records.bad, 3);
}

TEST(GpxBad, EveryTruncationEndsInRowsOrAMessage) {
    const std::string text = begin + first + second + end;
    for (std::size_t size = 0; size <= text.size(); ++size) {
        const std::string what = failure_of(gpx_receiver(), text.substr(0, size));
        EXPECT_EQ(what == "read", size >= begin.size() + first.size() - 1) << size << what;
    }
    const Observations cut = import_text(gpx_receiver(), begin + first + second.substr(0, 50));
    EXPECT_EQ(cut.records.bad, 1);
    EXPECT_NE(noted(cut).find("ends before its </gpx>"), std::string::npos);
}

/// A track of 400 points with uneven decimals, as another program reads it.
TEST(GpxRoundTrip, GpsbabelReadsTheSame) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    std::string points;
    for (int i = 0; i < 400; ++i) {
        const GpsTime time =
            gps_from_utc({2019, 4, 12, 23, 59, 0, 0}).plus_nanoseconds(i * 200'000'000LL);
        points += point(to_utc_iso(time, i % 5 == 0 ? 0 : 1),
                        "<course>" + format_fixed(i * 0.9, 2) + "</course><speed>" +
                            format_fixed(i * 0.173, 3) + "</speed>",
                        "lat=\"" + format_fixed(54.3 + i * 1.234567e-5, 9) + "\" lon=\"" +
                            format_fixed(-1.3 - i * 2.345678e-5, 9) + "\"");
    }
    const std::string text = replaced(begin, "1.1", "1.0") + points + end;
    const Observations ours = import_text(gpx_receiver(), text);
    const std::vector<ReferencePoint> theirs = gpsbabel_points("gpx", text);
    ASSERT_EQ(ours.rows.size(), 400u);
    ASSERT_EQ(ours.rows.size(), theirs.size());
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        const Observation& row = ours.rows[i];
        EXPECT_NEAR(*row.latitude_deg, theirs[i].latitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.longitude_deg, theirs[i].longitude_deg, 0.51e-9);
        EXPECT_NEAR(*row.height_m, theirs[i].altitude_m.value(), 0.051);
        EXPECT_NEAR(std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s),
                    theirs[i].speed_m_s.value(), 0.0051);
        EXPECT_EQ(to_utc_iso(ours.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds),
                             i % 5 == 0 ? 0 : 3),
                  theirs[i].utc + "Z");
    }
}

/// Real recordings, through gpsbabel's own GPX writer in both versions.
TEST(GpxRoundTrip, ReadsWhatGpsbabelWritesOfARecording) {
    if (!has_gpsbabel()) GTEST_SKIP() << "gpsbabel is not installed";
    for (const char* file : {"nmea_gst/static_f9p.nmea", "nmea_gst/static_skytraq.nmea"}) {
        const auto bytes = recorded(file);
        if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
        const std::vector<ReferencePoint> reference = gpsbabel_points("nmea", *bytes);
        for (const char* version : {"gpx,gpxver=1.0", "gpx,gpxver=1.1"}) {
            const Observations read =
                import_text(gpx_receiver(), gpsbabel_converted("nmea", *bytes, version));
            ASSERT_GT(reference.size(), 20u);
            ASSERT_EQ(read.rows.size(), reference.size()) << file;
            for (std::size_t i = 0; i < reference.size(); ++i) {
                EXPECT_NEAR(*read.rows[i].latitude_deg, reference[i].latitude_deg, 0.51e-9);
                EXPECT_NEAR(*read.rows[i].longitude_deg, reference[i].longitude_deg, 0.51e-9);
                const GpsTime time =
                    read.facts.first_epoch->plus_nanoseconds(read.rows[i].time.nanoseconds);
                EXPECT_EQ(to_utc_iso(time, reference[i].utc.size() > 19 ? 3 : 0),
                          reference[i].utc + "Z");
            }
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
