#pragma once

#include <optional>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// One epoch of an arc: a time, and the measured position where it takes part.
template <int Axes>
struct ArcEpoch {
    double time_s = 0.0;
    std::optional<PositionMeasurement<Axes>> measurement;
};

/// The smoothed states of an arc, and what is needed for the joint covariance of two of them.
template <int Axes>
struct SmoothedArc {
    std::vector<StateEstimate<Axes>> states;  ///< given all measurements of the arc
    /// Gain[k] = P[k|k] F' P[k+1|k]^-1, one fewer than states.
    std::vector<StateMatrix<Axes>> gains;
    double innovation_sum = 0.0;  ///< sum of the innovation statistics: the least-squares minimum
    std::int64_t measurements = 0;

    /// Covariance between the errors of states s and e (s <= e):
    /// Gain[s] Gain[s+1] ... Gain[e-1] P[e]. Shape state by state.
    StateMatrix<Axes> cross_covariance(std::size_t s, std::size_t e) const;
};

/// Forward Kalman filter and backward RTS smoother [YSM22] over one arc.
///
/// Times must increase strictly; the first epoch must have a measurement (the prior is vague_prior
/// at it). Throws Failure, naming the time, where a predicted covariance is not positive definite.
template <int Axes>
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const MotionModel& model);

}  // namespace runcert
