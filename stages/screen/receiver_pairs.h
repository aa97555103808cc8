#pragma once

#include <array>

#include "motion/epoch_motion.h"
#include "stages/screen/screen.h"

namespace runcert {

/// An epoch common to both receivers.
struct ReceiverPair {
    std::array<std::size_t, 2> rows{};  ///< of the first and of the second table
    ElapsedTime time;                   ///< of the first
    Eigen::Vector3d difference;         ///< second minus first, m; up is 0 if heights are not used
    Eigen::Matrix3d covariance;
    std::optional<Eigen::Vector2d> track;  ///< direction of travel, where it shows the craft's
                                           ///< attitude
    double variance_of_direction = 0.0;    ///< rad^2
};

/// The pairs of usable rows within a microsecond of each other, in order of time. Empty if a
/// recording's time is relative, or only one of the two is georeferenced. Differences include
/// heights where both recordings have them. Directions are as `compare_receivers` describes.
std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first);

}  // namespace runcert
