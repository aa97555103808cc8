#pragma once

#include <span>
#include <vector>

#include "estimation/smoother.h"

namespace runcert {

/// The smoother's problem as one batch least squares, solved by Ceres (sparse normal equations on
/// one thread): the whitened residuals of prior, measurements and process noise of one arc. The
/// problem is linear; the solver iterates only to refine. Returns the states, one for each epoch.
///
/// Throws Failure where Ceres reports no convergence.
template <int Axes>
std::vector<StateVector<Axes>> solve_batch(std::span<const ArcEpoch<Axes>> arc,
                                           const MotionModel& model);

}  // namespace runcert
