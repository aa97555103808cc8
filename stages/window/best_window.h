#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "arcs/certifiable.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// A window of an arc, with its speeds.
struct CandidateWindow {
    std::size_t arc = 0;  ///< index of the arc
    EpochPair window;     ///< indices into the arc's rows
    SpeedDefinitions definitions;
};

/// The certifiable window that is fastest by a definition of the profile's schema, on the smoothed
/// trajectory; the earliest of equally fast ones, empty where there is none. `windows` has those of
/// each arc. Linear: a window's path and means cost the same whatever its length.
std::optional<CandidateWindow> best_window(const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs,
                                           const std::vector<std::vector<EpochPair>>& windows,
                                           std::string_view definition);

/// Horizontal displacement over time (m/s) between two rows of the smoothed trajectory.
double displacement_over_time(const TrajectoryEpoch& first, const TrajectoryEpoch& last);

}  // namespace runcert
