#include "stages/window/best_window.h"

#include <cmath>

namespace runcert {
namespace {

/// Positions and sums along the rows of an arc.
struct RunningSums {
    std::vector<Eigen::Vector2d> positions;  ///< without offsets
    std::vector<double> path_m;              ///< path length up to the row
    std::vector<double> speed;               ///< sum of smoothed speeds up to and with the row
};

double distance_m(const Eigen::Vector2d& first, const Eigen::Vector2d& last) {
    return std::hypot(last.x() - first.x(), last.y() - first.y());
}

/// What the craft itself moves (m) between two neighbouring rows.
Eigen::Vector2d motion_over(const TrajectoryEpoch& from, const TrajectoryEpoch& to) {
    const double dt_s = to.time.seconds() - from.time.seconds();
    const auto velocity = [](const TrajectoryEpoch& row) {
        return Eigen::Vector2d(row.velocity_east_mps.value(), row.velocity_north_mps.value());
    };
    const auto acceleration = [](const TrajectoryEpoch& row) {
        return Eigen::Vector2d(row.acceleration_east_mps2.value(),
                               row.acceleration_north_mps2.value());
    };
    return 0.5 * dt_s * (velocity(from) + velocity(to)) -
           dt_s * dt_s / 12.0 * (acceleration(to) - acceleration(from));
}

RunningSums sums_over(const TrajectoryTable& trajectory, const ArcRows& arc) {
    RunningSums sums;
    sums.positions = positions_without_offsets(trajectory, arc);
    double path_m = 0.0;
    double speed = 0.0;
    for (std::size_t k = 0; k < arc.rows.size(); ++k) {
        if (k > 0) path_m += distance_m(sums.positions[k - 1], sums.positions[k]);
        speed += *trajectory.rows[arc.rows[k]].speed_mps;
        sums.path_m.push_back(path_m);
        sums.speed.push_back(speed);
    }
    return sums;
}

SpeedDefinitions definitions_of(const TrajectoryTable& trajectory, const ArcRows& arc,
                                const RunningSums& sums, EpochPair window) {
    const double time_s = duration_of(trajectory, arc, window);
    const auto steps = static_cast<double>(window.last - window.first);
    const double first_speed = *trajectory.rows[arc.rows[window.first]].speed_mps;
    const double later_speeds = sums.speed[window.last] - sums.speed[window.first];
    return {.displacement_mps = displacement_over_time(sums.positions, window, time_s),
            .path_length_mps = (sums.path_m[window.last] - sums.path_m[window.first]) / time_s,
            .mean_n_plus_1_mps = (later_speeds + first_speed) / (steps + 1.0),
            .mean_n_mps = later_speeds / steps};
}

}  // namespace

std::vector<Eigen::Vector2d> positions_without_offsets(const TrajectoryTable& trajectory,
                                                       const ArcRows& arc) {
    std::vector<Eigen::Vector2d> positions;
    positions.reserve(arc.rows.size());
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();
    Eigen::Vector2d before = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < arc.rows.size(); ++k) {
        const TrajectoryEpoch& row = trajectory.rows[arc.rows[k]];
        const Eigen::Vector2d position(*row.east_m, *row.north_m);
        if (k > 0 && row.begins_after_step())
            offset += position - before - motion_over(trajectory.rows[arc.rows[k - 1]], row);
        positions.emplace_back(position - offset);
        before = position;
    }
    return positions;
}

double duration_of(const TrajectoryTable& trajectory, const ArcRows& arc, EpochPair window) {
    return trajectory.rows[arc.rows[window.last]].time.seconds() -
           trajectory.rows[arc.rows[window.first]].time.seconds();
}

double displacement_over_time(const std::vector<Eigen::Vector2d>& positions, EpochPair window,
                              double duration_s) {
    return distance_m(positions[window.first], positions[window.last]) / duration_s;
}

std::optional<CandidateWindow> best_window(const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs,
                                           const std::vector<std::vector<EpochPair>>& windows,
                                           std::string_view definition) {
    std::optional<CandidateWindow> best;
    for (std::size_t a = 0; a < arcs.size(); ++a) {
        const RunningSums sums = sums_over(trajectory, arcs[a]);
        for (const EpochPair& window : windows[a]) {
            const CandidateWindow one{a, window, definitions_of(trajectory, arcs[a], sums, window)};
            if (!best ||
                one.definitions.by_name(definition) > best->definitions.by_name(definition))
                best = one;
        }
    }
    return best;
}

}  // namespace runcert
