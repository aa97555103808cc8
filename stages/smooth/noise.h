#pragma once

#include <vector>

#include "arcs/arcs.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/smooth/smooth.h"

namespace runcert {

/// The noise of a recording's arcs: fitted, or as stated where that was asked for or nothing can
/// be fitted; then all variances are multiplied by the a posteriori variance factor, at least 1.
/// Every figure is rounded to the decimals of the file, so that what is read back is what was used.
template <int Axes>
NoiseSummary learn_noise(const std::vector<Arc<Axes>>& arcs, const SmoothConfig& config);

}  // namespace runcert
