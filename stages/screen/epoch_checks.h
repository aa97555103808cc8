#pragma once

#include <optional>
#include <vector>

#include "stages/screen/screen.h"
#include "stages/screen/time_order.h"

namespace runcert {

/// Marks epochs that their own values, or the standing of their time, exclude: no_position,
/// far_position, no_fix, float, other_fix, repeated, duplicate_time, backward_time,
/// accuracy_missing, accuracy_absurd, few_satellites, low_ratio, old_corrections. All other epochs
/// become usable. `standing` has one element for each row, as has `seam` below.
///
/// A position is far if it lies more than 100 km from the origin of its place or, without an
/// origin, from the median of all positions.
void check_epochs(std::vector<ScreenedEpoch>& rows, const std::vector<TimeStanding>& standing,
                  bool vertical_measured, const ScreenConfig& config,
                  const std::optional<FrameOrigin>& origin = std::nullopt);

/// Numbers the arcs of the usable epochs. A new arc begins after a step longer than is bridged
/// (`bridged_s`) and at a seam. It also begins where several out-of-order epochs lie between two
/// whose stamps leave no room for them.
void number_arcs(std::vector<ScreenedEpoch>& rows, const std::vector<bool>& seam,
                 double nominal_interval_s, const ScreenConfig& config);

}  // namespace runcert
