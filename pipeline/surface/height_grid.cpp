#include "surface/height_grid.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert {
namespace {

/// A direction without a sense, as a vector of twice its angle: opposite ones add up.
Eigen::Vector2d doubled(const Eigen::Vector2d& direction) {
    const Eigen::Vector2d unit = direction.normalized();
    return {unit.x() * unit.x() - unit.y() * unit.y(), 2.0 * unit.x() * unit.y()};
}

Eigen::Vector2d halved(const Eigen::Vector2d& twice) {
    const double angle = 0.5 * std::atan2(twice.y(), twice.x());
    return {std::cos(angle), std::sin(angle)};
}

/// How far a position tells of the ground: along the course and to either side of it.
constexpr double reach_m = 10.0, reach_across_m = 15.0;

/// The places of a grid's vertices and which of them are in use: those within `reach_m` of the cell
/// of a position, along both axes.
class GridPlan {
  public:
    GridPlan(std::span<const AntennaPosition> positions, double spacing_m) : spacing_m_(spacing_m) {
        Eigen::Vector2d mean = Eigen::Vector2d::Zero();
        for (const AntennaPosition& position : positions)
            mean += doubled(position.direction);
        const Eigen::Vector2d along = halved(mean);
        grid_from_plan_ << along.x(), along.y(), -along.y(), along.x();
        Eigen::Vector2d most = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
        least_ = -most;
        for (const AntennaPosition& position : positions) {
            const Eigen::Vector2d place = grid_from_plan_ * position.enu_m.head<2>();
            least_ = least_.cwiseMin(place);
            most = most.cwiseMax(place);
        }
        const auto reach = static_cast<Eigen::Index>(std::ceil(reach_m / spacing_m));
        // A margin holds the cells around, and positions that the antenna's height moves.
        const double margin = static_cast<double>(reach) + 2.0;
        least_.array() -= margin * spacing_m;
        const Eigen::Vector2d size = (most - least_) / spacing_m;
        constexpr double most_vertices = 4e6;
        if (!((size.x() + margin) * (size.y() + margin) < most_vertices))
            throw Failure("surface",
                          fmt::format("the positions lie over {:.0f} m by {:.0f} m",
                                      size.x() * spacing_m, size.y() * spacing_m),
                          "Give runs over one course, or name those parts of them that are");
        columns_ = static_cast<Eigen::Index>(size.x() + margin) + 1;
        rows_ = static_cast<Eigen::Index>(size.y() + margin) + 1;
        number_.assign(static_cast<std::size_t>(columns_ * rows_), -1);
        std::vector<Eigen::Vector2d> travel(number_.size(), Eigen::Vector2d::Zero());
        for (const AntennaPosition& position : positions) {
            const auto [column, row] = cell_of(position.enu_m.head<2>());
            for (Eigen::Index r = row - reach; r <= row + 1 + reach; ++r)
                for (Eigen::Index c = column - reach; c <= column + 1 + reach; ++c) {
                    number_[at(c, r)] = 0;
                    travel[at(c, r)] += doubled(grid_from_plan_ * position.direction);
                }
        }
        for (std::size_t i = 0; i < number_.size(); ++i) {
            if (number_[i] < 0) continue;
            number_[i] = static_cast<std::int64_t>(travel_.size());
            travel_.push_back(halved(travel[i]));
        }
    }

    double spacing_m() const { return spacing_m_; }
    Eigen::Index columns() const { return columns_; }
    Eigen::Index rows() const { return rows_; }
    std::size_t count() const { return travel_.size(); }

