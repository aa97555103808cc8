#pragma once

#include <cstdint>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// A linear functional of the states s, s+1, ... of an arc: one gradient for each.
template <int Axes>
using Gradients = std::vector<StateVector<Axes>>;

/// The smoothed states of an arc, and what is needed for the joint covariance of any of them.
template <int Axes>
struct SmoothedArc {
    std::vector<StateEstimate<Axes>> states;  ///< given all measurements of the arc
    /// Gain[k] = P[k|k] F' P[k+1|k]^-1, one fewer than states.
    std::vector<StateMatrix<Axes>> gains;
    double innovation_sum = 0.0;  ///< sum of the innovation statistics: the least-squares minimum
    std::int64_t measurements = 0;
    std::int64_t repaired = 0;       ///< covariances that were made positive definite again
    double largest_asymmetry = 0.0;  ///< of a smoothed covariance before symmetrising, relative

    /// Covariance between the errors of states s and e (s <= e):
    /// Gain[s] Gain[s+1] ... Gain[e-1] P[e]. Shape state by state.
    StateMatrix<Axes> cross_covariance(std::size_t s, std::size_t e) const;

    /// Variance of the sum of gradients[i]' state[s + i] over the gradients given, from the joint
    /// posterior of all these states: backwards in time they are a Markov chain,
    /// x[k] = m[k] + Gain[k] (x[k+1] - m[k+1]) + w, w of variance P[k] - Gain[k] P[k+1] Gain[k]'.
    /// Linear in the number of states.
    double variance(std::size_t s, const Gradients<Axes>& gradients) const;
};

/// Forward Kalman filter and backward RTS smoother [YSM22] over one arc.
///
/// Times must increase strictly; the first epoch must have a measurement. A predicted covariance
/// that has stopped being positive definite within rounding (its smallest eigenvalue, with the
/// diagonal scaled to one, above -1e-9) is repaired and counted; further off it is a Failure that
/// names the time.
template <int Axes>
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

}  // namespace runcert
