#pragma once

#include <span>
#include <vector>

#include "motion/likelihood.h"

namespace runcert {

/// How strongly the craft accelerated, along a recording.
struct LocalMotion {
    double whole = 0.0;  ///< the single most likely jerk density for the whole recording, m s^-2.5
    double scale = 1.0;  ///< factor on the stated standard deviations (white noise only), estimated
                         ///< with the local densities
    /// For each epoch of each arc, the most likely jerk density (m s^-2.5) within the 20 s around
    /// it.
    std::vector<std::vector<double>> jerk_density;
};

/// Estimates a jerk density that follows the motion. Measurement errors are taken as white noise.
/// For each density of a grid, the log-likelihood of the innovations is summed over the 20 s around
/// every 2 s of an arc. The largest is taken, with a parabola between grid points.
///
/// A prior keeps each density within about a factor of 7 of that of the whole recording. It matters
/// where the data say little. The scale of the stated standard deviations is common to the
/// recording and estimated with the densities.
///
/// A single density fails for a craft that waits for twenty minutes and sails for one. It would say
/// that the craft hardly ever moves, and an estimate based on it smooths the run away.
///
/// `jerk_density` is empty if no innovation tests a model.
template <int Axes>
LocalMotion local_motion(std::span<const std::span<const ArcEpoch<Axes>>> arcs);

}  // namespace runcert
