#pragma once

#include <vector>

#include "schemas/trajectory/declared.h"
#include "stages/smooth/trajectory_rows.h"
#include "witness/arcs.h"

namespace runcert {

/// Autocorrelation at lag 1 of the normalised innovations.
template <int Axes>
double innovation_autocorrelation(const std::vector<Arc<Axes>>& arcs, const EstimationModel& model);

/// Whether the filter behaves as `model` predicts: the size of the normalised innovations, over the
/// whole recording and over spans of it, and their autocorrelation. Pass the fitted model, because
/// the smoother allows more motion than was fitted.
template <int Axes>
FilterHealth filter_health(const std::vector<Arc<Axes>>& arcs, const EstimationModel& model);

/// Adds the numerical figures of the smoothed covariances.
template <int Axes>
void add_numerics(const std::vector<SmoothedMeans<Axes>>& smoothed, FilterHealth& health);

}  // namespace runcert
