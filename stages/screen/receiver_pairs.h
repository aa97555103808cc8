#pragma once

#include <array>

#include "estimation/epoch_motion.h"
#include "stages/screen/screen.h"

namespace runcert {

/// An epoch that both receivers have.
struct ReceiverPair {
    std::array<std::size_t, 2> rows{};  ///< of the first and of the second table
    ElapsedTime time;                   ///< of the first
    Eigen::Vector3d difference;         ///< second less first, m; up is 0 in the plane
    Eigen::Matrix3d covariance;
    std::optional<Eigen::Vector2d> track;  ///< direction of travel, where it tells the craft's own
    double variance_of_direction = 0.0;    ///< rad^2
};

/// The pairs of usable rows within a microsecond of one another, in order of time; none where a
/// recording's time is relative, or only one of the two is georeferenced. In space where both
/// recordings have heights, else in the plane. Directions as `compare_receivers` says.
std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first);

}  // namespace runcert
