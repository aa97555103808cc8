#include <fmt/format.h>

#include <pugixml.hpp>
#include <sstream>

#include "core/text.h"
#include "handover_support.h"
#include "schemas/trajectory/declared.h"

// Exports, judged by the programs that others read them with: gpsbabel, PROJ.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr double degree_tolerance = 1.0001e-9;

struct Point {
    double longitude = 0.0, latitude = 0.0;
};

/// Runs of three examples, made once: one beaten, one with a refused window and a gap, one on a
/// course.
class Export : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder();
        for (const char* example : {"salt_lake", "rejected", "course", "land_yacht"}) {
            const ProcessResult result = certify(examples / example / "attempt.yaml",
                                                 folder_->path() / example, {"--no-render"});
            ASSERT_NE(result.exit_status, 2) << result.errors;
        }
    }
    static void TearDownTestSuite() { delete folder_; }
    static ProcessResult run_export(const std::string& run, const std::string& format,
                                    std::vector<std::string> more = {},
                                    const Environment& env = {}) {
        std::vector<std::string> arguments{"export", (folder_->path() / run).string(), "--format",
                                           format};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runcert(arguments, env);
    }
    static std::string text_of(const std::string& run, const std::string& format,
                               std::vector<std::string> more = {}) {
        more.insert(more.end(), {"--out", "-"});
        const ProcessResult result = run_export(run, format, more);
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        return result.output;
    }
    /// A file of the suite's folder.
    static std::string put(const std::string& name, const std::string& text) {
        write_quickly(folder_->path() / name, text);
        return (folder_->path() / name).string();
    }

    static TemporaryFolder* folder_;
};
TemporaryFolder* Export::folder_ = nullptr;

std::vector<Point> points_of_gpx(const std::string& text) {
    pugi::xml_document xml;
    EXPECT_TRUE(xml.load_string(text.c_str()));
    std::vector<Point> points;
    for (const auto& found : xml.select_nodes("//trkpt"))
        points.push_back(
            {found.node().attribute("lon").as_double(), found.node().attribute("lat").as_double()});
    return points;
}

/// A line of the map.
struct Line {
    std::string name, description, colour;
    int width = 0;
    std::vector<Point> points = {};
};

/// The lines of a folder of the map: "windows", "course" or "track".
std::vector<Line> lines_of(const std::string& kml, const std::string& folder) {
    pugi::xml_document xml;
    EXPECT_TRUE(xml.load_string(kml.c_str()));
    std::vector<Line> lines;
    for (const auto& found :
         xml.select_nodes(fmt::format("//Folder[name='{}']/Placemark", folder).c_str())) {
        const pugi::xml_node placemark = found.node();
        const pugi::xml_node style = placemark.child("Style").child("LineStyle");
        Line& line = lines.emplace_back(Line{.name = placemark.child_value("name"),
                                             .description = placemark.child_value("description"),
                                             .colour = style.child_value("color"),
                                             .width = style.child("width").text().as_int()});
        std::string text = placemark.child("LineString").child_value("coordinates");
        std::ranges::replace(text, ',', ' ');
        std::istringstream numbers(text);
        double height = 0.0;
        for (Point point; numbers >> point.longitude >> point.latitude >> height;)
            line.points.push_back(point);
    }
    return lines;
}

std::vector<Point> track_of(const std::string& kml) {
    std::vector<Point> points;
    for (const Line& arc : lines_of(kml, "track"))
        points.insert(points.end(), arc.points.begin(), arc.points.end());
    return points;
}

void expect_same(const std::vector<Point>& a, const std::vector<Point>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i].longitude, b[i].longitude, degree_tolerance) << i;
        EXPECT_NEAR(a[i].latitude, b[i].latitude, degree_tolerance) << i;
    }
}

/// The positions of a run's trajectory by PROJ, from its east, north, up and the origin.
std::vector<Point> positions_by_proj(const fs::path& run, const TrajectoryTable& table) {
    std::string lines;
    for (const TrajectoryEpoch& row : table.rows)
        if (row.east_m)
            lines += fmt::format("{:.6f} {:.6f} {:.6f} 0\n", *row.east_m, *row.north_m, *row.up_m);
    write_quickly(run / "enu.txt", lines);
    const Geodetic& origin = table.origin->position;
    const ProcessResult result = shell(
        run, fmt::format("cct -d 12 +proj=pipeline +step +inv +proj=topocentric +ellps=WGS84 "
                         "+lat_0={:.11f} +lon_0={:.11f} +h_0={:.6f} +step +inv +proj=cart "
                         "+ellps=WGS84 +step +proj=unitconvert +xy_in=rad +xy_out=deg enu.txt; rm "
                         "enu.txt",
                         origin.latitude.degrees(), origin.longitude.degrees(), origin.height_m));
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    std::vector<Point> points;
    std::istringstream out(result.output);
    double longitude = 0.0, latitude = 0.0, height = 0.0;
    for (std::string time; out >> longitude >> latitude >> height >> time;)
        points.push_back({longitude, latitude});
    return points;
}

