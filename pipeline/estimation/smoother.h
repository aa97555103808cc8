#pragma once

#include <cstdint>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// A linear functional of the states s, s+1, ... of an arc: one gradient for each.
template <int Axes>
using Gradients = std::vector<StateVector<Axes>>;

/// The axes that a displacement is counted along: east and north, or up where heights are alone.
template <int Axes>
inline constexpr int speed_axes = Axes == 1 ? 1 : 2;
template <int Axes>
using SpeedVector = Eigen::Matrix<double, speed_axes<Axes>, 1>;
template <int Axes>
using SpeedMatrix = Eigen::Matrix<double, speed_axes<Axes>, speed_axes<Axes>>;

/// The same of a vector along these axes: a column for each of its coordinates.
template <int Axes>
using CountedGradients = std::vector<Eigen::Matrix<double, state_size<Axes>, speed_axes<Axes>>>;

/// A step of an arc over which the positions jump by an unknown offset. What the craft itself moved
/// over it, each axis for itself, is told by velocity and acceleration at its two ends: the mean of
/// the motion model under these four is their sum with the factors here. Where acceleration
/// persists, it is dt (v + v') / 2 - dt^2 (a' - a) / 12, with variance q dt^5 / 720 about it, q
/// the square of the jerk density.
struct BridgedStep {
    std::size_t epoch = 0;  ///< the first of the offset positions
    double velocity_before_s = 0.0;
    double acceleration_before_s2 = 0.0;
    double velocity_after_s = 0.0;
    double acceleration_after_s2 = 0.0;
    double variance_m2 = 0.0;  ///< of the motion about its mean, independent of all states

    /// The mean motion (m), given the states before and after the step.
    template <int Axes>
    PositionVector<Axes> motion(const StateVector<Axes>& before,
                                const StateVector<Axes>& after) const {
        return velocity_before_s * before.template segment<Axes>(Axes) +
               acceleration_before_s2 * before.template segment<Axes>(2 * Axes) +
               velocity_after_s * after.template segment<Axes>(Axes) +
               acceleration_after_s2 * after.template segment<Axes>(2 * Axes);
    }
};

/// The smoothed states of an arc, and what is needed for the joint covariance of any of them.
template <int Axes>
struct SmoothedArc {
    std::vector<StateEstimate<Axes>> states;  ///< given all measurements of the arc
    /// Gain[k] = P[k|k] F' P[k+1|k]^-1, one fewer than states.
    std::vector<StateMatrix<Axes>> gains;
    std::vector<BridgedStep> bridged;  ///< in order of time
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

    /// The same for a vector along the counted axes.
    SpeedMatrix<Axes> covariance(std::size_t s, const CountedGradients<Axes>& gradients) const;

    /// The bridged steps between epochs s and e: those with s < epoch <= e.
    std::span<const BridgedStep> bridged_between(std::size_t s, std::size_t e) const;
};

/// Forward Kalman filter and backward RTS smoother [YSM22] over one arc.
///
/// From a bridged step on, smoothed positions are offset as the measured ones are: what spans the
/// step is for speed.h to say.
///
/// Times must increase strictly; the first epoch must have a measurement. A predicted covariance
/// that has stopped being positive definite within rounding (its smallest eigenvalue, with the
/// diagonal scaled to one, above -1e-9) is repaired and counted; further off it is a Failure that
/// names the time.
template <int Axes>
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

/// Fixed-lag smoother [YSM22]: the state of each epoch k of an arc given the measurements up to
/// epoch k + lag, or to the arc's end where that comes first. What an estimate with a delay of so
/// many epochs would know; lag 0 is the filter, a lag of the arc's length or more the smoother.
///
/// One RTS recursion for each epoch, from k + lag back to k: the cost is that of `lag` smoother
/// steps an epoch. Times must increase strictly; the first epoch must have a measurement. An arc
/// without an epoch has no states. Repairs and Failures are those of `smooth`.
template <int Axes>
std::vector<StateEstimate<Axes>> smooth_fixed_lag(std::span<const ArcEpoch<Axes>> arc,
                                                  const EstimationModel& model, std::size_t lag);

}  // namespace runcert
