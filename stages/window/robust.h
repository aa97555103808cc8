#pragma once

#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/arc_part.h"

namespace runcert {

/// The robust batch's speed between the epochs that enclose a window against the screened
/// solution's (`smoothed`, of the part of the arc), whose noise model is the same. Empty where the
/// trajectory has none there.
///
/// It agrees within twice the sum of the screened speed's standard uncertainty and `model_m_s`, by
/// how much other models of the motion change the speed: where the craft moves harder than its
/// model has it, the two estimates spread what is left over differently.
std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const SmoothedArc<2>& smoothed, double model_m_s);

}  // namespace runcert
