#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "core/text.h"
#include "handover_support.h"
#include "schemas/trajectory/declared.h"

// Exports, judged by the programs that others read them with: gpsbabel, GDAL, xmllint, PROJ.

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

std::vector<Point> points_of_feature(const nlohmann::json& feature) {
    std::vector<Point> points;
    for (const auto& place : feature.at("geometry").at("coordinates"))
        points.push_back({place.at(0).get<double>(), place.at(1).get<double>()});
    return points;
}

void expect_same(const std::vector<Point>& a, const std::vector<Point>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(a[i].longitude, b[i].longitude, degree_tolerance) << i;
        EXPECT_NEAR(a[i].latitude, b[i].latitude, degree_tolerance) << i;
    }
}

std::vector<nlohmann::json> features_of(const nlohmann::json& collection, const std::string& kind) {
    std::vector<nlohmann::json> some;
    for (const auto& feature : collection.at("features"))
        if (feature.at("properties").at("kind") == kind) some.push_back(feature);
    return some;
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
        expect_same(points_of_gpx(text_of(run, "gpx")), expected);
    }
}

TEST_F(Export, GpsbabelReadsGpxAndKml) {
    if (!has_program("gpsbabel")) GTEST_SKIP() << "gpsbabel is not installed";
    const std::string gpx = text_of("salt_lake", "gpx");
    const std::vector<Point> track = points_of_gpx(gpx);
    EXPECT_EQ(track.size(), 601u);
    const auto read = [&](const std::string& format, const std::string& file) {
        return points_of_gpx(
            run_process({"gpsbabel", "-i", format, "-f", file, "-o", "gpx", "-F", "-"}).output);
    };
    expect_same(read("gpx", put("babel.gpx", gpx)), track);
    // In the KML, the windows of 3 s and 2 s at 10 Hz come first.
    const std::vector<Point> lines = read("kml", put("babel.kml", text_of("salt_lake", "kml")));
    ASSERT_EQ(lines.size(), 31u + 21u + 601u);
    expect_same({lines.begin() + 52, lines.end()}, track);
    expect_same({lines.begin(), lines.begin() + 31}, {track.begin() + 570, track.end()});
}

TEST_F(Export, GdalReadsKmlAndGeoJsonAlike) {
    if (!has_program("ogr2ogr")) GTEST_SKIP() << "gdal-bin is not installed";
    for (const char* run : {"salt_lake", "rejected", "course"}) {
        SCOPED_TRACE(run);
        const auto ours = nlohmann::json::parse(text_of(run, "geojson"));
        std::map<std::string, nlohmann::json> by_name;
        for (const auto& feature : ours.at("features"))
            by_name[feature.at("properties").at("name")] = feature;
        EXPECT_EQ(by_name.size(), ours.at("features").size());
        const std::string name(run);
        put(name + ".geojson", ours.dump());
        put(name + ".kml", text_of(run, "kml"));
        const ProcessResult merged = shell(
            folder_->path(),
            fmt::format("rm -rf m_{0}; mkdir m_{0}; ogr2ogr -f GeoJSON -lco "
                        "COORDINATE_PRECISION=12 m_{0}/j.json {0}.geojson; for l in windows course "
                        "track; do if grep -q \"<name>$l</name>\" <(sed -n '/<Folder>/,+1p' "
                        "{0}.kml); then ogr2ogr -f GeoJSON -lco COORDINATE_PRECISION=12 "
                        "m_{0}/$l.json {0}.kml $l; fi; done",
                        run));
        ASSERT_EQ(merged.exit_status, 0) << merged.errors;
        std::size_t from_kml = 0, from_json = 0;
        for (const auto& [file, text] : contents_of(folder_->path() / ("m_" + name))) {
            const auto read = nlohmann::json::parse(text);
            for (const auto& feature : read.at("features")) {
                const auto& properties = feature.at("properties");
                const std::string key =
                    properties.contains("name") ? properties["name"] : properties["Name"];
                ASSERT_TRUE(by_name.contains(key)) << key;
                expect_same(points_of_feature(feature), points_of_feature(by_name[key]));
                ++(file == "j.json" ? from_json : from_kml);
            }
        }
        EXPECT_EQ(from_json, by_name.size());
        EXPECT_EQ(from_kml, by_name.size());
    }
}

