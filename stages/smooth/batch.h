#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

/// Largest number of iterations of a robust solution, which usually takes some tens.
inline constexpr int robust_iterations_allowed = 500;

/// How a long arc is divided. Neighbouring stretches share `overlap` epochs, or more where no
/// measured epoch is available to begin at; 0 < 2 * overlap <= epochs_at_once. Each state comes
/// from a stretch in which it lies at least overlap / 2 epochs from a cut.
///
/// The effect of a cut on a state decays with the larger of the motion's memory (a second or two)
/// and the correlation time of the Gauss-Markov error. The table gives position differences from
/// the uncut solution at 20 Hz with a stated standard deviation of 5 mm. They are the largest over
/// jerk densities from 0.05 to 20 m s^-2.5, with persistent and Singer (3 s) acceleration:
///
/// | epochs from the cut  | 100   | 500   | 1000  | 1500  | 2000  | 2500  |
/// |----------------------|-------|-------|-------|-------|-------|-------|
/// | no error             | 1 um  | 2 pm  | 2 pm  | 2 pm  | 2 pm  | 1 pm  |
/// | steady 8 mm, 10 s    | 0.1 mm| 20 um | 1 um  | 0.1 um| 10 nm | 1 nm  |
/// | 28 mm that grows to 89 mm, 10 s | 30 mm | 3 mm | 0.3 mm | 20 um | 2 um | 0.2 um |
///
/// The default leaves 2,500 epochs, 12.5 correlation times of 10 s at 20 Hz.
struct BatchOptions {
    std::size_t epochs_at_once = 60'000;
    std::size_t overlap = 5'000;
};

template <int Axes>
struct BatchSolution {
    std::vector<StateVector<Axes>> states;  ///< one for each epoch
    std::int64_t stretches = 1;             ///< number of stretches of the arc
};

/// The smoother's problem as one batch least-squares problem, solved by Ceres (sparse normal
/// equations on one thread). It consists of the whitened residuals of prior, measurements and
/// process noise of one arc. The problem is linear. The solver iterates only to refine, starting
/// from a path through measured positions.
///
/// Longer arcs are solved in overlapping stretches, each starting with the vague prior at a
/// measured epoch. Each state is taken from the stretch in which it lies farthest from a cut.
///
/// Times must increase strictly, and the first epoch must have a measurement. Failure if Ceres
/// reports no convergence.
template <int Axes>
BatchSolution<Axes> solve_batch(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                const BatchOptions& options = {});

template <int Axes>
struct RobustSolution {
    std::vector<StateVector<Axes>> states;  ///< one for each epoch
    /// The Cauchy weight 1 / (1 + r'r / scale^2), in (0, 1], of each epoch's whitened residual r at
    /// the solution. Empty if the epoch has no measurement.
    std::vector<std::optional<double>> weights;
    std::int64_t stretches = 1;
    std::int64_t iterations = 0;  ///< total over all stretches
    bool converged = true;        ///< otherwise states and weights are empty
};

/// The batch problem with a Cauchy loss on each measurement's whitened residual r (all axes of an
/// epoch as one block): scale^2 ln(1 + r'r / scale^2) instead of r'r, with `scale` in standard
/// deviations. It is not linear. It is iterated along the chain of states (RobustChain) from
/// `start` until no improvement is left. `start` has one state for each epoch, such as the solution
/// of the screened arc.
///
/// Not converged where that takes more than `robust_iterations_allowed`.
template <int Axes>
RobustSolution<Axes> solve_robust(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                  double scale, std::span<const StateVector<Axes>> start,
                                  const BatchOptions& options = {});

}  // namespace runcert
