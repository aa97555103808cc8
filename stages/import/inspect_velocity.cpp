#include <Eigen/Cholesky>
#include <algorithm>

#include "core/geodesy.h"
#include "stages/import/inspect.h"
#include "stages/import/row_collector.h"
#include "witness/copies.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

constexpr double half_span_s = 0.4;
constexpr double least_change_m_s = 0.5;
/// A fit with a larger standard deviation holds a jump and not a motion.
constexpr double useless_m_s = 5.0;
/// So many epochs tell a delay; of longer recordings the fastest stretch is taken.
constexpr std::size_t most_rows = 20'000;

/// An epoch's place in the horizontal plane of the first one, m.
struct Point {
    const Observation* row = nullptr;
    double time_s = 0.0;
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
};

std::vector<Point> points_of(const Observations& observations) {
    std::vector<Point> points;
    std::optional<LocalFrame> frame;
    for (const Observation& row : observations.rows) {
        const bool later = points.empty() || row.time > points.back().row->time;
        if (!later) continue;
        if (row.plane_east_m) {
            points.push_back({&row, row.time.seconds(), {*row.plane_east_m, *row.plane_north_m}});
        } else if (row.latitude_deg) {
            const Geodetic place{.latitude = Angle::from_degrees(*row.latitude_deg),
                                 .longitude = Angle::from_degrees(*row.longitude_deg),
                                 .height_m = row.height_m.value_or(0.0)};
            if (!frame) frame.emplace(place);
            points.push_back({&row, row.time.seconds(),
                              frame->enu_from_ecef(ecef_from_geodetic(place)).m.head<2>()});
        }
    }
    return points;
}

/// The points about the fastest recorded velocity, as many as are looked at.
std::vector<Point> chosen(std::vector<Point> points) {
    if (points.size() <= most_rows) return points;
    const auto fastest =
        std::max_element(points.begin(), points.end(), [](const Point& a, const Point& b) {
            return horizontal_speed(*a.row) < horizontal_speed(*b.row);
        });
    const auto centre = static_cast<std::size_t>(fastest - points.begin());
    const std::size_t from =
        std::min(centre - std::min(centre, most_rows / 2), points.size() - most_rows);
    const auto first = points.begin() + static_cast<std::ptrdiff_t>(from);
    return {first, first + static_cast<std::ptrdiff_t>(most_rows)};
}

/// Motion at the middle of points by the parabola of least squares, with the covariance that their
/// scatter about it gives. Nothing across a gap, nor where the positions jump.
std::optional<EpochMotion> fitted_motion(const std::vector<Point>& points, std::size_t middle,
                                         std::size_t half, double interval_s) {
    if (middle < half || middle + half >= points.size()) return std::nullopt;
    const double span_s = points[middle + half].time_s - points[middle - half].time_s;
    if (span_s > (2.0 * static_cast<double>(half) + 0.5) * interval_s) return std::nullopt;
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t i = middle - half; i <= middle + half; ++i) {
        const double t_s = points[i].time_s - points[middle].time_s;
        const Eigen::Vector3d basis(1.0, t_s, 0.5 * t_s * t_s);
        normal += basis * basis.transpose();
        right += basis * (points[i].place - points[middle].place).transpose();
    }
    const Eigen::Matrix3d cofactor = normal.ldlt().solve(Eigen::Matrix3d::Identity());
    const Eigen::Matrix<double, 3, 2> solution = cofactor * right;
    double squares = 0.0;
    for (std::size_t i = middle - half; i <= middle + half; ++i) {
        const double t_s = points[i].time_s - points[middle].time_s;
        squares += (points[i].place - points[middle].place -
                    solution.transpose() * Eigen::Vector3d(1.0, t_s, 0.5 * t_s * t_s))
                       .squaredNorm();
    }
    const double variance =
        std::max(squares / (2.0 * (2.0 * static_cast<double>(half) - 2.0)), 1e-10);
    if (variance * cofactor(1, 1) > useless_m_s * useless_m_s) return std::nullopt;
    EpochMotion motion;
    motion.velocity = solution.row(1);
    motion.acceleration = solution.row(2);
    motion.velocity_covariance = variance * cofactor(1, 1) * Eigen::Matrix2d::Identity();
    motion.acceleration_covariance = variance * cofactor(2, 2) * Eigen::Matrix2d::Identity();
    return motion;
}

