#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace runcert {

/// The numbers, from 0, of a triangle's vertices, counter-clockwise seen from above.
using Corners = std::array<std::uint32_t, 3>;

/// Triangles between vertices (east, north, up; m).
struct SurfaceMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<Corners> triangles;
};

/// Twice the area in plan (m^2) of a triangle; negative where its corners go clockwise seen from
/// above.
double twice_area_in_plan(const SurfaceMesh& mesh, const Corners& corners);

/// Whether a triangle has no area in plan, to a micrometre of its shortest height: two corners in
/// one place, three on a line, or a wall.
bool is_degenerate(const SurfaceMesh& mesh, const Corners& corners);

/// Median length (m) of the triangles' edges in plan; 0 where there are none.
double median_edge_m(const SurfaceMesh& mesh);

/// Where a vertical line meets the surface.
struct GroundPoint {
    std::size_t triangle = 0;
    Eigen::Vector3d weights = Eigen::Vector3d::Zero();  ///< barycentric, of the triangle's corners
    double up_m = 0.0;
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, upwards
};

/// The cells of a plan grid and the triangles whose bounding boxes touch each of them, in ascending
/// order. The cell is about the median edge, and larger where triangles of very different sizes
/// would else need many cells.
class PlanGrid {
  public:
    /// Failure (at "surface") where vertices are farther apart than a million kilometres.
    explicit PlanGrid(const SurfaceMesh& mesh);

    std::size_t cells() const { return begin_.empty() ? 0 : begin_.size() - 1; }
    std::span<const std::uint32_t> in_cell(std::size_t cell) const {
        return std::span(triangles_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
    }
    /// The cell of a point; nothing outside.
    std::optional<std::size_t> cell_of(const Eigen::Vector2d& point) const;

  private:
    Eigen::Vector2d least_ = Eigen::Vector2d::Zero();
    double cell_m_ = 1.0;
    Eigen::Index columns_ = 0, rows_ = 0;
    std::vector<std::size_t> begin_;
    std::vector<std::uint32_t> triangles_;
};

/// Two triangles that lie over the same ground by more than a millimetre in plan: the pair with the
/// smallest first number, then second; nothing where none do.
std::optional<std::pair<std::size_t, std::size_t>> overlapping_triangles(const SurfaceMesh& mesh);

/// A surface of triangles, for questions about points above or below it.
///
/// A triangle holds a point if its barycentric coordinates in plan are all at least -1e-9. On an
/// edge, or at a vertex, the triangle of the lowest number is taken.
class Triangulation {
  public:
    /// Every triangle counter-clockwise and with an area (`is_degenerate`), and none over another
    /// (`overlapping_triangles`): the caller has looked.
    explicit Triangulation(SurfaceMesh mesh);

    const SurfaceMesh& mesh() const { return mesh_; }

    /// The surface above or below a place (east, north; m); nothing outside, and in its holes.
    std::optional<GroundPoint> at(const Eigen::Vector2d& place) const;

    /// Unit normal, upwards, of a triangle.
    Eigen::Vector3d normal_of(std::size_t triangle) const;

    /// Distance (m) of a point from the plane of the triangle under or over it, along that
    /// triangle's normal, upwards positive; nothing outside.
    std::optional<double> normal_distance_m(const Eigen::Vector3d& point) const;

  private:
    SurfaceMesh mesh_;
    PlanGrid grid_;
};

}  // namespace runcert
