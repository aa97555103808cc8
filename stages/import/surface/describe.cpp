#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/inspect.h"
#include "stages/import/recognise.h"
#include "stages/import/surface/raw.h"

// What is said of a surface's file before an attempt names it.

namespace runcert::surface {
namespace {

/// A file that belongs to a surface, as it is by itself.
struct SeenSurface {
    RawSurface raw;
    std::optional<SurfaceTable> own = std::nullopt;               ///< what `runcert surface` wrote
    std::optional<std::int64_t> triangles_beside = std::nullopt;  ///< of a table of triangles alone

    bool says_all() const { return own.has_value(); }
    /// Of a pair of tables that of the vertices.
    bool is_vertex_table() const { return raw.format == "csv"; }
    bool in_degrees() const { return own && own->georeferenced; }
};

SeenSurface read_own(const RecordingBytes& file) {
    SeenSurface seen{.raw = {.format = "runcert", .unit_m = 1.0, .unit_name = "m"},
                     .own = read_surface(file.bytes, file.name)};
    for (const SurfaceRow& row : seen.own->rows)
        if (row.element == SurfaceElement::triangle)
            seen.raw.mesh.triangles.emplace_back();
        else if (seen.own->georeferenced)
            seen.raw.mesh.vertices.emplace_back(row.longitude_deg.value_or(0.0),
                                                row.latitude_deg.value_or(0.0),
                                                row.height_m.value_or(0.0));
        else
            seen.raw.mesh.vertices.emplace_back(row.east_m.value_or(0.0), row.north_m.value_or(0.0),
                                                row.up_m.value_or(0.0));
    return seen;
}

/// Kinds of files in which surveyors deliver surfaces, too, and which are not read.
void refuse_other_kinds(const RecordingBytes& file) {
    const std::string_view head = file.bytes.substr(0, recognised_by);
    const std::string_view first = trim(head.substr(0, head.find('\n')));
    const bool dxf = (first == "0" || first == "999") && head.find("SECTION") != head.npos;
    const bool geojson = first.starts_with('{') && head.find("\"Polygon\"") != head.npos &&
                         head.find("\"coordinates\"") != head.npos;
    const bool obj = first.starts_with("v ") || head.find("\nv ") != head.npos;
    const char* const kind = dxf              ? "a drawing (DXF)"
                             : geojson        ? "GeoJSON"
                             : first == "ply" ? "PLY"
                             : obj            ? "OBJ"
                                              : nullptr;
    if (kind == nullptr) return;
    throw Failure(file.name, fmt::format("this is {}, and surfaces are not read from it", kind),
                  "Export LandXML 1.2");
}

std::optional<SeenSurface> read_seen(const RecordingBytes& file) {
    refuse_other_kinds(file);
    if (is_landxml(file.bytes)) return SeenSurface{.raw = read_landxml(file)};
    if (is_own(file.bytes)) return read_own(file);
    if (is_vertex_table(file.bytes)) return SeenSurface{.raw = read_vertex_table(file)};
    if (is_triangle_table(file.bytes))
        return SeenSurface{.raw = {.format = "csv"}, .triangles_beside = count_triangles(file)};
    return std::nullopt;
}

/// Least and most of the coordinates.
struct Extent {
    Eigen::Vector3d least, most;
};

Extent extent_of(const SurfaceMesh& mesh) {
    Extent extent{mesh.vertices.front(), mesh.vertices.front()};
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        extent.least = extent.least.cwiseMin(vertex);
        extent.most = extent.most.cwiseMax(vertex);
    }
    return extent;
}

std::string range_text(const Extent& extent, Eigen::Index axis, int decimals) {
    return fmt::format("{} to {}", format_fixed(extent.least[axis], decimals),
                       format_fixed(extent.most[axis], decimals));
}

/// What coordinates of that size may be: a guess, which the surveyor confirms.
std::string likely_frame(const Extent& extent, bool north_first) {
    const Eigen::Index east = north_first ? 1 : 0, north = 1 - east;
    const auto within = [&](Eigen::Index axis, double least, double most) {
        return extent.least[axis] >= least && extent.most[axis] <= most;
    };
    if (within(east, -180.0, 180.0) && within(north, -90.0, 90.0) &&
        (extent.most - extent.least).head<2>().maxCoeff() < 1.0)
        return "geodetic";
    if (within(east, 1e5, 9e5) && within(north, 0.0, 1e7) && extent.least[north] > 1e4)
        return "utm";
    return "local_plane";
}

/// Adds what an attempt must say of the file, in the order in which it says it.
void add_needs(const SeenSurface& seen, Recognition& is) {
    const auto need = [&](const char* key, bool required = true) {
        is.needed.push_back(needed_key(key, required));
    };
    if (seen.is_vertex_table()) need("surface.triangles");
    if (!seen.says_all()) {
        const std::string frame = likely_frame(extent_of(seen.raw.mesh), seen.raw.north_first);
        need("surface.frame");
        is.needed.back().reason +=
            fmt::format(" Numbers of that size may be {}.",
                        frame == "local_plane" ? "local_plane, counted from origin" : frame);
        if (!seen.raw.unit_m) need("surface.unit");
        if (frame != "local_plane") need("surface.heights");
        need("surface.vertical_sd_m", false);
    }
    need("surface.source");
}

std::string format_words(const std::string& format) {
    if (format == "landxml") return "LandXML 1.2, a TIN";
    if (format == "runcert") return "written by runcert surface";
    return "a table (CSV)";
}

void add_coordinates(const SeenSurface& seen, FactGroup& found) {
    const RawSurface& raw = seen.raw;
    const Extent extent = extent_of(raw.mesh);
    const bool degrees = seen.in_degrees();
    constexpr int of_degrees = 7, of_metres = 3;
    const int decimals = degrees ? of_degrees : of_metres;
    const char* const first = degrees           ? "Longitude"
                              : seen.says_all() ? "East"
                              : raw.north_first ? "Northing"
                                                : "First coordinate";
    const char* const second = degrees           ? "Latitude"
                               : seen.says_all() ? "North"
                               : raw.north_first ? "Easting"
                                                 : "Second coordinate";
    add_fact(found, first, range_text(extent, 0, decimals));
    add_fact(found, second, range_text(extent, 1, decimals));
    add_fact(found, "Height", range_text(extent, 2, of_metres));
    add_fact(found, "Unit", raw.unit_m ? raw.unit_name : "not stated");
}

void add_own(const SurfaceTable& own, FactGroup& found) {
    add_fact(found, "Area in plan", fmt::format("{} m2", format_fixed(own.found.area_m2, 0)));
    add_fact(found, "Standard deviation of its heights",
             fmt::format("{} m", format_fixed(own.vertical_sd_m, 3)));
    for (const SurfaceRun& run : own.made_from)
        add_fact(found, "Made from", fmt::format("{}, {} positions", run.id, run.positions));
}

/// What the file holds, in words.
FactGroup facts_of(const SeenSurface& seen) {
    const RawSurface& raw = seen.raw;
    FactGroup found{.title = "Surface"};
    add_fact(found, "Format", format_words(raw.format));
    if (seen.triangles_beside) {
        add_fact(found, "Triangles", std::to_string(*seen.triangles_beside));
        return found;
    }
    add_fact(found, "Vertices", std::to_string(raw.mesh.vertices.size()));
    if (!seen.is_vertex_table()) {
        add_fact(found, "Triangles", std::to_string(raw.mesh.triangles.size()));
        add_fact(found, "Invisible faces", std::to_string(raw.invisible));
    }
    add_coordinates(seen, found);
    if (seen.own) add_own(*seen.own, found);
    return found;
}

}  // namespace