TEST_F(Export, PositionsAreThoseThatProjFinds) {
    if (!has_program("cct")) GTEST_SKIP() << "cct is not installed";
    for (const char* run : {"salt_lake", "course"}) {
        const fs::path folder = folder_->path() / run;
        const TrajectoryTable table =
            read_trajectory(read_file(folder / "4-trajectory.ecsv"), "4-trajectory.ecsv");
        const std::vector<Point> expected = positions_by_proj(folder, table);
        ASSERT_EQ(expected.size(), table.rows.size());
        expect_same(track_of(text_of(run, "kml")), expected);
    }
}

TEST_F(Export, GpsbabelReadsTheMap) {
    if (!has_program("gpsbabel")) GTEST_SKIP() << "gpsbabel is not installed";
    const std::string kml = text_of("salt_lake", "kml");
    const std::vector<Point> track = track_of(kml);
    EXPECT_EQ(track.size(), 601u);
    // The windows of 3 s and 2 s at 10 Hz come first.
    const std::vector<Point> lines = points_of_gpx(
        run_process({"gpsbabel", "-i", "kml", "-f", put("babel.kml", kml), "-o", "gpx", "-F", "-"})
            .output);
    ASSERT_EQ(lines.size(), 31u + 21u + 601u);
    expect_same({lines.begin() + 52, lines.end()}, track);
    expect_same({lines.begin(), lines.begin() + 31}, {track.begin() + 570, track.end()});
}

TEST_F(Export, WindowsSayWhatTheVerdictSays) {
    const auto windows = lines_of(text_of("salt_lake", "kml"), "windows");
    ASSERT_EQ(windows.size(), 2u);
    const std::string& said = windows[0].description;
    const std::string verdict = read_file(folder_->path() / "salt_lake" / "6-verdict.yaml");
    for (const auto& [label, key] :
         {std::pair{"Speed (m/s): ", "speed_m_s: "},
          std::pair{"Expanded uncertainty, k = 2 (m/s): ", "expanded_uncertainty_m_s: "}}) {
        const std::size_t at = said.find(label);
        ASSERT_NE(at, said.npos) << said;
        const std::size_t from = at + std::string(label).size();
        std::string figure = said.substr(from, said.find('<', from) - from);
        figure.erase(figure.find_last_not_of('0') + 1);  // as YAML writes it
        EXPECT_TRUE(holds(verdict, key + figure)) << said;
    }
    for (const char* part :
         {"Rule: nalsa<", "UTC: 2026-03-14 03:20:57.000 to 2026-03-14 03:21:00.000<",
          "Length: 3.000 s<", "Speed defined as: displacement over time<"})
        EXPECT_TRUE(holds(said, part)) << part << said;
    // Windows that lie over one another are told apart.
    EXPECT_NE(windows[0].colour, windows[1].colour);
    EXPECT_NE(windows[0].width, windows[1].width);
}

TEST_F(Export, ARefusedWindowIsMarkedAndTheTrackBrokenAtTheStep) {
    const std::string map = text_of("rejected", "kml");
    const auto windows = lines_of(map, "windows");
    ASSERT_EQ(windows.size(), 2u);  // what is drawn last lies on top
    const Line& refused = windows[0];
    // As the reason for the outcome has it, not rounded to 224.33.
    EXPECT_EQ(refused.name, "nalsa: 224.32 km/h REFUSED, not certified");
    EXPECT_TRUE(holds(windows[1].description, "The recording shows 224.32 km/h"));
    EXPECT_FALSE(holds(windows[1].name, "REFUSED"));
    EXPECT_TRUE(holds(refused.description, "Not certified, because: "));
    EXPECT_TRUE(holds(refused.description, "step"));
    EXPECT_FALSE(holds(refused.description, "Why: "));
    EXPECT_FALSE(holds(refused.description, "Expanded uncertainty"));
    EXPECT_NE(refused.colour, windows[1].colour);
    EXPECT_EQ(lines_of(map, "track").size(), 2u);
    EXPECT_EQ(track_of(map).size(), 601u);
}

TEST_F(Export, TheCoursesLinesAreWhereTheAttemptSays) {
    pugi::xml_document xml;
    EXPECT_TRUE(xml.load_string(text_of("course", "kml").c_str()));
    const auto gates = xml.select_nodes("//Folder[name='course']//coordinates");
    ASSERT_EQ(gates.size(), 2u);
    EXPECT_STREQ(gates[0].node().child_value(),
                 "14.415848892,-22.919728996 14.415848915,-22.920270789");
    EXPECT_STREQ(gates[1].node().child_value(),
                 "14.420722968,-22.919728742 14.420723010,-22.920270534");
}