std::size_t half_width(double interval_s) {
    return std::max<std::size_t>(2,
                                 static_cast<std::size_t>(std::min(half_span_s / interval_s, 1e3)));
}

/// Whether the recorded velocity changes at all, which alone tells a delay.
bool changes(const std::vector<velocities::Comparison>& comparisons) {
    return std::any_of(
        comparisons.begin(), comparisons.end(), [&](const velocities::Comparison& each) {
            return (each.recorded - comparisons.front().recorded).norm() > least_change_m_s;
        });
}

}  // namespace

VelocityOrigin raw_velocity_origin(const Observations& observations) {
    std::vector<TimedPosition<2>> positions;
    std::vector<TimedValue> speeds;
    for (const Point& point : chosen(points_of(observations))) {
        positions.push_back({.time_s = point.time_s, .position = point.place});
        if (const auto speed = horizontal_speed(*point.row))
            speeds.push_back({point.time_s, *speed});
    }
    return made_from(speeds, positions, 0.0,
                     observations.facts.position_resolution_m.value_or(0.0));
}

std::optional<double> raw_velocity_delay_s(const Observations& observations) {
    const double interval_s = observations.facts.nominal_interval_s;
    if (interval_s <= 0.0) return std::nullopt;
    const std::vector<Point> points = chosen(points_of(observations));
    const std::size_t half = half_width(interval_s);
    Motion motion(points.size());
    velocities::Knots knots;
    std::vector<velocities::Comparison> comparisons;
    std::int64_t arc = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        motion[i] = fitted_motion(points, i, half, interval_s);
        if (!motion[i]) {
            ++arc;
            continue;
        }
        knots.push_back({.row = i,
                         .arc = arc,
                         .time_s = points[i].time_s,
                         .velocity = motion[i]->velocity,
                         .acceleration = motion[i]->acceleration});
        const Observation& row = *points[i].row;
        if (row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s)
            comparisons.push_back(
                {.knot = knots.size() - 1,
                 .recorded = {*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s}});
    }
    if (!changes(comparisons)) return std::nullopt;
    return velocities::estimate_delay(knots, motion, comparisons, longest_velocity_delay_s,
                                      interval_s)
        .delay_s;
}

std::vector<RawDelay> raw_velocity_delays(const Observations& observations) {
    constexpr double least_step_s = 0.2;
    const double interval_s = observations.facts.nominal_interval_s;
    if (interval_s <= 0.0) return {};
    const std::vector<Point> points = points_of(observations);
    const std::size_t half = half_width(interval_s);
    std::vector<velocities::SpeedPair> pairs;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!pairs.empty() && points[i].time_s - pairs.back().time_s < least_step_s) continue;
        velocities::SpeedPair& pair = pairs.emplace_back();
        pair.time_s = points[i].time_s;
        pair.recorded_m_s = horizontal_speed(*points[i].row);
        if (const auto motion = fitted_motion(points, i, half, interval_s))
            pair.by_positions_m_s = motion->velocity.norm();
    }
    std::vector<RawDelay> delays;
    for (const velocities::DelayStretch& one :
         velocities::delays_along(pairs, longest_velocity_delay_s))
        delays.push_back({.from_s = pairs[one.first].time_s,
                          .to_s = pairs[one.last].time_s,
                          .delay_s = one.delay_s,
                          .sigma_s = one.sigma_s,
                          .beyond = one.is_beyond(longest_velocity_delay_s)});
    return delays;
}

}  // namespace runcert