    /// The number of a vertex in use, or -1.
    std::int64_t number(Eigen::Index column, Eigen::Index row) const {
        if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return -1;
        return number_[at(column, row)];
    }
    /// Direction of travel there, in the grid's axes.
    const Eigen::Vector2d& travel(std::int64_t number) const {
        return travel_[static_cast<std::size_t>(number)];
    }
    std::pair<Eigen::Index, Eigen::Index> cell_of(const Eigen::Vector2d& place) const {
        const Eigen::Vector2d cell = in_cells(place);
        return {static_cast<Eigen::Index>(std::floor(cell.x())),
                static_cast<Eigen::Index>(std::floor(cell.y()))};
    }
    Eigen::Vector2d in_cells(const Eigen::Vector2d& place) const {
        return (grid_from_plan_ * place - least_) / spacing_m_;
    }
    Eigen::Vector2d plan_of(Eigen::Index column, Eigen::Index row) const {
        const Eigen::Vector2d offset(static_cast<double>(column), static_cast<double>(row));
        return grid_from_plan_.transpose() * (least_ + spacing_m_ * offset);
    }

  private:
    std::size_t at(Eigen::Index column, Eigen::Index row) const {
        return static_cast<std::size_t>(row * columns_ + column);
    }

    double spacing_m_;
    Eigen::Matrix2d grid_from_plan_;
    Eigen::Vector2d least_;
    Eigen::Index columns_ = 0, rows_ = 0;
    std::vector<std::int64_t> number_;
    std::vector<Eigen::Vector2d> travel_;
};

/// The vertices of the triangle of a cell's half that holds a place, and its weights. The diagonal
/// goes from the cell's first corner to the opposite one.
struct Weighted {
    std::array<std::int64_t, 3> vertices;
    Eigen::Vector3d weights;
};

Weighted weighted_at(const GridPlan& plan, const Eigen::Vector2d& place) {
    const auto [column, row] = plan.cell_of(place);
    const Eigen::Vector2d cell = plan.in_cells(place);
    const double x = cell.x() - static_cast<double>(column);
    const double y = cell.y() - static_cast<double>(row);
    const std::int64_t corner = plan.number(column, row),
                       opposite = plan.number(column + 1, row + 1);
    if (x >= y) return {{corner, plan.number(column + 1, row), opposite}, {1.0 - x, x - y, y}};
    return {{corner, opposite, plan.number(column, row + 1)}, {1.0 - y, x, y - x}};
}

/// The normal equations of the heights.
class HeightEquations {
  public:
    explicit HeightEquations(std::size_t count)
        : right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count))) {}

    void add(const Weighted& row, double value, double sigma) {
        for (std::size_t i = 0; i < 3; ++i) {
            const double weight = row.weights[static_cast<Eigen::Index>(i)] / (sigma * sigma);
            right_[static_cast<Eigen::Index>(row.vertices[i])] += weight * value;
            for (std::size_t k = 0; k < 3; ++k)
                entries_.emplace_back(row.vertices[i], row.vertices[k],
                                      weight * row.weights[static_cast<Eigen::Index>(k)]);
        }
    }

    Eigen::VectorXd solve() {
        Eigen::SparseMatrix<double> left(right_.size(), right_.size());
        left.setFromTriplets(entries_.begin(), entries_.end());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(left);
        if (solver.info() != Eigen::Success)
            throw Failure("surface", "the heights of the ground cannot be solved for",
                          "Give more runs over the course");
        return solver.solve(right_);
    }

  private:
    Eigen::VectorXd right_;
    std::vector<Eigen::Triplet<double>> entries_;
};

void add_bends(const GridPlan& plan, const HeightGridSettings& settings,
               HeightEquations& equations) {
    // What no second difference reaches stays near the others.
    constexpr double bound_m = 1000.0;
    constexpr double stated_at_m = 10.0;
    const double scale = std::pow(settings.spacing_m / stated_at_m, 1.5);
    for (Eigen::Index row = 0; row < plan.rows(); ++row)
        for (Eigen::Index column = 0; column < plan.columns(); ++column) {
            const std::int64_t here = plan.number(column, row);
            if (here < 0) continue;
            equations.add({{here, here, here}, {1.0, 0.0, 0.0}}, 0.0, bound_m);
            const Eigen::Vector2d travel = plan.travel(here);
            const auto bend = [&](Eigen::Index c, Eigen::Index r, double along, double across) {
                const std::int64_t before = plan.number(column - c, row - r);
                const std::int64_t after = plan.number(column + c, row + r);
                if (before < 0 || after < 0) return;
                equations.add({{before, here, after}, {1.0, -2.0, 1.0}}, 0.0,
                              scale * std::hypot(along * settings.bend_along_m,
                                                 across * settings.bend_across_m));
            };
            bend(1, 0, travel.x(), travel.y());
            bend(0, 1, travel.y(), travel.x());
        }
}

