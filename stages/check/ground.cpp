#include "stages/check/ground.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geodesy.h"
#include "core/uncertainty.h"
#include "witness/surface_input.h"

namespace runcert {
namespace {

/// East, north and height of the ground below an estimate; nothing outside of the surface.
std::optional<Eigen::Vector3d> ground_below(const TrajectoryEpoch& row, const CourseGround& ground,
                                            const std::optional<FrameOrigin>& origin) {
    const Eigen::Vector3d antenna =
        in_frame_of_origin(origin, row.time, {*row.east_m, *row.north_m, row.up_m.value_or(0.0)});
    const auto point = ground.surface.at(antenna.head<2>());
    if (!point) return std::nullopt;
    const double fall_m = origin ? fall_below_plane_m(antenna.x(), antenna.y()) : 0.0;
    return Eigen::Vector3d(antenna.x(), antenna.y(), point->up_m + fall_m);
}

}  // namespace

std::optional<GroundFacts> ground_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                                        std::size_t window_first_row, std::size_t window_last_row,
                                        const CourseGround& ground,
                                        const std::optional<FrameOrigin>& origin) {
    double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
    std::optional<Eigen::Vector3d> first, last;
    for (std::size_t i = run.first_row; i <= run.last_row; ++i) {
        const TrajectoryEpoch& row = rows[i];
        if (!row.arc || !row.east_m || !row.north_m) continue;
        const auto below = ground_below(row, ground, origin);
        if (!below) return std::nullopt;
        low_m = std::min(low_m, below->z());
        high_m = std::max(high_m, below->z());
        if (i == window_first_row) first = below;
        if (i == window_last_row) last = below;
    }
    if (!first || !last) return std::nullopt;
    const double length_m = (*last - *first).head<2>().norm();
    if (length_m == 0.0) return std::nullopt;
    const double two_heights_m = usual_coverage_factor * std::numbers::sqrt2 * ground.vertical_sd_m;
    return GroundFacts{.height_difference_m = {high_m - low_m, two_heights_m},
                       .slope = {(last->z() - first->z()) / length_m, two_heights_m / length_m}};
}

}  // namespace runcert
