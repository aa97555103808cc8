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

/// Fraction of the rows with a recorded velocity that are chosen. 0 if there are none.
double share_of(const std::vector<ScreenedEpoch>& rows, const std::vector<bool>& chosen);

/// Fraction of the rows with a recorded velocity that contradict the motion. Rows of other moments
/// and rows marked for their velocity do. So do rows whose speed lies outside the range of the
/// smoothed speeds within 1.5 s. That range is widened by 3 standard deviations and by twice what
/// receivers showed. Rows without known motion count only if they contradict it.
double contradicted_share(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                          const std::vector<bool>& of_other_moments);

}  // namespace runcert