TEST_F(Export, EveryThinsTheTrackAndKeepsItsEnds) {
    const std::string all = text_of("salt_lake", "kml");
    const std::string few = text_of("salt_lake", "kml", {"--every", "7"});
    const auto whole = track_of(all);
    const auto thin = track_of(few);
    ASSERT_EQ(thin.size(), 87u);  // 0, 7, ..., 595 and 600
    expect_same({thin.front(), thin.at(1), thin.back()},
                {whole.front(), whole.at(7), whole.back()});
    EXPECT_EQ(all.substr(0, all.find("<name>track</name>")),
              few.substr(0, few.find("<name>track</name>")));
    for (const char* bad : {"0", "-1", "x"})
        EXPECT_EQ(run_export("salt_lake", "kml", {"--every", bad, "--out", "-"}).exit_status, 2);
}

TEST_F(Export, EveryTableIsPlainCsvWithTheSameCells) {
    const std::map<std::string, std::string> tables{{"observations", "1-observations.ecsv"},
                                                    {"enu", "2-enu.ecsv"},
                                                    {"screened", "3-screened.ecsv"},
                                                    {"trajectory", "4-trajectory.ecsv"}};
    for (const char* run : {"salt_lake", "land_yacht"})
        for (const auto& [table, file] : tables) {
            std::istringstream lines(read_file(folder_->path() / run / file));
            std::string expected;
            for (std::string line; std::getline(lines, line);)
                if (!line.starts_with("#")) expected += line + "\n";
            EXPECT_TRUE(text_of(run, "csv", {"--table", table}) == expected) << run << table;
        }
    EXPECT_EQ(text_of("salt_lake", "csv"), text_of("salt_lake", "csv", {"--table", "trajectory"}));
}

TEST_F(Export, TheSameBytesInEveryLocaleAndZone) {
    for (const char* format : {"kml", "csv"}) {
        const std::string out = (folder_->path() / "again").string();
        const ProcessResult result = run_export("course", format, {"--out", out, "--force"},
                                                {{"LC_ALL", "C.UTF-8"}, {"TZ", "Asia/Kolkata"}});
        EXPECT_EQ(result.exit_status, 0) << result.errors;
        EXPECT_TRUE(read_file(out) == text_of("course", format)) << format;
    }
}

// The window of the first rule ends with the recording; the stage has its mean by itself.
TEST_F(Export, SpeedsOverTheRulesLengthsAreATable) {
    const std::string csv = text_of("salt_lake", "csv", {"--table", "rule_speeds"});
    EXPECT_TRUE(csv.starts_with("epoch,time_s,utc,speed_m_s,speed_nalsa_m_s,speed_fisly_m_s\n"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 602);
    const std::string last = csv.substr(csv.rfind("\n601,60.000000000,") + 1);
    std::istringstream row(last);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, ',');)
        cells.push_back(cell);
    ASSERT_EQ(cells.size(), 6U) << last;
    const std::string windows = read_file(folder_->path() / "salt_lake" / "5-windows.yaml");
    const std::size_t mean = windows.find("smoothed_m_s: ") + 14;
    EXPECT_NEAR(parse_double(cells[4]).value(),
                parse_double(windows.substr(mean, windows.find('\n', mean) - mean)).value(), 1e-6);
    expect_refused(run_export("salt_lake", "kml", {"--table", "rule_speeds"}), {"--table"});
}

TEST_F(Export, WhatCannotBeExportedIsRefused) {
    expect_refused(run_export("land_yacht", "kml", {"--out", "-"}),
                   {"engineering coordinates", "--format csv"});
    expect_refused(run_export("salt_lake", "gpx"), {"gpx", "kml"});
    expect_refused(run_export("salt_lake", "csv", {"--table", "windows"}), {"windows"});
    expect_refused(run_export("salt_lake", "kml", {"--table", "enu"}), {"--table"});
    expect_refused(run_export("salt_lake", "csv", {"--every", "2"}), {"--every"});
    expect_refused(run_export("salt_lake", "kml", {"--receiver", "second"}), {"primary"});
    expect_refused(run_export("nowhere", "kml"), {"no such run folder"});
    const std::string mine = put("mine.kml", "mine");
    expect_refused(run_export("salt_lake", "kml", {"--out", mine}), {"exists already", "--force"});
    EXPECT_EQ(read_file(mine), "mine");
    fs::copy(folder_->path() / "salt_lake", folder_->path() / "spoilt");
    write_quickly(folder_->path() / "spoilt" / "4-trajectory.ecsv",
                  read_file(folder_->path() / "rejected" / "4-trajectory.ecsv"));
    expect_refused(run_export("spoilt", "kml", {"--out", "-"}), {"4-trajectory.ecsv"});
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
