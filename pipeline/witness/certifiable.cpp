#include "witness/certifiable.h"

#include <cmath>

namespace runcert {

std::vector<ArcRows> arcs_in(const TrajectoryTable& trajectory) {
    std::vector<ArcRows> arcs;
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        const auto& arc = trajectory.rows[i].arc;
        if (!arc) continue;
        if (arcs.empty() || arcs.back().number != *arc) arcs.push_back({*arc, {}});
        arcs.back().rows.push_back(i);
    }
    return arcs;
}

std::vector<std::vector<EpochPair>> certifiable_windows(const TrajectoryTable& trajectory,
                                                        const std::vector<ArcRows>& arcs,
                                                        double duration_s,
                                                        double duration_tolerance_s) {
    // Rows that must not lie after a window's first row and up to its last. Every row counts, also
    // one that belongs to no arc, such as a repeated time stamp.
    std::vector<std::int64_t> obstacles;
    obstacles.reserve(trajectory.rows.size());
    for (const TrajectoryEpoch& row : trajectory.rows)
        obstacles.push_back((obstacles.empty() ? 0 : obstacles.back()) + (row.usable ? 0 : 1));

    std::vector<std::vector<EpochPair>> windows;
    windows.reserve(arcs.size());
    for (const ArcRows& arc : arcs) {
        std::vector<ElapsedTime> times;
        times.reserve(arc.rows.size());
        for (const std::size_t row : arc.rows)
            times.push_back(trajectory.rows[row].time);
        const auto ends = window_ends(times, duration_s, duration_tolerance_s,
                                      trajectory.facts.nominal_interval_s);
        std::vector<EpochPair>& of_arc = windows.emplace_back();
        for (std::size_t first = 0; first < arc.rows.size(); ++first) {
            if (!ends[first]) continue;
            const std::size_t first_row = arc.rows[first];
            const std::size_t last_row = arc.rows[*ends[first]];
            if (trajectory.rows[first_row].usable && obstacles[last_row] == obstacles[first_row])
                of_arc.push_back({first, *ends[first]});
        }
    }
    return windows;
}

std::vector<std::optional<std::size_t>> window_ends(std::span<const ElapsedTime> times,
                                                    double duration_s, double duration_tolerance_s,
                                                    double nominal_interval_s) {
    // Whole nanoseconds, so that 3 s after 0.1 s is 3.1 s.
    const std::int64_t shortest = std::llround((duration_s - duration_tolerance_s) * 1e9);
    const std::int64_t longest = std::llround((duration_s + nominal_interval_s) * 1e9);
    std::vector<std::optional<std::size_t>> ends(times.size());
    std::size_t last = 0;
    for (std::size_t first = 0; first < times.size(); ++first) {
        while (last < times.size() && times[last].nanoseconds - times[first].nanoseconds < shortest)
            ++last;
        if (last < times.size() && times[last].nanoseconds - times[first].nanoseconds < longest)
            ends[first] = last;
    }
    return ends;
}

}  // namespace runcert
