#pragma once

#include <string>
#include <vector>

#include "schemas/profile/profile.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"
#include "witness/runs.h"

namespace runcert {

/// Two windows of runs in opposite directions, the faster first, or the reason why there are none.
struct OppositeRuns {
    std::vector<FoundWindow> windows;
    std::string missing;
};

/// Takes the fastest allowed window of each run. Of these it selects the pair with the highest mean
/// whose directions of displacement are within 45 degrees of opposite, and that both lie within the
/// profile's time. The profile's thresholds separate the runs. A window belongs to the run that
/// fully contains it.
OppositeRuns best_opposite_runs(const TrajectoryTable& trajectory, const std::vector<ArcRows>& arcs,
                                const std::vector<FoundWindow>& all, const Profile& profile);

}  // namespace runcert
