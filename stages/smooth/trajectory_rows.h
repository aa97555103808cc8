#pragma once

#include <vector>

#include "arcs/arcs.h"
#include "estimation/kalman.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// Sets a row's smoothed horizontal motion (m, m/s, m/s^2), its speed, and their standard
/// uncertainties.
void set_horizontal(const StateEstimate<2>& state, TrajectoryEpoch& row);

/// The same of the vertical motion.
void set_vertical(const StateEstimate<1>& state, TrajectoryEpoch& row);

/// The methods of [DHD22], on either side of a bridged step by itself. The filter begins at rest:
/// after a step the craft is not, and at the first position the filter has nothing to say yet.
void set_paper_methods(const Arc<2>& arc, double acceleration_sigma_mps2,
                       std::vector<TrajectoryEpoch>& rows);

}  // namespace runcert
