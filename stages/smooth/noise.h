#pragma once

#include <vector>

#include "arcs/arcs.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/smooth/smooth.h"

namespace runcert {

/// The noise of a recording's arcs: fitted, or as stated where that was asked for or nothing can
/// be fitted; then all variances are multiplied by the a posteriori variance factor, at least 1.
/// Every figure is rounded to the decimals of the file, so that what is read back is what was used.
///
/// Sets the `jerk_factor` of every epoch: where fitted, the jerk density follows the motion
/// (`local_motion`), is nowhere less than the one fitted to the whole recording, and nowhere less
/// than `config.fit.initial_jerk_density`: what a craft of the class can do must not be taken for an
/// error because it did not do it for long.
template <int Axes>
NoiseSummary learn_noise(std::vector<Arc<Axes>>& arcs, const SmoothConfig& config);

}  // namespace runcert
