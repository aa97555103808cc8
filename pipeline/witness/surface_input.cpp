#include "witness/surface_input.h"

#include "core/failure.h"

namespace runcert {
namespace {

constexpr const char* remake = "Make the run again with runcert certify";

Eigen::Vector3d vertex_of(const SurfaceRow& row, const std::optional<LocalFrame>& frame) {
    if (!frame)
        return {row.east_m.value_or(0.0), row.north_m.value_or(0.0), row.up_m.value_or(0.0)};
    return frame
        ->enu_from_geodetic({.latitude = Angle::from_degrees(row.latitude_deg.value_or(0.0)),
                             .longitude = Angle::from_degrees(row.longitude_deg.value_or(0.0)),
                             .height_m = row.height_m.value_or(0.0)})
        .m;
}

}  // namespace

Triangulation surface_of(const SurfaceTable& table, const std::optional<FrameOrigin>& origin) {
    std::optional<LocalFrame> frame;
    if (table.georeferenced) {
        if (!origin)
            throw Failure("1-surface", "the surface lies on the Earth, and the run does not",
                          remake);
        frame.emplace(origin->position);
    }
    SurfaceMesh mesh;
    for (const SurfaceRow& row : table.rows) {
        if (row.element == SurfaceElement::vertex) {
            mesh.vertices.push_back(vertex_of(row, frame));
            continue;
        }
        Corners corners{};
        const OptionalInteger each[] = {row.corner_1, row.corner_2, row.corner_3};
        for (std::size_t i = 0; i < 3; ++i) {
            if (!each[i] || *each[i] < 1 || *each[i] > std::ssize(mesh.vertices))
                throw Failure("1-surface", "a triangle names a vertex that there is not", remake);
            corners[i] = static_cast<std::uint32_t>(*each[i] - 1);
        }
        mesh.triangles.push_back(corners);
    }
    return Triangulation(std::move(mesh));
}

Eigen::Vector3d in_frame_of_origin(const std::optional<FrameOrigin>& origin, ElapsedTime time,
                                   const Eigen::Vector3d& enu_m) {
    if (!origin || origin->number_at(time) == 0) return enu_m;
    return LocalFrame(origin->position).enu_from_ecef(PlaceFrames(*origin).ecef(time, enu_m)).m;
}

}  // namespace runcert
