// The readers of surfaces: LandXML, what runcert surface wrote, and two tables, which stand in one
// input with an empty line between them.

#include <cmath>

#include "core/failure.h"
#include "fuzz_target.h"
#include "stages/import/surface/surface.h"

namespace runcert::fuzz {
namespace {

Receiver receiver_for(std::string_view bytes) {
    Receiver receiver;
    receiver.id = "primary";
    Surface& stated = receiver.surface.emplace();
    stated.file = "surface";
    stated.place = "attempt.yaml:7:9";
    stated.source = "a survey";
    if (bytes.starts_with("# %ECSV")) return receiver;
    if (bytes.find("<LandXML") == std::string_view::npos) stated.unit = "m";
    const bool on_earth = bytes.size() % 3 == 0;
    stated.frame =
        StatedFrame{.kind = on_earth ? CoordinateFrame::geodetic : CoordinateFrame::local_plane};
    if (on_earth) stated.heights = SurfaceHeights::ellipsoid;
    return receiver;
}

void check_rows(const surface::StreamedSurface& streamed) {
    std::int64_t vertices = 0, triangles = 0;
    streamed.give([&](const SurfaceRow& row) {
        if (row.element == SurfaceElement::vertex) {
            require(triangles == 0 && row.number == ++vertices, "vertices come first, in order");
            const bool whole = streamed.head.georeferenced
                                   ? row.latitude_deg && row.longitude_deg && row.height_m
                                   : row.east_m && row.north_m && row.up_m;
            require(whole, "a vertex has a place");
            return;
        }
        require(row.number == ++triangles, "triangles are in order");
        for (const auto& corner : {row.corner_1, row.corner_2, row.corner_3})
            require(corner && *corner >= 1 && *corner <= vertices, "corners are vertices");
    });
    require(vertices == streamed.head.found.vertices, "as many vertices as are said");
    require(triangles == streamed.head.found.triangles && triangles > 0,
            "as many triangles as are said");
    require(std::isfinite(streamed.head.found.area_m2) && streamed.head.found.area_m2 > 0.0,
            "triangles face upwards");
}

}  // namespace

void read_input(std::string_view bytes) {
    surface::SurfaceFiles files{.file = {.name = "surface", .bytes = bytes}};
    if (const std::size_t between = bytes.find("\n\nvertex_1"); between != std::string_view::npos) {
        files.file.bytes = bytes.substr(0, between + 1);
        files.triangles = RecordingBytes{.name = "triangles", .bytes = bytes.substr(between + 2)};
    }
    try {
        (void)surface::recognise(files.file);
    } catch (const Failure&) {
        // Import may still read it as the attempt says.
    }
    check_rows(surface::import_surface(receiver_for(bytes), files));
}

}  // namespace runcert::fuzz
