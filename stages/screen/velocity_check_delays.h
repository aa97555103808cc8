#pragma once

#include <vector>

#include "estimation/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// The delays of the recorded speeds behind those of the smoothed motion, with a course or without,
/// along the recording (`velocities::delays_along`), and whether they are beyond `delay_max_s`: a
/// second at least. `motion` has one element for each row.
std::vector<VelocityDelay> velocity_delays(const std::vector<ScreenedEpoch>& rows,
                                           const Motion& motion, double delay_max_s);

/// The length of the horizontal recorded velocity, or the recorded speed (m/s).
std::optional<double> recorded_length(const RecordedVelocity& row);

/// Part of the rows with a recorded velocity that are chosen; 0 where there are none.
double share_of(const std::vector<ScreenedEpoch>& rows, const std::vector<bool>& chosen);

/// Part of the rows with a recorded velocity, where the motion is known, that it contradicts: those
/// of other moments, those marked for it, and those whose speed is none that the motion has within
/// a second and a half, by more than velocities of receivers were seen to err.
double contradicted_share(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                          const std::vector<bool>& of_other_moments);

}  // namespace runcert
