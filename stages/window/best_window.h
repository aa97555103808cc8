#pragma once

#include <Eigen/Core>
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

/// Smoothed horizontal positions (m) of an arc's rows. After bridged steps the offsets are taken
/// off, so that differences are displacements: what the positions do over a step less the craft's
/// motion over it, dt (v + v') / 2 - dt^2 (a' - a) / 12, the mean of persistent acceleration under
/// velocity and acceleration at both ends. (Over one epoch an acceleration that dies away moves the
/// craft no differently by anything that counts in a search.)
std::vector<Eigen::Vector2d> positions_without_offsets(const TrajectoryTable& trajectory,
                                                       const ArcRows& arc);

/// Time (s) between two of an arc's rows.
double duration_of(const TrajectoryTable& trajectory, const ArcRows& arc, EpochPair window);

/// Horizontal displacement over time (m/s) in a window of an arc with these positions.
double displacement_over_time(const std::vector<Eigen::Vector2d>& positions, EpochPair window,
                              double duration_s);

}  // namespace runcert
