#pragma once

#include <optional>
#include <vector>

#include "estimation/epoch_motion.h"
#include "schemas/screened/screened.h"

namespace runcert {

struct VelocityCheckOptions {
    /// The delay is looked for between minus and plus this; 0 takes the velocities as undelayed.
    double delay_max_s = 1.0;
    /// Where a larger part of the epochs is contradicted, the velocities are unfit.
    double share_max = 0.05;
    double nominal_interval_s = 0.0;  ///< between epochs
    double jerk_density = 0.0;        ///< m s^-2.5, of the motion between velocities
    bool vertical_measured = false;
    double position_resolution_m = 0.0;
    /// Bound on the probability that one good epoch is marked, for normal errors.
    double test_size = 1e-9;
};

/// What the recorded velocities say.
struct VelocityFindings {
    std::optional<VelocityComparison> comparison;
    std::vector<VelocityErrors> errors;  ///< of each group of axes, where they bound anything
};

/// The recorded velocities as a witness of the positions: estimates by how much they lag, compares
/// them with the smoothed motion, with the raw displacements and with the displacements over spans
/// of 3 and 10 s, and marks the epochs whose positions they contradict (reason and hypothesis
/// velocity, horizontal, chi-squared with two degrees of freedom). Only usable rows of an arc are
/// compared and marked; arcs are never joined. A speed without a course counts along the smoothed
/// direction of travel.
///
/// An epoch is marked in three cases.
/// - Its displacements from the epoch before and to the one after both contradict the recorded
///   velocities, in opposite directions: only an outlier does that.
/// - The smoothed velocity contradicts the recorded one there and at a neighbour of the arc, in
///   one direction: positions that drift do that. A recorded velocity wrong for one epoch, as real
///   receivers give now and then, does not, and does not contradict a position. Within ten
///   rows of an epoch marked for its displacements nothing is marked so, because the outlier has
///   bent the smoothed motion: smooth again without it, and check again.
/// - It lies in the part of a span in which the difference of the two displacements comes about,
///   where that difference is beyond what such spans differ by: a slow drift, or a step. Positions
///   before and after do not belong together: the arc ends there (ramp).
///
/// Rows of a stretch whose delay is beyond `delay_max_s` (`velocity_delays`) are neither compared
/// nor marked: their velocities are of another moment. Where these are more than `share_max` of
/// all, the velocities bound no errors, and are no witness.
///
/// `motion` has one element for each row, smoothed from the usable rows. `delay_s` of the
/// comparison is empty where the motion does not tell it: hardly any acceleration, an estimate at
/// the limit of the range, or a standard uncertainty over half an interval. The motion is then
/// compared undelayed, with what the recorded velocity changes by within delay_max added to the
/// standard deviation. `compared` counts the comparisons with the smoothed motion, `scale_m_s` is
/// of their differences. Nothing is answered where fewer than 30 rows have a recorded velocity;
/// `compared` is 0, and nothing marked, where they never change (a field that the receiver does not
/// fill) or fewer than 30 can be compared.
VelocityFindings check_velocities(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                                  const VelocityCheckOptions& options);

}  // namespace runcert
