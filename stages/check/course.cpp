#include "stages/check/course.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/angle.h"
#include "core/failure.h"
#include "core/geodesy.h"
#include "core/statistics.h"
#include "core/uncertainty.h"
#include "witness/surface_input.h"

namespace runcert {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// An estimate of the run: east, north, height. NaN if missing.
struct MotionPoint {
    std::size_t row = 0;
    double time_s = 0.0;
    Vector3d position_m, velocity_m_s;
    Vector3d variance;  ///< of the position, m^2
    Vector3d velocity_variance;

    double speed_m_s() const { return velocity_m_s.head<2>().norm(); }
};

MotionPoint motion_of(const TrajectoryEpoch& row, std::size_t index, const CourseErrors& errors) {
    const auto squared = [](const std::optional<double>& sigma) {
        return sigma ? *sigma * *sigma : unknown;
    };
    MotionPoint point;
    point.row = index;
    point.time_s = row.time.seconds();
    point.position_m = {*row.east_m, *row.north_m, row.up_m.value_or(unknown)};
    if (errors.tangent_plane)
        point.position_m.z() += fall_below_plane_m(point.position_m.x(), point.position_m.y());
    point.velocity_m_s = {*row.velocity_east_m_s, *row.velocity_north_m_s,
                          row.velocity_up_m_s.value_or(unknown)};
    const double horizontal = errors.slow_horizontal_m * errors.slow_horizontal_m;
    const double vertical = errors.slow_vertical_m * errors.slow_vertical_m;
    point.variance =
        Vector3d(squared(row.sigma_east_m), squared(row.sigma_north_m), squared(row.sigma_up_m)) +
        Vector3d(horizontal, horizontal, vertical);
    point.velocity_variance = {squared(row.sigma_velocity_east_m_s),
                               squared(row.sigma_velocity_north_m_s),
                               squared(row.sigma_velocity_up_m_s)};
    return point;
}

std::vector<MotionPoint> motion_points(std::span<const TrajectoryEpoch> rows, std::size_t first_row,
                                       std::size_t last_row, const CourseErrors& errors) {
    std::vector<MotionPoint> points;
    for (std::size_t i = first_row; i <= last_row; ++i) {
        const TrajectoryEpoch& row = rows[i];
        if (!row.arc || !row.east_m || !row.north_m || !row.velocity_east_m_s ||
            !row.velocity_north_m_s)
            continue;
        points.push_back(motion_of(row, i, errors));
    }
    return points;
}

CourseFigure figure(double value, double variance,
                    double largest = std::numeric_limits<double>::infinity()) {
    if (std::isnan(variance)) return {value, std::nullopt};
    return {value, std::min(usual_coverage_factor * std::sqrt(variance), largest)};
}

/// Variance of the difference of two positions, along each axis.
Vector3d difference_variance(const MotionPoint& a, const MotionPoint& b) {
    return a.variance + b.variance;
}

/// The unit vector to the right of a direction, and uncorrelated variances projected onto it.
Vector2d right_of(const Vector2d& direction) {
    const double length = direction.norm();
    if (length == 0.0) return Vector2d::UnitX();
    return Vector2d(direction.y(), -direction.x()) / length;
}

double variance_along(const Vector2d& unit, const Vector3d& variance) {
    return unit.cwiseAbs2().dot(variance.head<2>());
}

double direction_deg(const Vector2d& vector) {
    return std::atan2(vector.x(), vector.y()) * degrees_per_radian;
}

/// Variance, degrees^2, of the direction of a vector with this variance across it.
double direction_variance(double across, double length) {
    return degrees_per_radian * degrees_per_radian * across / (length * length);
}

std::optional<CourseFigure> height_difference(const std::vector<MotionPoint>& run) {
    const auto has_no_height = [](const MotionPoint& point) {
        return std::isnan(point.position_m.z());
    };
    if (std::ranges::any_of(run, has_no_height)) return std::nullopt;
    const auto height = [](const MotionPoint& point) { return point.position_m.z(); };
    const auto [low, high] = std::ranges::minmax_element(run, {}, height);
    return figure(height(*high) - height(*low), difference_variance(*low, *high).z());
}

std::optional<CourseFigure> slope_between(const MotionPoint& first, const MotionPoint& last) {
    const Vector3d chord_m = last.position_m - first.position_m;
    const double distance_m = chord_m.head<2>().norm();
    if (std::isnan(chord_m.z()) || distance_m == 0.0) return std::nullopt;
    const double slope = chord_m.z() / distance_m;
    const Vector3d variance = difference_variance(first, last);
    const double along = variance_along(chord_m.head<2>() / distance_m, variance);
    return figure(slope, (variance.z() + slope * slope * along) / (distance_m * distance_m));
}

CourseFigure heading_between(const MotionPoint& first, const MotionPoint& last) {
    const Vector2d chord_m = (last.position_m - first.position_m).head<2>();
    const double across = variance_along(right_of(chord_m), difference_variance(first, last));
    const double heading = direction_deg(chord_m);
    CourseFigure result = figure(heading < 0.0 ? heading + 360.0 : heading,
                                 direction_variance(across, chord_m.norm()), 180.0);
    if (result.value >= 360.0) result.value = 0.0;  // rounding can give 360 just west of north
    return result;
}

CourseFigure turning_between(const MotionPoint& first, const MotionPoint& last) {
    const Vector2d from = first.velocity_m_s.head<2>(), to = last.velocity_m_s.head<2>();
    const double turning = direction_deg(to) - direction_deg(from);
    const auto variance = [](const MotionPoint& point, const Vector2d& velocity) {
        return direction_variance(variance_along(right_of(velocity), point.velocity_variance),
                                  velocity.norm());
    };
    return figure(std::remainder(turning, 360.0), variance(first, from) + variance(last, to),
                  180.0);
}

CourseFigure straightness_of(std::span<const MotionPoint> window) {
    const MotionPoint &first = window.front(), &last = window.back();
    const Vector2d line = (last.position_m - first.position_m).head<2>();
    const Vector2d across = right_of(line);
    const auto distance_m = [&](const MotionPoint& point) {
        return std::abs(across.dot((point.position_m - first.position_m).head<2>()));
    };
    const MotionPoint& farthest = *std::ranges::max_element(window, {}, distance_m);
    const double part =
        line.norm() == 0.0
            ? 0.0
            : line.dot((farthest.position_m - first.position_m).head<2>()) / line.squaredNorm();
    const Vector3d variance = (1.0 - part) * (1.0 - part) * first.variance +
                              part * part * last.variance + farthest.variance;
    return figure(distance_m(farthest), variance_along(across, variance));
}

bool is_at_rest(const MotionPoint& point, const CourseErrors& errors) {
    if (point.speed_m_s() < errors.standing_below_m_s) return true;
    if (point.speed_m_s() > errors.moving_above_m_s) return false;
    const double statistic = point.velocity_m_s.head<2>()
                                 .cwiseAbs2()
                                 .cwiseQuotient(point.velocity_variance.head<2>())
                                 .sum();
    return statistic <= chi_squared_quantile(0.95, 2);
}

/// Sets the facts of the start from the points up to the window, beginning with the standstill
/// before the run.
void set_start(std::span<const MotionPoint> approach, const CourseErrors& errors,
               CourseFacts& facts) {
    const MotionPoint& slowest = *std::ranges::min_element(approach, {}, &MotionPoint::speed_m_s);
    facts.speed_before_m_s = figure(
        slowest.speed_m_s(), slowest.velocity_variance.head<2>().maxCoeff<Eigen::PropagateNaN>());
    facts.standing_start = is_at_rest(slowest, errors);
}

void set_run_up(std::span<const MotionPoint> run_up, CourseFacts& facts) {
    facts.run_up_s = run_up.back().time_s - run_up.front().time_s;
    for (std::size_t i = 1; i < run_up.size(); ++i)
        facts.run_up_m += 0.5 * (run_up[i - 1].speed_m_s() + run_up[i].speed_m_s()) *
                          (run_up[i].time_s - run_up[i - 1].time_s);
}

/// The index of a row among the points of a run.
std::size_t index_of(const std::vector<MotionPoint>& run, std::size_t row) {
    const auto place = std::ranges::lower_bound(run, row, {}, &MotionPoint::row);
    if (place == run.end() || place->row != row)
        throw Failure("4-trajectory", "an end of the run or of its window has no estimate",
                      "Run runcert-window again");
    return static_cast<std::size_t>(place - run.begin());
}

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

CourseFacts course_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                         std::size_t window_first_row, std::size_t window_last_row,
                         const CourseErrors& errors) {
    const std::size_t approach_row = run.stood_from_row.value_or(run.first_row);
    if (approach_row > run.first_row || run.first_row > window_first_row ||
        window_first_row >= window_last_row || window_last_row > run.last_row ||
        run.last_row >= rows.size())
        throw Failure("4-trajectory", "the window is not within the run it is said to be of",
                      "Run runcert-window again");
    const std::vector<MotionPoint> points =
        motion_points(rows, run.first_row, run.last_row, errors);
    index_of(points, run.first_row);
    index_of(points, run.last_row);
    const std::size_t first = index_of(points, window_first_row);
    const std::size_t last = index_of(points, window_last_row);
    CourseFacts facts{
        .height_difference_m = height_difference(points),
        .slope = slope_between(points[first], points[last]),
        .heading_deg = heading_between(points[first], points[last]),
        .straightness_m = straightness_of(std::span(points).subspan(first, last - first + 1)),
        .turning_deg = turning_between(points[first], points[last])};
    set_run_up(std::span(points).first(first + 1), facts);
    set_start(motion_points(rows, approach_row, window_first_row, errors), errors, facts);
    return facts;
}

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
