#pragma once

#include <string>
#include <vector>

#include "schemas/profile/profile.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"
#include "witness/runs.h"

namespace runcert {

/// Two windows of runs in opposite directions, the faster one first, or why there are none.
struct OppositeRuns {
    std::vector<FoundWindow> windows;
    std::string missing;
};

/// Of all windows allowed, the fastest of each run, and of these the pair with the highest mean
/// whose directions of displacement are within 45 degrees of opposite and that both lie within the
/// profile's time. Runs are cut by the profile's thresholds; a window belongs to the run that
/// holds it whole.
OppositeRuns best_opposite_runs(const TrajectoryTable& trajectory, const std::vector<ArcRows>& arcs,
                                const std::vector<FoundWindow>& all, const Profile& profile);

}  // namespace runcert
