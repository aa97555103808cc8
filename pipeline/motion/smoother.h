#pragma once

#include <cstdint>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

/// A linear functional of the states s, s+1, ... of an arc: one gradient for each state.
template <int Axes>
using Gradients = std::vector<StateVector<Axes>>;

/// Number of axes that a displacement has: two (east and north), or one (up) where heights stand
/// alone.
template <int Axes>
inline constexpr int speed_axes = Axes == 1 ? 1 : 2;
template <int Axes>
using SpeedVector = Eigen::Matrix<double, speed_axes<Axes>, 1>;
template <int Axes>
using SpeedMatrix = Eigen::Matrix<double, speed_axes<Axes>, speed_axes<Axes>>;

/// The smoothed states of an arc, and the gains needed for the joint covariance of any of them.
template <int Axes>
struct SmoothedArc {
    std::vector<StateEstimate<Axes>> states;  ///< given all measurements of the arc
    /// Gain[k] = P[k|k] F' P[k+1|k]^-1, one fewer than states.
    std::vector<StateMatrix<Axes>> gains;
    double innovation_sum = 0.0;  ///< sum of the innovation statistics: the least-squares minimum
    std::int64_t measurements = 0;
    std::int64_t repaired = 0;       ///< covariances that had to be made positive definite again
    double largest_asymmetry = 0.0;  ///< relative, of a smoothed covariance before it was made
                                     ///< symmetric

    /// Covariance between the errors of states s and e (s <= e): Gain[s] Gain[s+1] ... Gain[e-1]
    /// P[e], a square matrix of the state's size.
    StateMatrix<Axes> cross_covariance(std::size_t s, std::size_t e) const;

    /// Variance of the sum of gradients[i]' state[s + i] over the gradients given, from the joint
    /// posterior of all these states. Backwards in time they are a Markov chain,
    /// x[k] = m[k] + Gain[k] (x[k+1] - m[k+1]) + w, w of variance P[k] - Gain[k] P[k+1] Gain[k]'.
    /// The cost is linear in the number of states.
    double variance(std::size_t s, const Gradients<Axes>& gradients) const;
};

/// Forward Kalman filter and backward RTS smoother [YSM22] over one arc.
///
/// Times must increase strictly, and the first epoch must have a measurement. A predicted
/// covariance that rounding has made indefinite is repaired and counted, if its smallest eigenvalue
/// is above -1e-9 with the diagonal scaled to one. Beyond that it is a Failure that names the time.
template <int Axes>
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

/// Fixed-lag smoother [YSM22]: the state of each epoch k of an arc given the measurements up to
/// epoch k + lag, or to the arc's end if that comes first. This is what an estimate delayed by
/// `lag` epochs would know. Lag 0 is the filter; a lag of the arc's length or more is the smoother.
///
/// It runs one RTS recursion for each epoch, from k + lag back to k, so that an epoch costs `lag`
/// smoother steps. Times must increase strictly, and the first epoch must have a measurement. An
/// arc without epochs gives no states. Repairs and Failures are those of `smooth`.
template <int Axes>
std::vector<StateEstimate<Axes>> smooth_fixed_lag(std::span<const ArcEpoch<Axes>> arc,
                                                  const EstimationModel& model, std::size_t lag);

}  // namespace runcert
