#include "surface/triangulation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/failure.h"

namespace runcert {
namespace {

/// The least a barycentric coordinate may be: a point on an edge is in both triangles.
constexpr double least_weight = -1e-9;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

Eigen::Vector2d plan_of(const SurfaceMesh& mesh, std::uint32_t vertex) {
    return mesh.vertices[vertex].head<2>();
}

/// A bounding box of a grid's cells, both ends included.
struct CellRange {
    Eigen::Index first_column, last_column, first_row, last_row;

    std::size_t count() const {
        return static_cast<std::size_t>((last_column - first_column + 1) *
                                        (last_row - first_row + 1));
    }
};

CellRange cells_of(const SurfaceMesh& mesh, const Corners& corners, const Eigen::Vector2d& least,
                   double cell_m) {
    Eigen::Vector2d low = plan_of(mesh, corners[0]), high = low;
    for (const std::uint32_t corner : corners) {
        low = low.cwiseMin(plan_of(mesh, corner));
        high = high.cwiseMax(plan_of(mesh, corner));
    }
    const auto index = [&](double value, double from) {
        return static_cast<Eigen::Index>(std::floor((value - from) / cell_m));
    };
    return {index(low.x(), least.x()), index(high.x(), least.x()), index(low.y(), least.y()),
            index(high.y(), least.y())};
}

}  // namespace

double twice_area_in_plan(const SurfaceMesh& mesh, const Corners& corners) {
    const Eigen::Vector2d at = plan_of(mesh, corners[0]);
    return cross(plan_of(mesh, corners[1]) - at, plan_of(mesh, corners[2]) - at);
}

bool is_degenerate(const SurfaceMesh& mesh, const Corners& corners) {
    constexpr double least_height_m = 1e-6;
    double longest_m = 0.0;
    for (std::size_t i = 0; i < 3; ++i)
        longest_m = std::max(
            longest_m, (plan_of(mesh, corners[(i + 1) % 3]) - plan_of(mesh, corners[i])).norm());
    return std::abs(twice_area_in_plan(mesh, corners)) <= least_height_m * longest_m;
}

double median_edge_m(const SurfaceMesh& mesh) {
    std::vector<double> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Corners& corners : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            edges.push_back(
                (plan_of(mesh, corners[(i + 1) % 3]) - plan_of(mesh, corners[i])).norm());
    if (edges.empty()) return 0.0;
    const auto middle = edges.begin() + std::ssize(edges) / 2;
    std::ranges::nth_element(edges, middle);
    return *middle;
}

PlanGrid::PlanGrid(const SurfaceMesh& mesh) {
    if (mesh.triangles.empty()) return;
    least_ = plan_of(mesh, mesh.triangles.front()[0]);
    Eigen::Vector2d most = least_;
    for (const Corners& corners : mesh.triangles)
        for (const std::uint32_t corner : corners) {
            least_ = least_.cwiseMin(plan_of(mesh, corner));
            most = most.cwiseMax(plan_of(mesh, corner));
        }
    const double count = static_cast<double>(mesh.triangles.size());
    const Eigen::Vector2d extent = most - least_;
    constexpr double widest_m = 1e9;
    if (!(extent.maxCoeff() < widest_m))
        throw Failure("surface", "its vertices are farther apart than any on the Earth",
                      "Correct its unit or frame");
    // Not many more cells than triangles, however far apart these lie.
    cell_m_ = std::max({median_edge_m(mesh), std::sqrt(extent.x() * extent.y() / (4.0 * count)),
                        extent.maxCoeff() / (4.0 * count + 64.0)});
    const auto entries = [&] {
        std::size_t total = 0;
        for (const Corners& corners : mesh.triangles)
            total += cells_of(mesh, corners, least_, cell_m_).count();
        return total;
    };
    while (entries() > 32 * mesh.triangles.size() + 1024)
        cell_m_ *= 2.0;
    columns_ = static_cast<Eigen::Index>(std::floor(extent.x() / cell_m_)) + 1;
    rows_ = static_cast<Eigen::Index>(std::floor(extent.y() / cell_m_)) + 1;
    const auto for_each_cell = [&](const auto& take) {
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const CellRange range = cells_of(mesh, mesh.triangles[t], least_, cell_m_);
            for (Eigen::Index row = range.first_row; row <= range.last_row; ++row)
                for (Eigen::Index column = range.first_column; column <= range.last_column;
                     ++column)
                    take(static_cast<std::size_t>(row * columns_ + column), t);
        }
    };
    begin_.assign(static_cast<std::size_t>(rows_ * columns_) + 1, 0);
    for_each_cell([&](std::size_t cell, std::size_t) { ++begin_[cell + 1]; });
    for (std::size_t cell = 1; cell < begin_.size(); ++cell)
        begin_[cell] += begin_[cell - 1];
    triangles_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for_each_cell([&](std::size_t cell, std::size_t triangle) {
        triangles_[next[cell]++] = static_cast<std::uint32_t>(triangle);
    });
}

std::optional<std::size_t> PlanGrid::cell_of(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d place = (point - least_) / cell_m_;
    // Points on the rim are in: the last cell ends beyond the last vertex, and the first begins at
    // the first one, which rounding may miss.
    constexpr double rounding = 1e-9;
    if (!(place.x() >= -rounding && place.y() >= -rounding &&
          place.x() < static_cast<double>(columns_) && place.y() < static_cast<double>(rows_)))
        return std::nullopt;
    const auto index = [](double value) {
        return static_cast<Eigen::Index>(std::floor(std::max(0.0, value)));
    };
    return static_cast<std::size_t>(index(place.y()) * columns_ + index(place.x()));
}

Triangulation::Triangulation(SurfaceMesh mesh) : mesh_(std::move(mesh)), grid_(mesh_) {}

std::optional<GroundPoint> Triangulation::at(const Eigen::Vector2d& place) const {
    const auto cell = grid_.cell_of(place);
    if (!cell) return std::nullopt;
    for (const std::uint32_t t : grid_.in_cell(*cell)) {
        const Corners& corners = mesh_.triangles[t];
        const Eigen::Vector2d a = plan_of(mesh_, corners[0]) - place;
        const Eigen::Vector2d b = plan_of(mesh_, corners[1]) - place;
        const Eigen::Vector2d c = plan_of(mesh_, corners[2]) - place;
        const Eigen::Vector3d areas(cross(b, c), cross(c, a), cross(a, b));
        const Eigen::Vector3d weights = areas / areas.sum();
        if (weights.minCoeff() < least_weight) continue;
        double up_m = 0.0;
        for (std::size_t i = 0; i < 3; ++i)
            up_m += weights[static_cast<Eigen::Index>(i)] * mesh_.vertices[corners[i]].z();
        return GroundPoint{.triangle = t, .weights = weights, .up_m = up_m, .normal = normal_of(t)};
    }
    return std::nullopt;
}

Eigen::Vector3d Triangulation::normal_of(std::size_t triangle) const {
    const Corners& corners = mesh_.triangles[triangle];
    const Eigen::Vector3d at = mesh_.vertices[corners[0]];
    return (mesh_.vertices[corners[1]] - at).cross(mesh_.vertices[corners[2]] - at).normalized();
}

std::optional<double> Triangulation::normal_distance_m(const Eigen::Vector3d& point) const {
    const auto ground = at(point.head<2>());
    if (!ground) return std::nullopt;
    return ground->normal.z() * (point.z() - ground->up_m);
}

}  // namespace runcert
