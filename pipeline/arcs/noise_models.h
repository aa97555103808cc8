#pragma once

#include <vector>

#include "estimation/noise_fit.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// The noise model that a trajectory was estimated with.
EstimationModel model_of(const NoiseSummary& noise);

/// The models that the recording allows, with their shares; that of the trajectory alone where
/// nothing was fitted.
std::vector<WeightedModel> posterior_of(const NoiseSummary& noise);

}  // namespace runcert
