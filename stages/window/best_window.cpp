#include "stages/window/best_window.h"

#include <cmath>

namespace runcert {
namespace {

/// Sums along the rows of an arc.
struct RunningSums {
    std::vector<double> path_m;  ///< path length up to the row
    std::vector<double> speed;   ///< sum of smoothed speeds up to and with the row
};

double distance_m(const TrajectoryEpoch& first, const TrajectoryEpoch& last) {
    return std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
}

RunningSums sums_over(const TrajectoryTable& trajectory, const std::vector<std::size_t>& rows) {
    RunningSums sums;
    double path_m = 0.0;
    double speed = 0.0;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const TrajectoryEpoch& row = trajectory.rows[rows[k]];
        if (k > 0) path_m += distance_m(trajectory.rows[rows[k - 1]], row);
        speed += *row.speed_mps;
        sums.path_m.push_back(path_m);
        sums.speed.push_back(speed);
    }
    return sums;
}

SpeedDefinitions definitions_of(const TrajectoryTable& trajectory, const ArcRows& arc,
                                const RunningSums& sums, EpochPair window) {
    const TrajectoryEpoch& first = trajectory.rows[arc.rows[window.first]];
    const TrajectoryEpoch& last = trajectory.rows[arc.rows[window.last]];
    const double duration_s = last.time.seconds() - first.time.seconds();
    const auto steps = static_cast<double>(window.last - window.first);
    const double later_speeds = sums.speed[window.last] - sums.speed[window.first];
    return {.displacement_mps = displacement_over_time(first, last),
            .path_length_mps = (sums.path_m[window.last] - sums.path_m[window.first]) / duration_s,
            .mean_n_plus_1_mps = (later_speeds + *first.speed_mps) / (steps + 1.0),
            .mean_n_mps = later_speeds / steps};
}

}  // namespace

double displacement_over_time(const TrajectoryEpoch& first, const TrajectoryEpoch& last) {
    return distance_m(first, last) / (last.time.seconds() - first.time.seconds());
}

std::optional<CandidateWindow> best_window(const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs,
                                           const std::vector<std::vector<EpochPair>>& windows,
                                           std::string_view definition) {
    std::optional<CandidateWindow> best;
    for (std::size_t a = 0; a < arcs.size(); ++a) {
        const RunningSums sums = sums_over(trajectory, arcs[a].rows);
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
