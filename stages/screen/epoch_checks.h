#pragma once

#include <vector>

#include "stages/screen/screen.h"

namespace runcert {

/// Marks what an epoch's own cells, or its time against the epochs before, forbid: no_position,
/// far_position, no_fix, float, other_fix, duplicate_time, backward_time, accuracy_missing, accuracy_absurd,
/// few_satellites, low_ratio, old_corrections.
/// All other epochs become usable.
void check_epochs(std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                  const ScreenConfig& config);

/// Numbers the arcs of the usable epochs: a step longer than what is bridged (`bridged_s`) begins a
/// new one, and so does a clock that was set back for more than one row.
void number_arcs(std::vector<ScreenedEpoch>& rows, double nominal_interval_s,
                 const ScreenConfig& config);

}  // namespace runcert