/// Where the ground is under each position: below it along the normal of a fit, or straight down.
std::vector<Eigen::Vector3d> ground_under(std::span<const AntennaPosition> positions,
                                          const Triangulation* fit) {
    std::vector<Eigen::Vector3d> ground;
    for (const AntennaPosition& position : positions) {
        const auto point = fit ? fit->at(position.enu_m.head<2>()) : std::nullopt;
        ground.push_back(position.enu_m - position.antenna_height_m *
                                              (point ? point->normal : Eigen::Vector3d::UnitZ()));
    }
    return ground;
}

Eigen::VectorXd solve_heights(const GridPlan& plan, std::span<const AntennaPosition> positions,
                              std::span<const Eigen::Vector3d> ground, double mean_m,
                              const HeightGridSettings& settings) {
    HeightEquations equations(plan.count());
    for (std::size_t i = 0; i < ground.size(); ++i)
        equations.add(weighted_at(plan, ground[i].head<2>()), ground[i].z() - mean_m,
                      positions[i].sigma_up_m);
    add_bends(plan, settings, equations);
    return equations.solve().array() + mean_m;
}

SurfaceMesh mesh_of(const GridPlan& plan, const Eigen::VectorXd& heights) {
    SurfaceMesh mesh;
    mesh.vertices.resize(plan.count());
    for (Eigen::Index row = 0; row < plan.rows(); ++row)
        for (Eigen::Index column = 0; column < plan.columns(); ++column) {
            const std::int64_t corner = plan.number(column, row);
            if (corner < 0) continue;
            mesh.vertices[static_cast<std::size_t>(corner)] << plan.plan_of(column, row),
                heights[static_cast<Eigen::Index>(corner)];
            const std::int64_t right = plan.number(column + 1, row),
                               opposite = plan.number(column + 1, row + 1),
                               above = plan.number(column, row + 1);
            const auto add = [&](std::int64_t second, std::int64_t third) {
                if (second >= 0 && third >= 0)
                    mesh.triangles.push_back({static_cast<std::uint32_t>(corner),
                                              static_cast<std::uint32_t>(second),
                                              static_cast<std::uint32_t>(third)});
            };
            add(right, opposite);
            add(opposite, above);
        }
    return mesh;
}

/// The places of the positions, by cell.
class PlacesByCell {
  public:
    PlacesByCell(const GridPlan& plan, std::span<const Eigen::Vector3d> ground)
        : plan_(plan), begin_(static_cast<std::size_t>(plan.columns() * plan.rows()) + 1, 0) {
        for (const Eigen::Vector3d& point : ground)
            ++begin_[cell(point) + 1];
        for (std::size_t i = 1; i < begin_.size(); ++i)
            begin_[i] += begin_[i - 1];
        places_.resize(ground.size());
        std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
        for (const Eigen::Vector3d& point : ground)
            places_[next[cell(point)]++] = plan_.in_cells(point.head<2>());
    }

