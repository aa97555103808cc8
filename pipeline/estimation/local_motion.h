#pragma once

#include <span>
#include <vector>

#include "estimation/likelihood.h"

namespace runcert {

/// How hard the craft moved, along a recording.
struct LocalMotion {
    double whole = 0.0;  ///< the one jerk density most likely for all of it, m s^-2.5
    double scale =
        1.0;  ///< of the stated standard deviations, white noise alone, with the local ones
    /// For each epoch of each arc the jerk density that is most likely for the 20 s about it.
    std::vector<std::vector<double>> jerk_density;
};

/// The jerk density that follows the motion: of white noise about the positions and of each density
/// of a grid the likelihood of the innovations is summed over the 20 s about each 2 s of an arc,
/// and the largest taken (by a parabola between the points of the grid), with a prior that a
/// density is within a factor of 7 of the one for the whole, which counts where the data say
/// little. The scale of the stated standard deviations is common to the recording and estimated
/// with them.
///
/// A craft that waits for twenty minutes and sails for one says of one density for both that it
/// hardly ever moves; an estimate that believes it smooths the run away.
///
/// Nothing (`jerk_density` empty) where no innovation tests a model.
template <int Axes>
LocalMotion local_motion(std::span<const std::span<const ArcEpoch<Axes>>> arcs);

}  // namespace runcert
