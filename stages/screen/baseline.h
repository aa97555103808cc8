#pragma once

#include "motion/epoch_motion.h"
#include "stages/screen/screen.h"
#include "stages/screen/test_plan.h"

namespace runcert {

/// Compares two receivers on one craft, each screened on its own, as witnesses of each other.
///
/// Epochs are compared that are usable in both at the same GPS time (to 1 us). The vector from the
/// first antenna to the second, along and across the track of the first, and its length hardly
/// change. Both are tested as the positions of an arc are (`adapt`), with noise estimated from
/// themselves, and a motion model that allows for changes of drift angle and attitude.
///
/// The vector is tested where the track shows the craft's attitude. The craft must be faster than
/// 1 m/s and ten standard uncertainties of its velocity. It must not turn so tightly that the track
/// turns by more than 0.05 rad over the distance between the antennas. The length is tested
/// everywhere, in space where both recordings have heights, and otherwise horizontally.
///
/// Which of the two receivers errs cannot be decided. Findings are marked in both, with reason and
/// hypothesis baseline. `estimated` is the error of that receiver if it is the one that errs.
/// Epochs of either receiver between two compared ones are as doubtful as these, if one of them is
/// contradicted or a step lies between them. A step ends the arc in both. So does the beginning of
/// a drift, which leaves nothing out here: displacements show what it leaves
/// (`check_displacements`).
///
/// Fills `comparison.baseline` of both tables with the median and robust standard deviation of the
/// length. Nothing is compared where a recording's time is relative, or only one is in an
/// engineering CRS. Two engineering CRSs are assumed to be the same. A constant difference of the
/// two clocks is a distance along the track proportional to the speed. It is not an error of
/// positions and is not marked, but increases the standard deviation of the length.
///
/// `comparison.same_errors` says that one of the two was made from the other (`made_from`).
///
/// Returns whether anything was marked, after which the arcs must be finished again.
/// `motion_of_first` has one entry for each row of the first.
bool compare_receivers(ScreenedTable& first, ScreenedTable& second, const Motion& motion_of_first,
                       const TestPlan& plan, const ScreenConfig& config);

}  // namespace runcert
