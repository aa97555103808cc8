#pragma once

#include <vector>

#include "schemas/trajectory/trajectory.h"
#include "stages/smooth/trajectory_rows.h"
#include "witness/arcs.h"

namespace runcert {

/// Autocorrelation at lag 1 of the normalised innovations.
template <int Axes>
double innovation_autocorrelation(const std::vector<Arc<Axes>>& arcs, const EstimationModel& model);

/// Whether the filter behaves as `model` says: the normalised innovations' size, over the whole
/// recording and over spans of it, and their autocorrelation. (The smoother is given more freedom
/// than was fitted, so that the model to test is the fitted one.)
template <int Axes>
FilterHealth filter_health(const std::vector<Arc<Axes>>& arcs, const EstimationModel& model);

/// Adds what the covariances of the smoothed states say.
template <int Axes>
void add_numerics(const std::vector<SmoothedMeans<Axes>>& smoothed, FilterHealth& health);

}  // namespace runcert
