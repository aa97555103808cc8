#pragma once

#include <optional>
#include <vector>

#include "stages/screen/screen.h"
#include "stages/screen/time_order.h"

namespace runcert {

/// Marks what an epoch's own cells, or the standing of its time, forbid: no_position,
/// far_position, no_fix, float, other_fix, repeated, duplicate_time, backward_time,
/// accuracy_missing, accuracy_absurd, few_satellites, low_ratio, old_corrections. All other epochs
/// become usable. `standing` has one element for each row; so has `seam` below.
///
/// A position is far more than 100 km from the origin of its place; without an origin, from the
/// middle of all.
void check_epochs(std::vector<ScreenedEpoch>& rows, const std::vector<TimeStanding>& standing,
                  bool vertical_measured, const ScreenConfig& config,
                  const std::optional<FrameOrigin>& origin = std::nullopt);

/// Numbers the arcs of the usable epochs. A new one begins with a step longer than what is bridged
/// (`bridged_s`), at a seam, and where several epochs out of order lie between two whose stamps
/// leave no room for them.
void number_arcs(std::vector<ScreenedEpoch>& rows, const std::vector<bool>& seam,
                 double nominal_interval_s, const ScreenConfig& config);

}  // namespace runcert
