#pragma once

#include <optional>
#include <vector>

#include "motion/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// Parameters of the check against recorded velocities.
struct VelocityCheckOptions {
    /// The delay is searched between minus and plus this. 0 takes the velocities as undelayed.
    double delay_max_s = 1.0;
    /// If a larger fraction of the epochs is contradicted, the velocities are unfit.
    double share_max = 0.05;
    double nominal_interval_s = 0.0;  ///< between epochs
    double jerk_density = 0.0;        ///< m s^-2.5, of the motion between velocities
    bool vertical_measured = false;
    double position_resolution_m = 0.0;
    /// Upper limit on the probability of marking one good epoch, for normal errors.
    double test_size = 1e-9;
};

/// The result of comparing recorded velocities with positions.
struct VelocityFindings {
    std::optional<VelocityComparison> comparison;
    std::vector<VelocityErrors> errors;  ///< of each group of axes, where they limit anything
};

/// Checks positions against the recorded velocities as a witness. It estimates the delay of the
/// velocities, and tests displacements and the smoothed motion against them
/// (`check_displacements`; reason and hypothesis velocity, horizontal). Only usable rows of an arc
/// are compared and marked, and arcs are never joined. A speed without a course is taken along the
/// smoothed direction of travel. Within one interval the delay is as uncertain as estimated; over
/// spans of seconds also by a quarter of it, as a filter's lag varies.
///
/// Rows of a stretch whose delay is beyond `delay_max_s` (`velocity_delays`) are neither compared
/// nor marked, because their velocities belong to another moment. Where these are more than
/// `share_max` of all, the velocities limit no errors and are not a witness.
///
/// `motion` has one element for each row, smoothed from the usable rows. `delay_s` of the
/// comparison is empty if the motion does not determine it: hardly any acceleration, an estimate
/// at the end of the range, or a standard uncertainty over half an interval. The velocities are
/// then taken as undelayed, with the standard uncertainty of a delay anywhere in the range.
///
/// `compared` counts the comparisons with the smoothed motion, and `scale_m_s` is the scale of
/// their differences. No comparison is returned where fewer than 30 rows have a recorded velocity.
/// `compared` is 0, and nothing is marked, where the velocities never change (a field that the
/// receiver does not fill) or fewer than 30 can be compared.
VelocityFindings check_velocities(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                                  const VelocityCheckOptions& options);

}  // namespace runcert
