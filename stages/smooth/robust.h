#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "motion/kalman.h"
#include "motion/sections.h"

namespace runcert {

/// Largest number of passes along the chain of a robust solution, which usually takes about ten.
inline constexpr int robust_passes_allowed = 500;

template <int Axes>
struct RobustSolution {
    std::vector<StateVector<Axes>> states;  ///< one for each epoch
    /// The Cauchy weight 1 / (1 + r'r / scale^2), in (0, 1], of each epoch's whitened residual r at
    /// the solution. Empty if the epoch has no measurement.
    std::vector<std::optional<double>> weights;
    std::int64_t passes = 0;  ///< along the chains of all sections
    bool converged = true;    ///< otherwise states and weights are empty
};

/// The smoother's least-squares problem with a Cauchy loss on each measurement's whitened residual
/// r (all axes of an epoch as one block): scale^2 ln(1 + r'r / scale^2) instead of r'r, with
/// `scale` in standard deviations.
///
/// It is not linear, and iterated from `start`, which has one state for each epoch, such as the
/// solution of the screened arc. Each pass is one chain (chain.h). The first gives every
/// measurement the weight of its residual [HW77], which cannot raise the cost. The following ones
/// replace each by that whose square has slope and curvature of the loss, as in Newton's method.
/// Where such a step would raise the cost it is shortened, and at last replaced by one of weights.
///
/// Sections (sections.h) are solved on their own, in parallel. Not converged where one takes more
/// than the passes allowed.
template <int Axes>
RobustSolution<Axes> solve_robust(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                  double scale, std::span<const StateVector<Axes>> start,
                                  std::span<const ArcSection> sections,
                                  std::int64_t passes_allowed = robust_passes_allowed);

}  // namespace runcert
