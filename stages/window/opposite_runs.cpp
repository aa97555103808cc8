#include "stages/window/opposite_runs.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace runcert {
namespace {

struct RunWindow {
    FoundWindow window;
    Eigen::Vector2d direction;  ///< of the displacement
};

/// The fastest window of each run that contains one.
std::vector<RunWindow> fastest_of_runs(const TrajectoryTable& trajectory,
                                       const std::vector<ArcRows>& arcs,
                                       const std::vector<FoundWindow>& all,
                                       const std::vector<CraftRun>& runs) {
    std::vector<std::optional<FoundWindow>> fastest(runs.size());
    const auto row_of = [&](const FoundWindow& window, std::size_t sample) {
        return arcs[window.series].rows[sample];
    };
    for (const FoundWindow& window : all) {
        const auto after =
            std::ranges::upper_bound(runs, row_of(window, window.first), {}, &CraftRun::first_row);
        if (after == runs.begin()) continue;
        const auto run = after - 1;
        if (row_of(window, window.last) > run->last_row) continue;
        auto& best = fastest[static_cast<std::size_t>(run - runs.begin())];
        if (!best || preferred(window, *best)) best = window;
    }
    std::vector<RunWindow> found;
    for (const auto& window : fastest) {
        if (!window) continue;
        const TrajectoryEpoch& from = trajectory.rows[row_of(*window, window->first)];
        const TrajectoryEpoch& to = trajectory.rows[row_of(*window, window->last)];
        const Eigen::Vector2d moved(*to.east_m - *from.east_m, *to.north_m - *from.north_m);
        found.push_back({*window, moved.stableNormalized()});
    }
    return found;
}

}  // namespace

OppositeRuns best_opposite_runs(const TrajectoryTable& trajectory, const std::vector<ArcRows>& arcs,
                                const std::vector<FoundWindow>& all, const Profile& profile) {
    const auto runs = runs_in(trajectory.rows, {.start_m_s = profile.runs.start_m_s,
                                                .stop_m_s = profile.runs.stop_m_s,
                                                .stop_s = profile.runs.stop_s,
                                                .turn_deg = profile.runs.turn_deg});
    const auto found = fastest_of_runs(trajectory, arcs, all, runs);
    const double opposite = -std::cos(std::numbers::pi / 4.0);
    OppositeRuns best;
    double best_mean_m_s = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t j = i + 1; j < found.size(); ++j) {
            const double apart_s = found[j].window.end.seconds() - found[i].window.start.seconds();
            if (apart_s > *profile.opposite_runs_within_s) break;
            if (found[i].direction.dot(found[j].direction) > opposite) continue;
            const double mean_m_s =
                0.5 * (found[i].window.assured_m_s() + found[j].window.assured_m_s());
            if (mean_m_s <= best_mean_m_s) continue;
            best_mean_m_s = mean_m_s;
            best.windows = {found[i].window, found[j].window};
        }
    if (best.windows.empty())
        best.missing = fmt::format(
            "of {} {} with a certifiable window no two are in opposite directions within {:g} s",
            found.size(), found.size() == 1 ? "run" : "runs", *profile.opposite_runs_within_s);
    std::ranges::stable_sort(best.windows, preferred);
    return best;
}

}  // namespace runcert
