#include "stages/screen/surface_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/angle.h"
#include "core/failure.h"
#include "core/statistics.h"
#include "core/text.h"
#include "schemas/observations/stated_covariance.h"
#include "witness/surface_input.h"

namespace runcert {
namespace {

/// Of the whole surface: heights beyond it contradict, and a median beyond it is taken off.
constexpr double contradicted_sigmas = 3.29;  // two-sided 0.001
constexpr double datum_error_m = 3.0;
constexpr double sigma_of_median = 1.4826;

/// An epoch over the surface: how far its antenna is from where the surface has it.
struct HeightAbove {
    ScreenedEpoch* row = nullptr;
    double distance_m = 0.0, sigma_m = 0.0;
    double normal_up = 1.0;
};

struct HeightsAbove {
    std::vector<HeightAbove> over;
    std::vector<Eigen::Vector2d> outside;
};

HeightsAbove heights_above(ScreenedTable& screened, const GroundBelow& ground) {
    const double lowered_m = ground.antenna_height_m *
                             (1.0 - std::cos(Angle::from_degrees(ground.tilt_max_deg).radians()));
    HeightsAbove found;
    for (ScreenedEpoch& row : screened.rows) {
        if (!row.usable || !row.east_m || !row.north_m || !row.up_m) continue;
        const Eigen::Vector3d position =
            in_frame_of_origin(screened.origin, row.time, {*row.east_m, *row.north_m, *row.up_m});
        const auto below = ground.surface.at(position.head<2>());
        if (!below) {
            found.outside.emplace_back(position.head<2>());
            continue;
        }
        const Eigen::Vector3d& normal = below->normal;
        const double variance = normal.dot(stated_covariance<3>(row) * normal);
        const double white = std::sqrt(ground.vertical_sd_m * ground.vertical_sd_m +
                                       screened.variance_factor * std::max(0.0, variance));
        found.over.push_back(
            {.row = &row,
             .distance_m = normal.z() * (position.z() - below->up_m) - ground.antenna_height_m,
             .sigma_m = white + lowered_m,
             .normal_up = normal.z()});
    }
    return found;
}

[[noreturn]] void refuse_elsewhere(const HeightsAbove& found, const GroundBelow& ground) {
    double nearest_m = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& vertex : ground.surface.mesh().vertices)
        nearest_m = std::min(nearest_m, (vertex.head<2>() - found.outside.front()).norm());
    throw Failure(ground.place,
                  fmt::format("none of the {} usable positions lies over the surface: its nearest "
                              "vertex is {} from the first of them",
                              found.outside.size(),
                              nearest_m < 1000.0 ? format_fixed(nearest_m, 0) + " m"
                                                 : format_fixed(nearest_m * 1e-3, 1) + " km"),
                  "Correct surface: frame, axes, unit or file; or the attempt's origin, where the "
                  "surface is counted from it");
}

double median_of(const std::vector<HeightAbove>& over, double HeightAbove::*figure) {
    std::vector<double> values;
    for (const HeightAbove& one : over)
        values.push_back(one.*figure);
    return median(std::move(values));
}

double scatter_about(const std::vector<HeightAbove>& over, double offset_m) {
    std::vector<double> sizes;
    for (const HeightAbove& one : over)
        sizes.push_back(std::abs(one.distance_m - offset_m));
    return sigma_of_median * median(std::move(sizes));
}

/// `up_m`: the median, upwards.
void refuse_other_datum(const SurfaceComparison& found, double up_m, const GroundBelow& ground) {
    if (std::abs(up_m) < datum_error_m) return;
    const std::string moved =
        fmt::format("{} m {} where the surface has it, in the median",
                    format_fixed(std::abs(up_m), 2), up_m > 0.0 ? "above" : "below");
    if (found.scatter_m > 0.2 * std::abs(up_m))
        throw Failure(ground.place,
                      fmt::format("the antenna is {}, and that scatters by {} m: it is not the "
                                  "surface that the craft ran on",
                                  moved, format_fixed(found.scatter_m, 2)),
                      "Correct surface: file, frame, axes or unit");
    throw Failure(ground.place,
                  fmt::format("the antenna is {}, everywhere alike (scatter {} m): heights above "
                              "the geoid are taken for ellipsoidal ones",
                              moved, format_fixed(found.scatter_m, 2)),
                  fmt::format("If the surface's are, write heights: geoid and undulation_m: {}, "
                              "after a geoid model says so; if the recording's are, hand in one "
                              "with ellipsoidal heights. A local frame needs its origin's height",
                              format_fixed(ground.undulation_m + up_m, 2)));
}

/// A surface that most heights contradict says nothing of single ones.
void refuse_misfit(const HeightsAbove& heights, const SurfaceComparison& found, double removed_m,
                   const GroundBelow& ground) {
    const auto contradicted = std::ranges::count_if(heights.over, [&](const HeightAbove& one) {
        return std::abs(one.distance_m - removed_m) > contradicted_sigmas * one.sigma_m;
    });
    if (2 * contradicted <= found.compared) return;
    throw Failure(ground.place,
                  fmt::format("{} of {} heights contradict the surface, by a scatter of {} m: it "
                              "is not the one that the craft ran on",
                              contradicted, found.compared, format_fixed(found.scatter_m, 2)),
                  "Correct surface: file, frame, axes, unit or vertical_sd_m; or the recording's "
                  "stated standard deviations");
}

void mark(const HeightAbove& one, double rest_m, double threshold) {
    ScreenedEpoch& row = *one.row;
    row.usable = false;
    row.reason = Reason::surface;
    row.hypothesis = Hypothesis::surface;
    row.tested_axes = TestedAxes::vertical;
    row.statistic = std::abs(rest_m) / one.sigma_m;
    row.threshold = threshold;
    row.estimated = {};
    row.estimated.up_m = rest_m / one.normal_up;
    row.estimated.sigma_up_m = one.sigma_m / one.normal_up;
}

}  // namespace

std::optional<SurfaceComparison> check_surface(ScreenedTable& screened, const GroundBelow& ground,
                                               const TestPlan& plan) {
    const HeightsAbove heights = heights_above(screened, ground);
    if (heights.over.empty()) {
        if (!heights.outside.empty()) refuse_elsewhere(heights, ground);
        return std::nullopt;
    }
    SurfaceComparison found{.compared = std::ssize(heights.over),
                            .outside = std::ssize(heights.outside),
                            .antenna_height_m = ground.antenna_height_m,
                            .offset_m = median_of(heights.over, &HeightAbove::distance_m),
                            .sigma_offset_m = median_of(heights.over, &HeightAbove::sigma_m)};
    found.scatter_m = scatter_about(heights.over, found.offset_m);
    found.detectable_m = std::sqrt(plan.noncentrality(1)) * found.sigma_offset_m;
    refuse_other_datum(found, found.offset_m / median_of(heights.over, &HeightAbove::normal_up),
                       ground);
    found.offset_removed = std::abs(found.offset_m) > contradicted_sigmas * found.sigma_offset_m;
    const double removed_m = found.offset_removed ? found.offset_m : 0.0;
    refuse_misfit(heights, found, removed_m, ground);
    const double threshold = std::sqrt(plan.critical(1));
    for (const HeightAbove& one : heights.over) {
        const double rest_m = one.distance_m - removed_m;
        if (std::abs(rest_m) <= threshold * one.sigma_m) continue;
        mark(one, rest_m, threshold);
        ++found.rejected;
    }
    return found;
}

}  // namespace runcert
