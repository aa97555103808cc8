#pragma once

#include <vector>

#include "estimation/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// What a craft of a class can do. A limit of 0 is none.
struct PhysicalLimits {
    double acceleration_m_s2 = 0.0;  ///< horizontal
    double jerk_m_s3 = 0.0;          ///< horizontal
    double vertical_rate_m_s = 0.0;  ///< up or down
    double test_size = 1e-9;         ///< probability of marking an epoch that is at the limit
};

/// Marks usable epochs whose smoothed motion exceeds a limit by more than its own uncertainty
/// allows: reason physical_limit; hypothesis acceleration, jerk or vertical_rate, the first of them
/// that is exceeded; statistic the figure (m/s^2, m/s^3, m/s), threshold = limit + allowance. The
/// allowance is the one-sided normal quantile of `test_size` times the standard uncertainty. An
/// epoch at the threshold is kept. Rows that are not usable, have no arc or no motion are left as
/// they are, and so are the arcs' numbers and breaks. The last test: nothing is estimated anew.
///
/// Acceleration is the magnitude of the horizontal one, its uncertainty that along its direction.
/// Jerk is the difference of the accelerations of an epoch and the one before it in its arc that
/// this test kept, over the time between; its uncertainty is bounded by the sum of the two standard
/// uncertainties along the difference, because their correlation is not given. The later epoch is
/// the one marked.
///
/// Returns the limits, the largest figures among the epochs kept (jerk being that tested) and how
/// many epochs were marked. `motion` has one entry for each row.
LimitComparison check_limits(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                             const PhysicalLimits& limits);

}  // namespace runcert
