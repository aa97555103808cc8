#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/surface/raw.h"

// What is said of a surface's file before an attempt names it.

namespace runcert::surface {
namespace {

std::optional<RawSurface> read_recognised(const RecordingBytes& file) {
    if (is_landxml(file.bytes)) return read_landxml(file);
    if (is_ply(file.bytes)) return read_ply(file);
    if (is_obj(file.bytes)) return read_obj(file);
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

std::string range_text(const Extent& extent, Eigen::Index axis) {
    return fmt::format("{} to {}", format_fixed(extent.least[axis], 3),
                       format_fixed(extent.most[axis], 3));
}

/// What coordinates of that size may be: a guess, which the surveyor confirms.
std::string frame_text(const Extent& extent, bool north_first) {
    const Eigen::Index east = north_first ? 1 : 0, north = 1 - east;
    const auto within = [&](Eigen::Index axis, double least, double most) {
        return extent.least[axis] >= least && extent.most[axis] <= most;
    };
    if (within(east, -180.0, 180.0) && within(north, -90.0, 90.0) &&
        (extent.most - extent.least).head<2>().maxCoeff() < 1.0)
        return "geodetic";
    if (within(east, 1e5, 9e5) && within(north, 0.0, 1e7) && extent.least[north] > 1e4)
        return "{utm: {zone: ..., hemisphere: ...}}";
    return "local_plane";
}

std::string yaml_of(const RawSurface& raw, const std::string& name) {
    const std::string frame = frame_text(extent_of(raw.mesh), raw.north_first);
    std::string text =
        fmt::format("antenna_height_m: ...\nsurface:\n  file: {}\n  frame: {}\n", name, frame);
    if (!raw.unit_m) text += "  unit: ...  # m, mm, ft or us-ft\n";
    if (frame != "local_plane")
        text += "  heights: ...  # ellipsoid; or geoid, with undulation_m\n";
    return text + "  vertical_sd_m: ...\n  source: ...  # who surveyed it, how and when";
}

}  // namespace

std::optional<Section> describe(const RecordingBytes& file) {
    const std::optional<RawSurface> raw = read_recognised(file);
    if (!raw || raw->mesh.vertices.empty()) return std::nullopt;
    const Extent extent = extent_of(raw->mesh);
    Section section{.anchor = "surface", .title = "Surface"};
    Block found = facts({});
    add_fact(found, "Format", raw->format == "landxml" ? "LandXML 1.2, a TIN" : raw->format);
    add_fact(found, "Vertices", std::to_string(raw->mesh.vertices.size()));
    add_fact(found, "Triangles", std::to_string(raw->mesh.triangles.size()));
    add_fact(found, "Invisible faces", std::to_string(raw->invisible));
    add_fact(found, raw->north_first ? "Northing" : "First coordinate", range_text(extent, 0));
    add_fact(found, raw->north_first ? "Easting" : "Second coordinate", range_text(extent, 1));
    add_fact(found, "Height", range_text(extent, 2));
    add_fact(found, "Unit", raw->unit_m ? raw->unit_name : "not stated");
    add(section, found);
    add(section, paragraph("An attempt describes it so, beside its receiver's recording:"));
    add(section, code(yaml_of(*raw, escape_for_message(
                                        file.name.substr(file.name.find_last_of('/') + 1), 200))));
    return section;
}

}  // namespace runcert::surface
