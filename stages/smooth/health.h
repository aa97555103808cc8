#pragma once

#include <vector>

#include "arcs/arcs.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/smooth/trajectory_rows.h"

namespace runcert {

/// Whether filter and smoother behaved as `model` says: the normalised innovations' size, over the
/// whole recording and over spans of it, their autocorrelation, also under the noise `as_stated`,
/// and the covariances of the smoothed states.
template <int Axes>
FilterHealth filter_health(const std::vector<Arc<Axes>>& arcs,
                           const std::vector<SmoothedMeans<Axes>>& smoothed,
                           const EstimationModel& model, const EstimationModel& as_stated);

}  // namespace runcert
