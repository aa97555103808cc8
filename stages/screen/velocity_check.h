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
/// velocities. It compares them with the smoothed motion, with the raw displacements, and with the
/// displacements over spans of 3 and 10 s. It marks the epochs whose positions they contradict
/// (reason and hypothesis velocity, horizontal, chi-squared with two degrees of freedom). Only
/// usable rows of an arc are compared and marked, and arcs are never joined. A speed without a
/// course is taken along the smoothed direction of travel.
///
/// An epoch is marked in three cases.
/// - Its displacements from the previous epoch and to the next one both contradict the recorded
///   velocities, in opposite directions. Only an outlier does that.
/// - The smoothed velocity contradicts the recorded one there and at a neighbour in the arc, in the
///   same direction. Drifting positions do that. A recorded velocity that is off at one epoch, as
///   real receivers occasionally give, does not, and so contradicts no position. Within ten rows of
///   an epoch marked for its displacements nothing is marked in this way, because the outlier has
///   bent the smoothed motion. Smooth again without it, and check again.
/// - It lies in the part of a span in which the difference of the two displacements arises, and
///   that difference exceeds the spread of such spans: a slow drift, or a step. Positions before
///   and after do not belong together, so the arc ends there (ramp).
///
/// Rows of a stretch whose delay is beyond `delay_max_s` (`velocity_delays`) are neither compared
/// nor marked, because their velocities belong to another moment. Where these are more than
/// `share_max` of all, the velocities limit no errors and are not a witness.
///
/// `motion` has one element for each row, smoothed from the usable rows. `delay_s` of the
/// comparison is empty if the motion does not determine it: hardly any acceleration, an estimate
/// at the end of the range, or a standard uncertainty over half an interval. The motion is then
/// compared undelayed, with the change of the recorded velocity within delay_max added to the
/// standard deviation.
///
/// `compared` counts the comparisons with the smoothed motion, and `scale_m_s` is the scale of
/// their differences. No comparison is returned where fewer than 30 rows have a recorded velocity.
/// `compared` is 0, and nothing is marked, where the velocities never change (a field that the
/// receiver does not fill) or fewer than 30 can be compared.
VelocityFindings check_velocities(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                                  const VelocityCheckOptions& options);

}  // namespace runcert
