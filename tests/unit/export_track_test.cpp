#include <gtest/gtest.h>

#include <pugixml.hpp>
#include <sstream>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/text.h"
#include "reports/export/export.h"

namespace runcert::RUNCERT_FILE {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(PlainText, WhatDisplaysWronglyIsReplaced) {
    EXPECT_EQ(plain_text("Bjørn's 船 \U0001F6A9"), "Bjørn's 船 \U0001F6A9");
    EXPECT_EQ(plain_text("a\nb\tc"), "a b c");
    for (const char* bad : {"\x01", "\x1b", "\x7f", "\xc2\x85", "\xe2\x80\xa8", "\xe2\x80\xae",
                            "\xe2\x81\xa6", "\xef\xbf\xbf", "\xff", "\xc0"})
        EXPECT_EQ(plain_text(bad), "\xef\xbf\xbd") << static_cast<int>(*bad);
    // Overlong, surrogate, beyond Unicode, cut off: one mark a byte.
    EXPECT_EQ(plain_text("\xe0\x80\x80"), "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(plain_text("\xed\xa0\x80").size(), 9u);
    EXPECT_EQ(plain_text("\xf4\x90\x80\x80").size(), 12u);
    EXPECT_EQ(plain_text("a\xe2\x80").size(), 7u);
}

TEST(RuleSpeeds, AreAColumnForEachRuleThatHasALength) {
    TrajectoryTable table;
    table.facts.nominal_interval_s = 1.0;
    table.facts.first_epoch = parse_gps_iso("2026-03-14T03:20:18.000");
    for (std::int64_t k = 0; k < 4; ++k) {
        TrajectoryEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 1'000'000'000};
        row.east_m = row.north_m = 0.0;
        row.speed_m_s = 10.0 + static_cast<double>(k);
        if (k < 3) row.arc = 1;
    }
    table.rows[3].speed_m_s.reset();
    std::vector<Profile> profiles(3);
    profiles[0].id = "two";
    profiles[0].duration_s = 2.0;
    profiles[1].id = "course";
    profiles[1].window_kind = WindowKind::course;
    profiles[2].id = "one";
    profiles[2].duration_s = 1.0;
    EXPECT_EQ(rule_speeds_csv(table, profiles),
              "epoch,time_s,utc,speed_m_s,speed_two_m_s,speed_one_m_s\n"
              "1,0.000000000,2026-03-14T03:20:00.000Z,10.000000,,\n"
              "2,1.000000000,2026-03-14T03:20:01.000Z,11.000000,,10.500000\n"
              "3,2.000000000,2026-03-14T03:20:02.000Z,12.000000,11.000000,11.500000\n"
              "4,3.000000000,2026-03-14T03:20:03.000Z,,,\n");
    table.facts.first_epoch.reset();
    EXPECT_TRUE(holds(rule_speeds_csv(table, profiles), "\n1,0.000000000,,10.000000,,\n"));
}

TEST(CsvCell, AFormulaIsText) {
    for (const char* formula : {"=cmd()", "+1", "-1", "@SUM(A1)"})
        EXPECT_EQ(csv_cell(formula), std::string("'") + formula);
    EXPECT_EQ(csv_cell("\tx"), "'\tx");
    EXPECT_EQ(csv_cell("=HYPERLINK(\"x\",\"y\")"), "\"'=HYPERLINK(\"\"x\"\",\"\"y\"\")\"");
    EXPECT_EQ(csv_cell("a,b\nc"), "\"a,b\nc\"");
    EXPECT_EQ(csv_cell("fixed"), "fixed");
    EXPECT_EQ(csv_cell(""), "");
    const std::string table =
        "# %ECSV 1.0\n# ---\n# datatype:\n# - {name: n, datatype: float64}\n"
        "# - {name: t, datatype: string}\n# delimiter: ','\nn,t\n-1.5,-1.5\n,\"=a,\"\"b\"\"\"\n";
    EXPECT_EQ(csv_text(table, "t.ecsv"), "n,t\n-1.5,'-1.5\n,\"'=a,\"\"b\"\"\"\n");
}

/// A trajectory of three epochs on the Earth, without heights.
TrajectoryTable flat_trajectory() {
    TrajectoryTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.origin = FrameOrigin{.position = {.latitude = Angle::from_degrees(47.0),
                                            .longitude = Angle::from_degrees(15.0),
                                            .height_m = 350.0},
                               .source = "attempt"};
    for (int i = 0; i < 3; ++i) {
        TrajectoryEpoch row;
        row.epoch = i + 1;
        row.time = {i * 100'000'000};
        row.east_m = 5000.0 * i;
        row.north_m = -4000.0 * i;
        row.arc = 1;
        table.rows.push_back(row);
    }
    return table;
}

TEST(TrackWithoutHeights, LiesAtTheAttemptsHeightAndStatesNone) {
    const TrajectoryTable table = flat_trajectory();
    Attempt attempt;
    attempt.id = "flat";
    Receiver receiver;
    receiver.height_m = 100.0;
    const RunMap map = map_of({.attempt = &attempt, .receiver = &receiver, .trajectory = &table});
    const std::vector<MapLine>& arcs = map.folders.at(0).lines;
    ASSERT_EQ(arcs.size(), 1u);
    ASSERT_EQ(arcs[0].points.size(), 3u);
    const LocalFrame frame(table.origin->position);
    for (std::size_t i = 0; i < 3; ++i) {
        std::istringstream point(arcs[0].points[i]);
        double longitude_deg = 0.0, latitude_deg = 0.0;
        char comma = ' ';
        point >> longitude_deg >> comma >> latitude_deg;
        EXPECT_EQ(point.peek(), std::istringstream::traits_type::eof()) << "no height";
        // Import put every position at 100 m: from there, the same east and north come back.
        const Enu back = frame.enu_from_geodetic({.latitude = Angle::from_degrees(latitude_deg),
                                                  .longitude = Angle::from_degrees(longitude_deg),
                                                  .height_m = 100.0});
        EXPECT_NEAR(back.m.x(), *table.rows[i].east_m, 1e-4);
        EXPECT_NEAR(back.m.y(), *table.rows[i].north_m, 1e-4);
    }
    const std::string kml = kml_text(map);
    EXPECT_TRUE(holds(kml, "<coordinates>15.000000000,47.000000000 "));
    EXPECT_TRUE(holds(kml, "UTC: not known"));
    EXPECT_TRUE(holds(kml, "Heights were not measured"));
}

TEST(HostileText, IsTextOnTheMap) {
    const TrajectoryTable table = flat_trajectory();
    Attempt attempt;
    attempt.id = "hostile";
    attempt.craft.name =
        "=cmd()<script>alert(1)</script>&amp;]]>'\"\xe2\x80\xaegnp.\x01\n\xff\xf0\x9f\x9a\xa9" +
        std::string(10'000, 'y');
    Receiver receiver;
    receiver.height_m = 100.0;
    const std::string text =
        kml_text(map_of({.attempt = &attempt, .receiver = &receiver, .trajectory = &table}));
    EXPECT_FALSE(holds(text, "\xe2\x80\xae")) << "a mark that turns writing around";
    EXPECT_TRUE(holds(text, "\xf0\x9f\x9a\xa9"));
    EXPECT_TRUE(holds(text, std::string(10'000, 'y')));
    pugi::xml_document xml;
    ASSERT_TRUE(xml.load_string(text.c_str()));
    EXPECT_FALSE(holds(text, "<script"));
    // Descriptions are shown as HTML: there the text is escaped once more.
    const std::string said = xml.select_node("//Document/description").node().text().get();
    EXPECT_TRUE(holds(said, "&lt;script&gt;alert(1)&lt;/script&gt;&amp;amp;]]")) << said;
}

TEST(TrackAtGaps, AnotherArcAndARowOutsideEndAnArc) {
    TrajectoryTable table = flat_trajectory();
    Attempt attempt;
    Receiver receiver;
    receiver.height_m = 100.0;
    const MapInput input{.attempt = &attempt, .receiver = &receiver, .trajectory = &table};
    for (std::size_t i = 1; i < table.rows.size(); ++i)
        ++*table.rows[i].arc;
    EXPECT_EQ(map_of(input).folders.at(0).lines.size(), 2u);
    table.rows[1].arc.reset();
    const RunMap map = map_of(input);
    ASSERT_EQ(map.folders.at(0).lines.size(), 2u);
    EXPECT_EQ(map.folders[0].lines[0].points.size(), 1u);
    // An arc of one epoch is a point on the map.
    EXPECT_TRUE(holds(kml_text(map), "<Point>"));
}

TEST(TrackOfAnotherRun, IsRefused) {
    TrajectoryTable table = flat_trajectory();
    Attempt attempt;
    const Receiver receiver;
    Windows windows;
    Verdict verdict;
    verdict.receiver = "primary";
    ProfileVerdict profile;
    profile.rule.origin = RuleOrigin::built_in;
    profile.profile = "nalsa";
    profile.speed_m_s = 60.0;
    profile.window.emplace();
    profile.window->first_epoch = 2;
    profile.window->last_epoch = 4;
    verdict.profiles.push_back(profile);
    const MapInput input{.attempt = &attempt,
                         .receiver = &receiver,
                         .trajectory = &table,
                         .windows = &windows,
                         .verdict = &verdict};
    EXPECT_THROW((void)map_of(input), Failure) << "epoch 4 is not there";
    verdict.profiles[0].window->last_epoch = 3;
    EXPECT_EQ(map_of(input).folders.at(0).name, "windows");
    EXPECT_EQ(map_of(input).folders.at(0).lines.at(0).points.size(), 2u);
    table.facts.receiver = "secondary";
    EXPECT_EQ(map_of(input).folders.at(0).name, "track") << "windows are the first receiver's";
    table.facts.georeferenced = false;
    EXPECT_THROW((void)map_of(input), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
