#include "stages/import/surface/raw.h"

#include <fmt/format.h>

#include "core/failure.h"

namespace runcert::surface {
namespace {

void require_room(std::size_t count, const SourceLine& line, const RecordingBytes& file) {
    if (count < most_elements) return;
    throw Failure(place_in(file, line),
                  fmt::format("the surface has more than {} vertices or triangles", most_elements),
                  "Export the course alone, or fewer points: triangles of some metres suffice");
}

}  // namespace

void RawSurface::add_vertex(const Eigen::Vector3d& vertex, const SourceLine& line,
                            const RecordingBytes& file) {
    require_room(mesh.vertices.size(), line, file);
    mesh.vertices.push_back(vertex);
    vertex_lines.push_back(line.number);
}

void RawSurface::add_triangle(const Corners& corners, const SourceLine& line,
                              const RecordingBytes& file) {
    require_room(mesh.triangles.size(), line, file);
    mesh.triangles.push_back(corners);
    triangle_lines.push_back(line.number);
}

void VertexNumbers::add(std::int64_t number, std::uint32_t vertex, const std::string& place) {
    if (!vertices_.emplace(number, vertex).second)
        throw Failure(place, fmt::format("two vertices have the number {}", number),
                      "Give each vertex a number of its own");
}

std::uint32_t VertexNumbers::of(std::int64_t number, const std::string& place) const {
    const auto found = vertices_.find(number);
    if (found == vertices_.end())
        throw Failure(place,
                      fmt::format("the triangle names vertex {}, which there is not", number),
                      "Export the surface whole, with all its vertices");
    return found->second;
}

}  // namespace runcert::surface