std::optional<Recognition> recognise(const RecordingBytes& file) {
    const std::optional<SeenSurface> seen = read_seen(file);
    if (!seen) return std::nullopt;
    const RawSurface& raw = seen->raw;
    Recognition is{.kind = RecordingKind::surface, .format = raw.format};
    const auto say = [&](const char* sentence) {
        is.concerns.push_back({.code = ConcernCode::reading, .says = sentence});
    };
    if (seen->triangles_beside) {
        is.kind = RecordingKind::triangles;
        is.triangles = *seen->triangles_beside;
        is.said.push_back(facts_of(*seen));
        say("These are the triangles of a surface, by the numbers of their vertices. An attempt "
            "names them beside the table of the vertices, as surface: triangles.");
        return is;
    }
    if (raw.mesh.vertices.empty()) return std::nullopt;
    is.vertices = std::ssize(raw.mesh.vertices);
    is.triangles = std::ssize(raw.mesh.triangles);
    is.said.push_back(facts_of(*seen));
    if (seen->is_vertex_table())
        say("These are vertices alone. The table of the triangles between them belongs beside it.");
    else if (raw.mesh.triangles.empty())
        is.problem =
            "The surface has points, and no triangles. Export it with its faces; points alone do "
            "not say what lies between them.";
    add_needs(*seen, is);
    return is;
}

}  // namespace runcert::surface
