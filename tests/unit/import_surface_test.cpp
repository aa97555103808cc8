#include <fmt/format.h>
#include <gtest/gtest.h>

#include <ctime>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/geodesy.h"
#include "import_test_support.h"
#include "reports/inspection/described.h"
#include "stages/import/surface/surface.h"
#include "witness/surface_input.h"

// Surfaces of each format, and what is refused of them.

namespace runcert::RUNCERT_FILE {
namespace {

using surface::StreamedSurface;

Receiver receiver_with(CoordinateFrame frame = CoordinateFrame::local_plane) {
    Receiver receiver;
    receiver.id = "primary";
    Surface& stated = receiver.surface.emplace();
    stated.place = "attempt.yaml:9:9";
    stated.file = "course";
    stated.source = "a survey";
    stated.unit = "m";
    stated.frame = StatedFrame{.kind = frame};
    if (frame != CoordinateFrame::local_plane) stated.heights = SurfaceHeights::ellipsoid;
    return receiver;
}

SurfaceTable read(const std::string& text, const Receiver& receiver,
                  const std::string& triangles = {}) {
    surface::SurfaceFiles files{.file = {.name = "course", .bytes = text}};
    if (!triangles.empty())
        files.triangles = RecordingBytes{.name = "triangles", .bytes = triangles};
    const StreamedSurface streamed = surface::import_surface(receiver, files);
    SurfaceTable table = streamed.head;
    streamed.give([&](const SurfaceRow& row) { table.rows.push_back(row); });
    // It is written and read as it is.
    return read_surface(write_surface(table), "1-surface.ecsv");
}

std::string refused(const std::string& text, const Receiver& receiver = receiver_with(),
                    const std::string& triangles = {}) {
    try {
        (void)read(text, receiver, triangles);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "accepted";
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Two triangles over a square of 10 m that rises by 1 m towards north.
constexpr const char* landxml = R"(<?xml version="1.0"?>
<LandXML version="1.2" xmlns="http://www.landxml.org/schema/LandXML-1.2">
<Units><Metric linearUnit="meter" elevationUnit="meter"/></Units>
<Surfaces><Surface name="track"><Definition surfType="TIN">
<Pnts><P id="7">0 0 5</P><P id="8">0 10 5</P><P id="20">10 10 6</P>
<P id="21">10 0 6</P><P id="30">500 500 9</P></Pnts>
<Faces><F>7 8 20</F><F>7 20 21</F>
<F i="1">7 8 30</F></Faces></Definition></Surface></Surfaces></LandXML>
)";

constexpr const char* vertices =
    "vertex;x;y;z\n# corners\n11;0;0;5\n5;10;0;5\n6;10;10;6\n9;0;10;6\n";
/// The second clockwise.
constexpr const char* triangles = "vertex_1,vertex_2,vertex_3\n11,5,6\n11,9,6\n";
constexpr const char* one_triangle = "vertex_1,vertex_2,vertex_3\n1,2,3\n";

/// A table of vertices, numbered from 1.
std::string table_of(const std::vector<std::string>& coordinates) {
    std::string text = "vertex,x,y,z\n";
    for (std::size_t i = 0; i < coordinates.size(); ++i)
        text += fmt::format("{},{}\n", i + 1, coordinates[i]);
    return text;
}

/// LandXML of points alone.
std::string without_faces() {
    const std::string text = landxml;
    const std::size_t begin = text.find("<Faces>");
    return text.substr(0, begin) + text.substr(text.find("</Definition>"));
}

void expect_square(const SurfaceTable& table) {
    EXPECT_EQ(table.found.vertices, 4);
    EXPECT_EQ(table.found.triangles, 2);
    EXPECT_NEAR(table.found.area_m2, 100.0, 0.1);
    EXPECT_NEAR(table.found.edge_m, 10.0, 1e-3);
    const Triangulation ground = surface_of(table, std::nullopt);
    for (const Eigen::Vector2d& place : {Eigen::Vector2d(2.0, 7.0), Eigen::Vector2d(7.0, 2.0)}) {
        const auto point = ground.at(place);
        ASSERT_TRUE(point);
        EXPECT_NEAR(point->up_m, 5.0 + 0.1 * place.y(), 1e-4);
        EXPECT_GT(point->normal.z(), 0.9);
        EXPECT_LT(point->normal.y(), -0.09);
    }
}

TEST(SurfaceFormats, HoldTheSameSquare) {
    const SurfaceTable from_tables = read(vertices, receiver_with(), triangles);
    EXPECT_EQ(from_tables.format, "csv");
    EXPECT_EQ(from_tables.found.turned, 1);
    ASSERT_FALSE(from_tables.notes.empty());
    EXPECT_TRUE(says(from_tables.notes.back(), "1 of 2 triangles are listed clockwise"));
    expect_square(from_tables);
    Receiver of_landxml = receiver_with();
    of_landxml.surface->unit = "";
    const SurfaceTable from_landxml = read(landxml, of_landxml);
    EXPECT_EQ(from_landxml.format, "landxml");
    EXPECT_EQ(from_landxml.found.invisible, 1);
    EXPECT_EQ(from_landxml.found.unused, 1);
    EXPECT_EQ(from_landxml.rows.at(3).source_line, 6);
    expect_square(from_landxml);
}

TEST(SurfaceFormats, UnitsAxesAndHeightsAreThoseStated) {
    Receiver receiver = receiver_with();
    receiver.surface->unit = "ft";
    EXPECT_NEAR(read(vertices, receiver, triangles).found.area_m2, 100.0 * 0.3048 * 0.3048, 0.1);
    receiver.surface->unit = "mm";
    EXPECT_NEAR(read(vertices, receiver, triangles).found.edge_m, 0.010, 1e-6);
    // The square's neighbour axis: with north first it rises towards east, and is mirrored.
    receiver = receiver_with();
    receiver.surface->axes = "north-east-up";
    const SurfaceTable mirrored = read(vertices, receiver, triangles);
    EXPECT_EQ(mirrored.found.turned, 1);
    EXPECT_NEAR(surface_of(mirrored, std::nullopt).at({7.0, 2.0})->up_m, 5.7, 1e-4);
}

TEST(SurfaceFormats, OfTheEarthLieOnTheEllipsoid) {
    const Geodetic corner{.latitude = Angle::from_degrees(-31.6),
                          .longitude = Angle::from_degrees(136.0),
                          .height_m = 110.0};
    const LocalFrame frame(corner);
    std::vector<std::string> geodetic, utm;
    for (const auto& [east, north] : {std::pair(0.0, 0.0), {100.0, 0.0}, {0.0, 100.0}}) {
        const Geodetic place = frame.geodetic_from_enu({{east, north, 0.01 * east}});
        geodetic.push_back(fmt::format("{:.10f},{:.10f},{:.4f}", place.longitude.degrees(),
                                       place.latitude.degrees(), place.height_m - 2.5));
        const UtmCoordinates grid = utm_from_geodetic({.zone = 53, .northern = false}, place);
        utm.push_back(fmt::format("{:.4f},{:.4f},{:.4f}", grid.easting_m, grid.northing_m,
                                  place.height_m - 2.5));
    }
    Receiver receiver = receiver_with(CoordinateFrame::geodetic);
    receiver.surface->heights = SurfaceHeights::geoid;
    receiver.surface->undulation = 2.5;
    const FrameOrigin origin{.position = corner, .source = "attempt"};
    const auto expect_plane = [&](const SurfaceTable& table) {
        EXPECT_TRUE(table.georeferenced);
        EXPECT_EQ(table.undulation_m, 2.5);
        EXPECT_NEAR(surface_of(table, origin).at({40.0, 30.0})->up_m, 0.4, 2e-3);
        EXPECT_FALSE(surface_of(table, origin).at({60.0, 60.0}));
        EXPECT_THROW(surface_of(table, std::nullopt), Failure);
    };
    expect_plane(read(table_of(geodetic), receiver, one_triangle));
    receiver.surface->frame = StatedFrame{.kind = CoordinateFrame::utm,
                                          .utm_zone = UtmZone{.zone = 53, .northern = false}};
    expect_plane(read(table_of(utm), receiver, one_triangle));
    EXPECT_TRUE(says(refused(table_of(geodetic), receiver, one_triangle),
                     "course:2: the vertex is not where"));
}

TEST(SurfaceFormats, AreDescribedWithTheLinesOfAnAttempt) {
    const auto text_of = [](const std::string& text) {
        const auto is = surface::recognise({.name = "day/course.xml", .bytes = text});
        return is ? receiver_lines(*is, "course.xml") + members_json(*is).dump()
                  : std::string("nothing");
    };
    const std::string said = text_of(landxml);
    for (const char* part : {"LandXML 1.2, a TIN", "0.000 to 500.000", "Easting", "meter",
                             "file: course.xml", "frame: ...", "may be local_plane", "source: ..."})
        EXPECT_TRUE(says(said, part)) << said;
    EXPECT_TRUE(says(text_of(vertices), "unit: ...\n"));
    EXPECT_TRUE(says(text_of(table_of({"440000,7465000,27"})), "may be utm."));
    EXPECT_TRUE(says(text_of(table_of({"136.01,-31.6,27"})), "may be geodetic."));
    EXPECT_EQ(text_of("time,lat\n1,2\n"), "nothing");
    const std::string table = text_of("# a survey\nvertex;east;north;up\n7;1;2;3\n9;4;2;5\n");
    for (const char* part : {"a table (CSV)", "1.000 to 4.000", "3.000 to 5.000",
                             "The table of the triangles", "triangles: ..."})
        EXPECT_TRUE(says(table, part)) << table;
    EXPECT_TRUE(says(text_of("vertex_1,vertex_2,vertex_3\n1,2,3\n1,3,4\n"),
                     "beside the table of the vertices"));
    EXPECT_TRUE(says(text_of(without_faces()), "points, and no triangles"));
}

// What runcert surface writes says frame, unit, heights and uncertainty itself.
TEST(SurfaceFormats, OfRuncertSurfaceAreDescribedWithTheRunsThatMadeThem) {
    SurfaceTable made{.header = {},
                      .format = "runcert",
                      .frame = "geodetic",
                      .georeferenced = true,
                      .vertical_sd_m = 0.017,
                      .source = "runs",
                      .made_from = {{.id = "monday", .recordings = {}, .positions = 12}},
                      .found = {.vertices = 3, .triangles = 1, .area_m2 = 50.0},
                      .rows = {}};
    for (int i = 0; i < 3; ++i)
        made.rows.push_back({.element = SurfaceElement::vertex,
                             .number = i + 1,
                             .latitude_deg = -31.6 + 1e-4 * (i == 2),
                             .longitude_deg = 136.0 + 1e-4 * (i == 1),
                             .height_m = 110.0 + i});
    made.rows.push_back({.element = SurfaceElement::triangle,
                         .number = 1,
                         .corner_1 = 1,
                         .corner_2 = 2,
                         .corner_3 = 3});
    const std::string bytes = write_surface(made);
    const RecordingBytes file{.name = "course.ecsv", .bytes = bytes};
    const Recognition is = surface::recognise(file).value();
    const std::string said = receiver_lines(is, "course.ecsv") + members_json(is).dump();
    for (const char* part : {"written by runcert surface", "-31.6000000 to -31.5999000",
                             "110.000 to 112.000", "0.017 m", "monday, 12 positions", "50 m2"})
        EXPECT_TRUE(says(said, part)) << said;
    EXPECT_FALSE(says(said, "frame:")) << said;
    EXPECT_EQ(is.kind, RecordingKind::surface);
    EXPECT_EQ(is.triangles, 1);
    ASSERT_EQ(is.needed.size(), 1U);
    EXPECT_EQ(is.needed[0].key, "surface.source");
}

TEST(SurfaceFormats, AreRecognisedWithWhatMustBeSaid) {
    const auto keys_of = [](const std::string& text) {
        std::string keys;
        const auto is = surface::recognise({.name = "course", .bytes = text});
        for (const NeededKey& one : is.value().needed)
            keys += one.key.substr(8) + (one.required ? "! " : " ");
        return keys;
    };
    EXPECT_EQ(keys_of(landxml), "frame! vertical_sd_m source! ");  // it says its unit
    EXPECT_EQ(keys_of(vertices), "triangles! frame! unit! vertical_sd_m source! ");
    EXPECT_EQ(keys_of(table_of({"440000,7465000,27", "440010,7465000,27", "440000,7465010,28"})),
              "triangles! frame! unit! heights! vertical_sd_m source! ");
    EXPECT_EQ(keys_of("vertex,longitude,latitude,height\n1,136,-31,27\n"),
              "triangles! frame! unit! heights! vertical_sd_m source! ");
    EXPECT_EQ(surface::recognise({.name = "t", .bytes = "vertex_1,vertex_2,vertex_3\n1,2,3\n"})
                  .value()
                  .kind,
              RecordingKind::triangles);
    EXPECT_FALSE(surface::recognise({.name = "log", .bytes = "time,vertex,x\n1,2,3\n"}));
    const auto refusal = [](const std::string& text) {
        try {
            (void)surface::recognise({.name = "course", .bytes = text});
        } catch (const Failure& failure) {
            return failure.problem() + ". " + failure.remedy();
        }
        return std::string("recognised");
    };
    EXPECT_TRUE(says(refusal("# a course\nv 0 0 5\nv 9 0 5\nv 0 9 5\nf 1 2 3\n"), "this is OBJ"));
    EXPECT_TRUE(says(refusal("ply\nformat ascii 1.0\n"), "this is PLY"));
    EXPECT_TRUE(says(refusal("  0\nSECTION\n  2\nENTITIES\n  0\n3DFACE\n"), "a drawing (DXF)"));
    EXPECT_TRUE(says(refusal(R"({"type": "FeatureCollection", "features": [{"geometry": )"
                             R"({"type": "Polygon", "coordinates": [[[136, -31, 10]]]}}]})"),
                     "this is GeoJSON"));
}

TEST(SurfaceRefusals, NamePlaceAndRemedy) {
    const auto of_one = [](const std::string& first, const std::string& second,
                           const std::string& third) {
        return refused(table_of({first, second, third}), receiver_with(), one_triangle);
    };
    EXPECT_TRUE(says(refused("hello\n"), "attempt.yaml:9:9: \"course\" is no surface"));
    EXPECT_TRUE(says(of_one("0,0,5", "1,0,x", "0,1,5"), "course:3:7"));
    EXPECT_TRUE(says(of_one("0,0,5", "1,0,5", "2,0,7"), "triangle 1 (line 2) has no area in plan"));
    EXPECT_TRUE(says(refused(without_faces()), "the surface has no triangles"));
    EXPECT_TRUE(says(of_one("0,0,5", "1e300,0,5", "2,1,7"),
                     "vertex 2 is farther away than the Earth is wide"));
    // A bridge over the course.
    EXPECT_TRUE(says(refused(std::string(vertices) + "1;2;2;9\n2;8;2;9\n3;2;8;9\n", receiver_with(),
                             std::string(triangles) + "1,2,3\n"),
                     "triangles 1 (line 2) and 3 (line 4) lie over the same ground"));
    Receiver receiver = receiver_with();
    receiver.surface->unit = "";
    EXPECT_TRUE(says(refused(vertices, receiver, triangles), "Add unit: m, mm, ft or us-ft"));
    EXPECT_TRUE(says(refused(std::string(landxml).replace(std::string(landxml).find("\"meter\""), 7,
                                                          "\"furlong\""),
                             receiver),
                     "\"furlong\" is no unit"));
    receiver.surface->unit = "ft";
    EXPECT_TRUE(
        says(refused(landxml, receiver), "the file's unit is meter, and the attempt's is ft"));
    receiver = receiver_with();
    receiver.surface->frame.reset();
    EXPECT_TRUE(
        says(refused(vertices, receiver, triangles), "Add frame: geodetic, local_plane, or utm"));
}

TEST(SurfaceRefusals, OfLandXmlAndTables) {
    const auto changed = [](std::string text, const std::string& from, const std::string& to) {
        return text.replace(text.find(from), from.size(), to);
    };
    EXPECT_TRUE(says(refused(changed(landxml, "surfType=\"TIN\"", "surfType=\"grid\"")),
                     "of type \"grid\""));
    EXPECT_TRUE(
        says(refused(changed(landxml, "id=\"8\"", "id=\"7\"")), "two vertices have the number 7"));
    EXPECT_TRUE(says(refused(changed(landxml, "<F>7 8 20</F>", "<F>7 8 99</F>")), "vertex 99"));
    EXPECT_TRUE(
        says(refused(changed(landxml, "0 10 5", "0 10")), "2 numbers where there are three"));
    EXPECT_TRUE(says(refused(changed(landxml, "</Faces>", "</Face>")), "the XML cannot be read"));
    EXPECT_TRUE(
        says(refused(changed(landxml, "<Surface name",
                             "<Surface name=\"other\"><Definition/></Surface><Surface name")),
             "\"other\" and \"track\""));
    EXPECT_TRUE(says(refused(vertices, receiver_with(), changed(triangles, "11,9,6", "11,9,10")),
                     "triangles:3:6: the triangle names vertex 10"));
    EXPECT_TRUE(says(refused("a;b\n1;2\n", receiver_with(), triangles),
                     "does not name the columns vertex, x, y, z"));
}

TEST(SurfaceRefusals, OfASurfaceThatTheRunItselfMade) {
    SurfaceTable table;
    table.made_from.push_back({.id = "earlier", .recordings = {"abc"}, .positions = 9});
    EXPECT_NO_THROW(surface::require_of_another_run(receiver_with(), table, {"def"}, true));
    EXPECT_THROW(surface::require_of_another_run(receiver_with(), table, {"def", "abc"}, true),
                 Failure);
    table.georeferenced = true;
    EXPECT_THROW(surface::require_of_another_run(receiver_with(), table, {"def"}, false), Failure);
}

TEST(SurfaceFormats, AMillionTrianglesTakeSeconds) {
    constexpr int side = 708;
    std::string points = "vertex,x,y,z\n", faces = "vertex_1,vertex_2,vertex_3\n";
    for (int row = 0; row <= side; ++row)
        for (int column = 0; column <= side; ++column)
            points += fmt::format("{},{},{},{}\n", row * (side + 1) + column, 10 * column, 10 * row,
                                  0.01 * row);
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const int corner = row * (side + 1) + column;
            faces += fmt::format("{0},{1},{2}\n{0},{2},{3}\n", corner, corner + 1,
                                 corner + side + 2, corner + side + 1);
        }
    const std::clock_t before = std::clock();
    const StreamedSurface streamed = surface::import_surface(
        receiver_with(), {.file = {.name = "course", .bytes = points},
                          .triangles = RecordingBytes{.name = "triangles", .bytes = faces}});
    EXPECT_EQ(streamed.head.found.triangles, 2 * side * side);
    EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 60.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
