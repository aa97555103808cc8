#pragma once

#include <vector>

#include "schemas/trajectory/trajectory.h"
#include "stages/smooth/smooth.h"
#include "witness/arcs.h"

namespace runcert {

/// The noise of a recording's arcs: fitted, or as stated where that was asked for or nothing can
/// be fitted; then all variances are multiplied by the a posteriori variance factor, at least 1.
/// Every figure is rounded to the decimals of the file, so that what is read back is what was used.
///
/// Sets the `jerk_factor` of every epoch to what the noise was fitted with: the jerk density most
/// likely for the motion about it (`local_motion`), in units of the fitted one.
template <int Axes>
NoiseSummary estimate_noise(std::vector<Arc<Axes>>& arcs, const SmoothConfig& config);

/// The jerk densities that the trajectory is estimated with: where fitted they follow the motion,
/// but nowhere is one less than that fitted to the whole recording, nor less than
/// `config.fit.initial_jerk_density`: what a craft of the class can do must not be taken for an
/// error because it did not do it for long. An estimate that gives the motion more freedom than it
/// used loses little; one that gives it less is wrong.
template <int Axes>
void set_jerk_densities(std::vector<Arc<Axes>>& arcs, const NoiseSummary& noise,
                        const SmoothConfig& config);

}  // namespace runcert
