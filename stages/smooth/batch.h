#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

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

}  // namespace runcert
