#pragma once

#include <vector>

#include "motion/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// The delays along the recording of the recorded speeds, with or without a course, relative to the
/// smoothed motion (`velocities::delays_along`). Each says whether it is beyond `delay_max_s`, or
/// one second if that is longer. `motion` has one element for each row.
std::vector<VelocityDelay> velocity_delays(const std::vector<ScreenedEpoch>& rows,
                                           const Motion& motion, double delay_max_s);

/// The magnitude of the horizontal recorded velocity, or the recorded speed (m/s).
std::optional<double> recorded_length(const RecordedVelocity& row);

/// Fraction of the rows with a recorded velocity that are chosen. 0 where there are none.
double share_of(const std::vector<ScreenedEpoch>& rows, const std::vector<bool>& chosen);

/// Fraction of the rows with a recorded velocity and known motion that contradict it. These are
/// rows of other moments, rows marked for it, and rows whose speed is not found in the motion
/// within a second and a half, by more than receivers' velocities have been seen to err.
double contradicted_share(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                          const std::vector<bool>& of_other_moments);

}  // namespace runcert
