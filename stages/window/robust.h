#pragma once

#include "stages/window/certify.h"

namespace runcert {

/// The robust batch's speed between the epochs that enclose a window against the screened
/// solution's (`smoothed`, of the window's arc), whose noise model is the same. Empty where the
/// trajectory has none there.
std::optional<RobustSpeed> robust_speed(const AxesEvidence<2>& evidence, const FoundWindow& found,
                                        const SmoothedArc<2>& smoothed);

}  // namespace runcert
