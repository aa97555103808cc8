#pragma once

#include <optional>

#include "motion/epoch_motion.h"
#include "stages/screen/screen.h"
#include "witness/position_pairs.h"

namespace runcert {

/// An epoch common to both receivers.
struct ReceiverPair : PositionPair {
    std::optional<Eigen::Vector2d> track = {};  ///< direction of travel, where it shows the craft's
                                                ///< attitude
    double variance_of_direction = 0.0;         ///< rad^2
};

/// The pairs of `position_pairs`, with directions as `compare_receivers` describes.
std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first);

}  // namespace runcert
