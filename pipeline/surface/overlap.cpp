#include <algorithm>
#include <limits>

#include "surface/triangulation.h"

namespace runcert {
namespace {

/// What surveyors' coordinates are rounded to: neighbours that do not share their vertices lie over
/// one another by so much.
constexpr double rounding_m = 1e-3;

using PlanCorners = std::array<Eigen::Vector2d, 3>;

PlanCorners plan_corners(const SurfaceMesh& mesh, std::size_t triangle) {
    PlanCorners plan;
    for (std::size_t i = 0; i < 3; ++i)
        plan[i] = mesh.vertices[mesh.triangles[triangle][i]].head<2>();
    return plan;
}

/// How far a triangle's corners lie, at most, on the inner side of another's edge (m): beyond
/// `rounding_m` inside.
double depth_inside(const PlanCorners& of, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d along = (to - from).normalized();
    double deepest = -std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& corner : of) {
        const Eigen::Vector2d offset = corner - from;
        deepest = std::max(deepest, along.x() * offset.y() - along.y() * offset.x());
    }
    return deepest;
}

/// Two convex figures are apart if and only if an edge of one of them has the other beyond it.
bool an_edge_parts(const PlanCorners& one, const PlanCorners& other) {
    for (std::size_t i = 0; i < 3; ++i)
        if (depth_inside(other, one[i], one[(i + 1) % 3]) <= rounding_m) return true;
    return false;
}

bool are_the_same(const Corners& one, const Corners& other) {
    int shared = 0;
    for (const std::uint32_t corner : one)
        shared += static_cast<int>(std::ranges::count(other, corner));
    return shared == 3;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> overlapping_triangles(const SurfaceMesh& mesh) {
    const PlanGrid grid(mesh);
    std::optional<std::pair<std::size_t, std::size_t>> first;
    for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
        const auto here = grid.in_cell(cell);
        for (std::size_t i = 0; i < here.size(); ++i) {
            if (first && here[i] > first->first) break;
            const PlanCorners one = plan_corners(mesh, here[i]);
            for (std::size_t k = i + 1; k < here.size(); ++k) {
                const std::pair<std::size_t, std::size_t> pair(here[i], here[k]);
                if (first && pair >= *first) break;
                const PlanCorners other = plan_corners(mesh, here[k]);
                if (are_the_same(mesh.triangles[here[i]], mesh.triangles[here[k]]) ||
                    (!an_edge_parts(one, other) && !an_edge_parts(other, one))) {
                    first = pair;
                    break;
                }
            }
        }
    }
    return first;
}

}  // namespace runcert