    /// Whether there are places on both sides of one (in cells), across a direction.
    bool on_both_sides(const Eigen::Vector2d& of, const Eigen::Vector2d& travel) const {
        const double along_cells = reach_m / plan_.spacing_m(),
                     across_cells = reach_across_m / plan_.spacing_m();
        const auto around =
            static_cast<Eigen::Index>(std::ceil(std::max(along_cells, across_cells)));
        bool left = false, right = false;
        const auto column = static_cast<Eigen::Index>(of.x()),
                   row = static_cast<Eigen::Index>(of.y());
        for (Eigen::Index r = std::max<Eigen::Index>(0, row - around);
             r <= std::min(plan_.rows() - 1, row + around); ++r)
            for (Eigen::Index c = std::max<Eigen::Index>(0, column - around);
                 c <= std::min(plan_.columns() - 1, column + around); ++c) {
                const auto here = static_cast<std::size_t>(r * plan_.columns() + c);
                for (std::size_t i = begin_[here]; i < begin_[here + 1]; ++i) {
                    const Eigen::Vector2d offset = places_[i] - of;
                    const double across = travel.x() * offset.y() - travel.y() * offset.x();
                    if (std::abs(travel.dot(offset)) > along_cells ||
                        std::abs(across) > across_cells)
                        continue;
                    (across > 0.0 ? left : right) = true;
                }
            }
        return left && right;
    }

  private:
    std::size_t cell(const Eigen::Vector3d& point) const {
        const auto [column, row] = plan_.cell_of(point.head<2>());
        return static_cast<std::size_t>(row * plan_.columns() + column);
    }

    const GridPlan& plan_;
    std::vector<std::size_t> begin_;
    std::vector<Eigen::Vector2d> places_;
};

std::vector<bool> supported_triangles(const GridPlan& plan, const SurfaceMesh& mesh,
                                      std::span<const Eigen::Vector3d> ground) {
    const PlacesByCell places(plan, ground);
    std::vector<bool> supported;
    for (const Corners& corners : mesh.triangles) {
        Eigen::Vector2d centre = Eigen::Vector2d::Zero();
        for (const std::uint32_t corner : corners)
            centre += plan.in_cells(mesh.vertices[corner].head<2>()) / 3.0;
        supported.push_back(places.on_both_sides(centre, plan.travel(corners[0])));
    }
    return supported;
}

double residual_of(std::span<const Eigen::Vector3d> ground, const Triangulation& fit) {
    std::vector<double> sizes;
    for (const Eigen::Vector3d& point : ground)
        if (const auto below = fit.at(point.head<2>()))
            sizes.push_back(std::abs(point.z() - below->up_m));
    constexpr double sigma_of_median = 1.4826;
    return sigma_of_median * median(std::move(sizes));
}

}  // namespace

HeightGrid fit_height_grid(std::span<const AntennaPosition> positions,
                           const HeightGridSettings& settings) {
    constexpr std::size_t least_positions = 10;
    if (positions.size() < least_positions)
        throw Failure("surface", fmt::format("{} positions show no ground", positions.size()),
                      "Give runs with positions over the course");
    const GridPlan plan(positions, settings.spacing_m);
    double mean_m = 0.0;
    for (const AntennaPosition& position : positions)
        mean_m += position.enu_m.z() / static_cast<double>(positions.size());
    const auto fit = [&](const std::vector<Eigen::Vector3d>& ground) {
        return mesh_of(plan, solve_heights(plan, positions, ground, mean_m, settings));
    };
    const Triangulation first(fit(ground_under(positions, nullptr)));
    const std::vector<Eigen::Vector3d> ground = ground_under(positions, &first);
    const Triangulation second(fit(ground));
    return {.mesh = second.mesh(),
            .supported = supported_triangles(plan, second.mesh(), ground),
            .residual_m = residual_of(ground, second)};
}

SurfaceMesh supported_part(const HeightGrid& grid) {
    SurfaceMesh part;
    std::vector<std::int64_t> number(grid.mesh.vertices.size(), -1);
    for (std::size_t t = 0; t < grid.mesh.triangles.size(); ++t) {
        if (!grid.supported[t]) continue;
        Corners corners{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t vertex = grid.mesh.triangles[t][i];
            if (number[vertex] < 0) {
                number[vertex] = std::ssize(part.vertices);
                part.vertices.push_back(grid.mesh.vertices[vertex]);
            }
            corners[i] = static_cast<std::uint32_t>(number[vertex]);
        }
        part.triangles.push_back(corners);
    }
    return part;
}

}  // namespace runcert
