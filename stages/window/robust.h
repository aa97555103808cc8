#pragma once

#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/arc_part.h"

namespace runcert {

/// The robust batch's speed between the epochs that enclose a window against the screened
/// solution's (`smoothed`, of the part of the arc), whose noise model is the same. Empty where the
/// trajectory has none there.
std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const SmoothedArc<2>& smoothed);

}  // namespace runcert
