#include "stages/import/surface/surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/text.h"
#include "stages/import/surface/raw.h"

namespace runcert::surface {
namespace {

constexpr double usual_vertical_sd_m = 0.10;  // [FHB03]

RawSurface read_raw(const SurfaceFiles& files, const Receiver& receiver) {
    const std::string_view bytes = files.file.bytes;
    if (files.triangles) return read_tables(files.file, *files.triangles);
    if (is_landxml(bytes)) return read_landxml(files.file);
    throw Failure(
        receiver.surface->place,
        fmt::format("\"{}\" is no surface of a format that is known", shown(files.file.name)),
        "Export LandXML 1.2; or a table of vertices, and name the table of its triangles in "
        "surface: triangles");
}

/// Metres in a unit of the file.
double unit_of(const Surface& stated, const RawSurface& raw) {
    const auto metres = [](const std::string& unit) {
        return unit == "mm"      ? 1e-3
               : unit == "ft"    ? 0.3048
               : unit == "us-ft" ? 1200.0 / 3937.0
                                 : 1.0;
    };
    if (stated.unit.empty() && !raw.unit_m)
        throw Failure(stated.place, "neither the file nor the attempt says the unit of its lengths",
                      "Add unit: m, mm, ft or us-ft to surface, as the surveyor states it");
    if (stated.unit.empty()) return *raw.unit_m;
    const double unit = metres(stated.unit);
    if (raw.unit_m && std::abs(*raw.unit_m / unit - 1.0) > 1e-9)
        throw Failure(stated.place,
                      fmt::format("the file's unit is {}, and the attempt's is {}",
                                  escape_for_message(raw.unit_name), stated.unit),
                      "Remove unit from surface, or export the surface again");
    return unit;
}

/// A surface between reading and writing.
struct HeldSurface {
    SurfaceMesh mesh;              ///< in plan coordinates (m), for what is tested
    std::vector<Geodetic> places;  ///< of its vertices; empty in a local frame
    std::vector<std::int64_t> vertex_lines, triangle_lines;
};

void give_rows(const HeldSurface& held, const TakeRow& take) {
    const auto line_of = [](const std::vector<std::int64_t>& lines, std::size_t i,
                            SurfaceRow& row) {
        if (i < lines.size()) row.source_line = static_cast<std::int32_t>(lines[i]);
    };
    for (std::size_t i = 0; i < held.mesh.vertices.size(); ++i) {
        SurfaceRow row;
        row.element = SurfaceElement::vertex;
        row.number = static_cast<std::int64_t>(i) + 1;
        if (held.places.empty()) {
            row.east_m = held.mesh.vertices[i].x();
            row.north_m = held.mesh.vertices[i].y();
            row.up_m = held.mesh.vertices[i].z();
        } else {
            row.latitude_deg = held.places[i].latitude.degrees();
            row.longitude_deg = held.places[i].longitude.degrees();
            row.height_m = held.places[i].height_m;
        }
        line_of(held.vertex_lines, i, row);
        take(row);
    }
    for (std::size_t i = 0; i < held.mesh.triangles.size(); ++i) {
        SurfaceRow row;
        row.element = SurfaceElement::triangle;
        row.number = static_cast<std::int64_t>(i) + 1;
        row.corner_1 = held.mesh.triangles[i][0] + std::int64_t{1};
        row.corner_2 = held.mesh.triangles[i][1] + std::int64_t{1};
        row.corner_3 = held.mesh.triangles[i][2] + std::int64_t{1};
        line_of(held.triangle_lines, i, row);
        take(row);
    }
}

/// Leaves out vertices that no triangle has. Returns how many.
std::int64_t drop_unused(SurfaceMesh& mesh, std::vector<std::int64_t>& lines) {
    std::vector<bool> used(mesh.vertices.size(), false);
    for (const Corners& corners : mesh.triangles)
        for (const std::uint32_t corner : corners)
            used[corner] = true;
    std::vector<std::uint32_t> number(mesh.vertices.size(), 0);
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (!used[i]) continue;
        number[i] = next;
        mesh.vertices[next] = mesh.vertices[i];
        if (!lines.empty()) lines[next] = lines[i];
        ++next;
    }
    const auto unused = std::ssize(mesh.vertices) - static_cast<std::ptrdiff_t>(next);
    mesh.vertices.resize(next);
    if (!lines.empty()) lines.resize(next);
    for (Corners& corners : mesh.triangles)
        for (std::uint32_t& corner : corners)
            corner = number[corner];
    return unused;
}

/// Where a vertex of the file lies on the ellipsoid, with its height above it.
Geodetic place_of(const Eigen::Vector3d& vertex, const Surface& stated, std::int64_t line,
                  const RecordingBytes& file) {
    const double height_m = vertex.z() + stated.undulation.value_or(0.0);
    try {
        if (stated.frame->kind == CoordinateFrame::utm)
            return geodetic_from_utm(*stated.frame->utm_zone, vertex.x(), vertex.y(), height_m);
        const Geodetic place{.latitude = Angle::from_degrees(vertex.y()),
                             .longitude = Angle::from_degrees(vertex.x()),
                             .height_m = height_m};
        require_valid(place);
        return place;
    } catch (const Failure& failure) {
        throw Failure(fmt::format("{}:{}", file.name, line),
                      "the vertex is not where coordinates of that frame are: " + failure.problem(),
                      "Correct surface: frame, or axes: they may be exchanged");
    }
}

/// Turns what the file has into metres, and where it lies.
HeldSurface placed(RawSurface raw, const Surface& stated, const RecordingBytes& file) {
    const bool north_first = stated.axes.empty() ? raw.north_first : stated.axes == "north-east-up";
    const bool degrees = stated.frame->kind == CoordinateFrame::geodetic;
    const double unit = unit_of(stated, raw);
    HeldSurface held{.mesh = std::move(raw.mesh),
                     .places = {},
                     .vertex_lines = std::move(raw.vertex_lines),
                     .triangle_lines = std::move(raw.triangle_lines)};
    for (Eigen::Vector3d& vertex : held.mesh.vertices) {
        if (north_first) std::swap(vertex.x(), vertex.y());
        if (!degrees) vertex.head<2>() *= unit;
        vertex.z() *= unit;
    }
    if (stated.frame->kind == CoordinateFrame::local_plane) return held;
    held.places.reserve(held.mesh.vertices.size());
    for (std::size_t i = 0; i < held.mesh.vertices.size(); ++i)
        held.places.push_back(place_of(held.mesh.vertices[i], stated, held.vertex_lines[i], file));
    return held;
}

/// Plan coordinates in metres of what lies on the ellipsoid.
void set_plan(HeldSurface& held) {
    if (held.places.empty()) return;
    const LocalFrame frame(held.places.front());
    held.mesh.vertices.clear();
    for (const Geodetic& place : held.places)
        held.mesh.vertices.push_back(frame.enu_from_geodetic(place).m);
}

/// Failure for a vertex that cannot be on the Earth beside the others: a unit, or a slip of the
/// pen.
void require_near(const HeldSurface& held, const RecordingBytes& file) {
    constexpr double widest_m = 2e7;
    for (std::size_t i = 0; i < held.mesh.vertices.size(); ++i)
        if (!(held.mesh.vertices[i].cwiseAbs().maxCoeff() <= widest_m))
            throw Failure(file.name,
                          fmt::format("vertex {} is farther away than the Earth is wide", i + 1),
                          "Correct surface: unit or frame, or export the surface again");
}

/// Triangles with an area, counter-clockwise, none over another. Returns how many were turned.
std::int64_t settle_triangles(HeldSurface& held, const RecordingBytes& file) {
    const auto named = [&](std::size_t triangle) {
        return triangle < held.triangle_lines.size()
                   ? fmt::format("{} (line {})", triangle + 1, held.triangle_lines[triangle])
                   : std::to_string(triangle + 1);
    };
    std::int64_t turned = 0;
    for (std::size_t t = 0; t < held.mesh.triangles.size(); ++t) {
        Corners& corners = held.mesh.triangles[t];
        if (is_degenerate(held.mesh, corners))
            throw Failure(file.name,
                          fmt::format("triangle {} has no area in plan: two of its corners are in "
                                      "one place, or all three on a line",
                                      named(t)),
                          "Remove it, or survey the ground without walls and kerbs");
        if (twice_area_in_plan(held.mesh, corners) > 0.0) continue;
        std::swap(corners[1], corners[2]);
        ++turned;
    }
    if (const auto pair = overlapping_triangles(held.mesh))
        throw Failure(file.name,
                      fmt::format("triangles {} and {} lie over the same ground",
                                  named(pair->first), named(pair->second)),
                      "Export the surface that the craft runs on alone, without bridges, roofs or "
                      "a second survey");
    return turned;
}

SurfaceFound measure(const HeldSurface& held) {
    double twice_area_m2 = 0.0;
    for (const Corners& corners : held.mesh.triangles)
        twice_area_m2 += twice_area_in_plan(held.mesh, corners);
    return {.vertices = std::ssize(held.mesh.vertices),
            .triangles = std::ssize(held.mesh.triangles),
            .edge_m = median_edge_m(held.mesh),
            .area_m2 = twice_area_m2 / 2.0};
}

void note_findings(SurfaceTable& head) {
    if (head.found.turned > 0)
        head.notes.push_back(
            fmt::format("{} of {} triangles are listed clockwise seen from above; they are turned "
                        "to face upwards.",
                        head.found.turned, head.found.triangles));
    if (head.found.invisible > 0)
        head.notes.push_back(
            fmt::format("{} faces are marked as invisible and left out.", head.found.invisible));
}

/// A surface that `runcert surface` wrote says all that an attempt says of others.
HeldSurface read_own(const Receiver& receiver, const RecordingBytes& file, SurfaceTable& head) {
    const Surface& stated = *receiver.surface;
    SurfaceTable table = read_surface(file.bytes, file.name);
    if (stated.frame || !stated.unit.empty() || stated.heights || !stated.axes.empty())
        throw Failure(stated.place,
                      "the file of runcert surface says its frame, unit, axes and heights itself",
                      "Remove frame, axes, unit, heights and undulation_m from surface");
    HeldSurface held;
    for (const SurfaceRow& row : table.rows) {
        const auto number = static_cast<std::size_t>(row.number);
        if (row.element == SurfaceElement::vertex) {
            if (number != held.mesh.vertices.size() + 1 || !held.mesh.triangles.empty())
                throw Failure(file.name, fmt::format("vertex {} is out of order", row.number),
                              "Make the surface again with runcert surface");
            const bool on_earth = row.latitude_deg && row.longitude_deg && row.height_m;
            if (on_earth != table.georeferenced ||
                !(on_earth || (row.east_m && row.north_m && row.up_m)))
                throw Failure(file.name, fmt::format("vertex {} has no place", row.number),
                              "Make the surface again with runcert surface");
            if (on_earth)
                held.places.push_back({.latitude = Angle::from_degrees(*row.latitude_deg),
                                       .longitude = Angle::from_degrees(*row.longitude_deg),
                                       .height_m = *row.height_m});
            held.mesh.vertices.emplace_back(row.east_m.value_or(0.0), row.north_m.value_or(0.0),
                                            row.up_m.value_or(0.0));
            continue;
        }
        Corners corners{};
        const OptionalInteger each[] = {row.corner_1, row.corner_2, row.corner_3};
        for (std::size_t i = 0; i < 3; ++i) {
            if (!each[i] || *each[i] < 1 || *each[i] > std::ssize(held.mesh.vertices))
                throw Failure(
                    file.name,
                    fmt::format("triangle {} names a vertex that there is not", row.number),
                    "Make the surface again with runcert surface");
            corners[i] = static_cast<std::uint32_t>(*each[i] - 1);
        }
        held.mesh.triangles.push_back(corners);
    }
    table.rows.clear();
    head = std::move(table);
    head.format = "runcert";
    return held;
}

HeldSurface read_surveyed(const Receiver& receiver, const SurfaceFiles& files, SurfaceTable& head) {
    const Surface& stated = *receiver.surface;
    RawSurface raw = read_raw(files, receiver);
    if (!stated.frame)
        throw Failure(stated.place, "nothing says in what coordinates the surface is",
                      "Add frame: geodetic, local_plane, or utm: {zone: 55, hemisphere: south}");
    if (raw.mesh.triangles.empty())
        throw Failure(files.file.name, "the surface has no triangles",
                      "Export it with its faces; points alone do not say what lies between them");
    head.format = raw.format;
    head.frame = to_text(stated.frame->kind);
    head.undulation_m = stated.undulation.value_or(0.0);
    head.found.invisible = raw.invisible;
    head.found.unused = drop_unused(raw.mesh, raw.vertex_lines);
    return placed(std::move(raw), stated, files.file);
}

}  // namespace

