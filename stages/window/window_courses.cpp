#include "stages/window/window_courses.h"

#include <cmath>

#include "core/course_angle.h"
#include "schemas/common/rows_by_epoch.h"
#include "stages/window/craft_speeds.h"

namespace runcert {
namespace {

Eigen::Vector3d position_of(const TrajectoryEpoch& row) {
    return {*row.east_m, *row.north_m, row.up_m.value_or(0.0)};
}

std::optional<CourseDirections> course_between(const PlaceFrames& frames,
                                               const TrajectoryEpoch& first,
                                               const TrajectoryEpoch& last) {
    constexpr double least_m = 1.0;
    const Eigen::Vector3d from = position_of(first), to = position_of(last);
    const auto angles =
        course_angles(frames.geodetic(first.time, from), frames.geodetic(last.time, to));
    if (!angles || angles->geodesic_m < least_m) return std::nullopt;
    return CourseDirections{.plane_deg = azimuth_deg(to.x() - from.x(), to.y() - from.y()),
                            .loxodrome_deg = angles->loxodrome.degrees(),
                            .geodesic_deg = angles->geodesic.degrees(),
                            .geodesic_end_deg = angles->geodesic_end.degrees()};
}

}  // namespace

void set_courses(const TrajectoryTable& trajectory, Windows& windows) {
    if (!trajectory.origin) return;
    const PlaceFrames frames(*trajectory.origin);
    const auto& rows = trajectory.rows;
    const auto known = [](const TrajectoryEpoch& row) { return row.east_m && row.north_m; };
    const auto first = std::ranges::find_if(rows, known);
    const auto last = std::ranges::find_if(rows.rbegin(), rows.rend(), known);
    if (first == rows.end()) return;
    windows.course = course_between(frames, *first, *last);
    const RowsByEpoch by_epoch(rows);
    for_each_window(windows, [&](auto& window, const std::string&) {
        const auto* const begin = by_epoch.find(window.span.first_epoch);
        const auto* const end = by_epoch.find(window.span.last_epoch);
        if (begin && end && known(*begin) && known(*end))
            window.course = course_between(frames, *begin, *end);
    });
}

void add_headings(const InertialSolution& solution, Windows& windows) {
    for_each_window(windows, [&](auto& window, const std::string&) {
        const auto within = epochs_within(solution, window.span);
        if (!window.course || !within) return;
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (std::size_t k = within->first; k <= within->last; ++k) {
            const double heading = solution.epochs[k].attitude.heading;
            sum += Eigen::Vector2d(std::sin(heading), std::cos(heading));
        }
        window.course->heading_deg = azimuth_deg(sum.x(), sum.y());
    });
}

}  // namespace runcert
