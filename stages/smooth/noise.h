#pragma once

#include <vector>

#include "schemas/trajectory/declared.h"
#include "stages/smooth/smooth.h"
#include "witness/arcs.h"

namespace runcert {

/// The noise of a recording's arcs. It is fitted, or as stated if the configuration says so or
/// nothing can be fitted. All variances are then multiplied by the a posteriori variance factor, at
/// least 1. Every figure is rounded to the decimals of the file, so that what is read back is what
/// was used.
///
/// Sets the `jerk_factor` of every epoch to the value used in the fit: the jerk density most likely
/// for the motion around it (`local_motion`), in units of the fitted one.
template <int Axes>
NoiseSummary estimate_noise(std::vector<Arc<Axes>>& arcs, const SmoothConfig& config);

/// Sets the jerk densities for estimating the trajectory. Fitted ones follow the motion, but are
/// nowhere below that fitted to the whole recording, nor below `config.fit.initial_jerk_density`.
/// What a craft of the class can do must not count as an error because it rarely did it. An
/// estimate that allows more motion than the craft used loses little; one that allows less is
/// incorrect.
template <int Axes>
void set_jerk_densities(std::vector<Arc<Axes>>& arcs, const NoiseSummary& noise,
                        const SmoothConfig& config);

}  // namespace runcert