bool is_own(std::string_view bytes) {
    return bytes.starts_with("# %ECSV");
}

StreamedSurface import_surface(const Receiver& receiver, const SurfaceFiles& files) {
    const Surface& stated = *receiver.surface;
    StreamedSurface result;
    SurfaceTable& head = result.head;
    const bool own = is_own(files.file.bytes) && !files.triangles;
    auto held = std::make_shared<HeldSurface>(own ? read_own(receiver, files.file, head)
                                                  : read_surveyed(receiver, files, head));
    if (held->mesh.triangles.empty())
        throw Failure(files.file.name, "the surface has no triangles",
                      "Make it again with more runs over the course");
    set_plan(*held);
    require_near(*held, files.file);
    const std::int64_t turned = settle_triangles(*held, files.file);
    const SurfaceFound unread = head.found;
    head.found = measure(*held);
    head.found.turned = turned;
    head.found.invisible = unread.invisible;
    head.found.unused = unread.unused;
    head.receiver = receiver.id;
    head.georeferenced = !held->places.empty();
    head.vertical_sd_m =
        stated.vertical_sd.value_or(own ? head.vertical_sd_m : usual_vertical_sd_m);
    head.source = stated.source;
    head.notes.clear();
    if (!stated.vertical_sd && !own)
        head.notes.push_back(fmt::format(
            "The attempt does not state the standard deviation of the surveyed heights; {} m is "
            "taken.",
            format_fixed(usual_vertical_sd_m, 2)));
    note_findings(head);
    result.give = [held](const TakeRow& take) { give_rows(*held, take); };
    return result;
}

void require_of_another_run(const Receiver& receiver, const SurfaceTable& surface,
                            const std::vector<std::string>& recordings, bool georeferenced) {
    for (const SurfaceRun& run : surface.made_from)
        for (const std::string& recording : run.recordings)
            if (std::ranges::count(recordings, recording) > 0)
                throw Failure(receiver.surface->place,
                              fmt::format("the surface was made from this recording itself (run "
                                          "{}), and cannot check it",
                                          escape_for_message(run.id)),
                              "Make it of other runs over the course: runcert surface RUN... "
                              "--out FILE");
    if (surface.georeferenced && !georeferenced)
        throw Failure(receiver.surface->place,
                      "the surface lies on the Earth, and the recording in an engineering CRS",
                      "Give the surface in the recording's CRS, with frame: local_plane");
}

}  // namespace runcert::surface
