#pragma once

#include "estimation/epoch_motion.h"
#include "stages/screen/screen.h"
#include "stages/screen/test_plan.h"

namespace runcert {

/// Two receivers on one craft, each screened by itself, as witnesses of one another.
///
/// Compared are the epochs that both have usable at the same GPS time (to 1 us). The vector from
/// the first antenna to the second, along and across the track of the first, and its length, hardly
/// change: both are tested as the positions of an arc are (`adapt`), with noise estimated from
/// themselves, and a motion that allows for changes of drift angle and attitude. The vector is
/// tested where the track tells how the craft stands: faster than 1 m/s and ten standard
/// uncertainties of its velocity, and in no turn so tight that the track turns by more than 0.05
/// rad over the distance of the antennas. The length is tested everywhere; it is that in space
/// where both recordings have heights, else in the plane.
///
/// Which of the two is wrong cannot be told: what is found is marked in both, with reason and
/// hypothesis baseline, and `estimated` the error of that receiver were it the wrong one. Epochs of
/// either receiver between two compared ones are as doubtful as these where one of them is wrong,
/// or a step lies between them. A step ends the arc in both, and so does the beginning of a drift,
/// which leaves nothing out here: displacements show what it leaves (`check_displacements`).
///
/// Fills `comparison.baseline` of both: median and robust standard deviation of the length,
/// nothing compared where a recording's time is relative, or one is in an engineering CRS and the
/// other is not. Engineering CRSs are taken to be the same one. A constant difference of the two
/// clocks is a distance along the track in proportion to the speed: it is not an error of
/// positions, is not marked, and shows in the standard deviation of the length.
///
/// `comparison.same_errors`: one of the two was made from the other (`share_errors`).
///
/// Returns whether anything was marked: the arcs must then be finished anew. `motion_of_first` has
/// one entry for each row of the first.
bool compare_receivers(ScreenedTable& first, ScreenedTable& second, const Motion& motion_of_first,
                       const TestPlan& plan, const ScreenConfig& config);

}  // namespace runcert