TEST_F(Export, WindowsSayWhatTheVerdictSays) {
    const auto map = nlohmann::json::parse(text_of("salt_lake", "geojson"));
    const YamlValue verdict = read_yaml(folder_->path() / "salt_lake" / "6-verdict.yaml");
    const auto windows = features_of(map, "window");
    ASSERT_EQ(windows.size(), 2u);
    EXPECT_TRUE(features_of(map, "refused_window").empty());
    const auto& one = windows[0].at("properties");
    EXPECT_EQ(one.at("rule"), "nalsa");
    EXPECT_EQ(one.at("rule_outcome"), "beaten");
    const std::string text = read_file(folder_->path() / "salt_lake" / "6-verdict.yaml");
    EXPECT_TRUE(holds(text, fmt::format("speed_m_s: {}", one.at("speed_m_s").dump())));
    EXPECT_TRUE(holds(text, fmt::format("expanded_uncertainty_m_s: {}",
                                        one.at("expanded_uncertainty_m_s").dump())));
    EXPECT_TRUE(holds(text, one.at("start_utc").get<std::string>()));
    EXPECT_EQ(one.at("start_utc"), "2026-03-14T03:20:57.000Z");
    EXPECT_EQ(one.at("end_utc"), "2026-03-14T03:21:00.000Z");
    EXPECT_EQ(one.at("duration_s"), 3);
    // Windows that lie over one another are told apart.
    EXPECT_NE(one.at("stroke"), windows[1].at("properties").at("stroke"));
    EXPECT_NE(one.at("stroke-width"), windows[1].at("properties").at("stroke-width"));
}

TEST_F(Export, ARefusedWindowIsMarkedAndTheTrackBrokenAtTheStep) {
    const auto map = nlohmann::json::parse(text_of("rejected", "geojson"));
    const auto refused = features_of(map, "refused_window");
    const auto best = features_of(map, "window");
    ASSERT_EQ(refused.size(), 1u);
    ASSERT_EQ(best.size(), 1u);
    const auto& properties = refused[0].at("properties");
    EXPECT_TRUE(holds(properties.at("name"), "REFUSED"));
    EXPECT_TRUE(holds(properties.at("refused_because"), "step"));
    EXPECT_FALSE(properties.contains("reason"));
    EXPECT_FALSE(properties.contains("expanded_uncertainty_m_s"));
    EXPECT_GT(properties.at("speed_m_s"), best[0].at("properties").at("speed_m_s"));
    EXPECT_NE(properties.at("stroke"), best[0].at("properties").at("stroke"));
    const auto arcs = features_of(map, "track");
    ASSERT_EQ(arcs.size(), 2u);
    EXPECT_EQ(points_of_feature(arcs[0]).size() + points_of_feature(arcs[1]).size(), 601u);
    const std::string gpx = text_of("rejected", "gpx");
    EXPECT_TRUE(holds(gpx.substr(gpx.find("</trkseg>") + 1), "</trkseg>"));
}

TEST_F(Export, TheCoursesLinesAreWhereTheAttemptSays) {
    const auto gates = features_of(nlohmann::json::parse(text_of("course", "geojson")), "gate");
    ASSERT_EQ(gates.size(), 2u);
    expect_same(points_of_feature(gates[0]),
                {{14.415848892, -22.919728996}, {14.415848915, -22.920270789}});
    expect_same(points_of_feature(gates[1]),
                {{14.420722968, -22.919728742}, {14.420723010, -22.920270534}});
}

TEST_F(Export, EveryThinsTheTrackAndKeepsItsEnds) {
    const auto all = nlohmann::json::parse(text_of("salt_lake", "geojson"));
    const auto few = nlohmann::json::parse(text_of("salt_lake", "geojson", {"--every", "7"}));
    const auto whole = points_of_feature(features_of(all, "track").at(0));
    const auto thin = points_of_feature(features_of(few, "track").at(0));
    ASSERT_EQ(thin.size(), 87u);  // 0, 7, ..., 595 and 600
    expect_same({thin.front(), thin.at(1), thin.back()},
                {whole.front(), whole.at(7), whole.back()});
    EXPECT_EQ(features_of(all, "window"), features_of(few, "window"));
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
            const std::string csv = text_of(run, "csv", {"--table", table});
            EXPECT_TRUE(csv == expected) << run << table;
            if (!has_program("ogrinfo")) continue;
            put("table.csv", csv);
            const ProcessResult seen = shell(folder_->path(), "ogrinfo -al -so table.csv");
            const auto rows = std::count(csv.begin(), csv.end(), '\n') - 1;
            EXPECT_TRUE(holds(seen.output, fmt::format("Feature Count: {}\n", rows)))
                << seen.output;
            EXPECT_TRUE(holds(seen.output, "epoch: String")) << seen.output;
        }
    EXPECT_EQ(text_of("salt_lake", "csv"), text_of("salt_lake", "csv", {"--table", "trajectory"}));
}

TEST_F(Export, TheSameBytesInEveryLocaleAndZone) {
    for (const char* format : {"kml", "geojson", "gpx", "csv"}) {
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
    for (const char* format : {"kml", "geojson", "gpx"})
        expect_refused(run_export("land_yacht", format, {"--out", "-"}),
                       {"engineering coordinates", "--format csv"});
    expect_refused(run_export("salt_lake", "shp"), {"shp"});
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
