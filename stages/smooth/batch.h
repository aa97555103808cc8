#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// At most so many epochs are solved at once.
inline constexpr std::size_t batch_epochs_at_once = 60'000;

/// A robust solution takes some tens of iterations.
inline constexpr int robust_iterations_allowed = 500;

/// How a long arc is cut. Neighbouring stretches have `overlap` epochs in common, more where no
/// measured epoch lies there to begin with; 0 < 2 * overlap <= epochs_at_once. A state taken lies
/// overlap / 2 epochs or more from a cut.
///
/// What a cut does to a state dies away with the larger of the motion's memory (a second or two)
/// and the correlation time of the Gauss-Markov error. Position differences from the uncut
/// solution at 20 Hz, stated standard deviation 5 mm, the largest of jerk densities from 0.05 to 20
/// m s^-2.5 with persistent and Singer (3 s) acceleration:
///
/// | epochs from the cut  | 100   | 500   | 1000  | 1500  | 2000  | 2500  |
/// |----------------------|-------|-------|-------|-------|-------|-------|
/// | no error             | 1 um  | 2 pm  | 2 pm  | 2 pm  | 2 pm  | 1 pm  |
/// | steady 8 mm, 10 s    | 0.1 mm| 20 um | 1 um  | 0.1 um| 10 nm | 1 nm  |
/// | bounding 20 mm, 0.5 s to 10 s | 30 mm | 3 mm | 0.3 mm | 20 um | 2 um | 0.2 um |
///
/// The default leaves 2,500 epochs, 12.5 correlation times of 10 s at 20 Hz.
struct BatchOptions {
    std::size_t epochs_at_once = batch_epochs_at_once;
    std::size_t overlap = 5'000;
};

template <int Axes>
struct BatchSolution {
    std::vector<StateVector<Axes>> states;  ///< one for each epoch
    std::int64_t stretches = 1;             ///< how many the arc was cut into
};

/// The smoother's problem as one batch least squares, solved by Ceres (sparse normal equations on
/// one thread): the whitened residuals of prior, measurements and process noise of one arc. The
/// offset of a bridged step is an unknown beside the states, with a weak prior of its own. The
/// problem is linear; the solver iterates only to refine, from a path through measured positions.
///
/// Longer arcs are solved in overlapping stretches, each begun with the vague prior at a measured
/// epoch; each state is taken from the stretch in which it lies farthest from a cut.
///
/// Times must increase strictly; the first epoch must have a measurement. Throws Failure where
/// Ceres reports no convergence.
template <int Axes>
BatchSolution<Axes> solve_batch(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                const BatchOptions& options = {});

template <int Axes>
struct RobustSolution {
    std::vector<StateVector<Axes>> states;  ///< one for each epoch
    /// The Cauchy weight 1 / (1 + r'r / scale^2) of each epoch's whitened residual r at the
    /// solution, in (0, 1]; empty where the epoch has no measurement.
    std::vector<std::optional<double>> weights;
    std::int64_t stretches = 1;
    std::int64_t iterations = 0;  ///< of all stretches together
    bool converged = true;        ///< if not, states and weights are empty
};

/// The same problem with a Cauchy loss on each measurement's whitened residual r (all axes of an
/// epoch as one block): scale^2 ln(1 + r'r / scale^2) in place of r'r, `scale` in standard
/// deviations. Not linear: iterated along the chain of states (RobustChain) from `start` (one state
/// for each epoch, such as the solution of the screened arc) until nothing is left to gain.
///
/// Not converged where that takes more than `robust_iterations_allowed`.
template <int Axes>
RobustSolution<Axes> solve_robust(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                                  double scale, std::span<const StateVector<Axes>> start,
                                  const BatchOptions& options = {});

}  // namespace runcert
