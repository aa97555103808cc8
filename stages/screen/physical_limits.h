#pragma once

#include <vector>

#include "motion/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// The limits of a class of craft. 0 means no limit.
struct PhysicalLimits {
    double acceleration_m_s2 = 0.0;  ///< horizontal
    double jerk_m_s3 = 0.0;          ///< horizontal
    double vertical_rate_m_s = 0.0;  ///< up or down
    double test_size = 1e-9;         ///< probability of marking an epoch that is exactly at the
                                     ///< limit
};

/// Marks usable epochs whose smoothed motion exceeds a limit by more than its own uncertainty
/// allows. The reason is physical_limit; the hypothesis is the first exceeded of acceleration, jerk
/// and vertical_rate. The statistic is the figure (m/s^2, m/s^3, m/s), and the threshold is
/// limit + allowance. The allowance is the one-sided normal quantile of `test_size` times the
/// standard uncertainty. An epoch at the threshold is kept. Rows that are not usable, or have no
/// arc or motion, stay unchanged, as do the numbers and breaks of arcs. This is the last test, and
/// nothing is re-estimated.
///
/// Acceleration is the horizontal magnitude, with its uncertainty along its direction. Jerk is the
/// difference of the accelerations of an epoch and the previous one in its arc that this test kept,
/// divided by the time between. Its uncertainty is bounded by the sum of the two standard
/// uncertainties along the difference, because their correlation is not given. The later epoch is
/// marked.
///
/// Returns the limits, the largest figures among the epochs kept (for jerk, as tested) and the
/// number of marked epochs. `motion` has one entry for each row.
LimitComparison check_limits(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                             const PhysicalLimits& limits);

}  // namespace runcert
