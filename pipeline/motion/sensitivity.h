#pragma once

#include "motion/smoother.h"

namespace runcert {

/// Sensitivities of a linear functional of the smoothed states of an arc to each measured position.
///
/// `gradients` are those of the functional, from state `s` on. The result has one vector for each
/// epoch of the arc, zero where it has no measurement. The derivative of the posterior mean with
/// respect to a measurement is its covariance with the measured quantity times the measurement's
/// weight. The cost is linear in the epochs.
template <int Axes>
std::vector<PositionVector<Axes>> sensitivities(std::span<const ArcEpoch<Axes>> arc,
                                                const EstimationModel& model,
                                                const SmoothedArc<Axes>& smoothed, std::size_t s,
                                                const Gradients<Axes>& gradients);

/// Variance of the sum over the epochs of weight times a Gauss-Markov error of the measured
/// positions, axis by axis. In m^2 for dimensionless weights. The cost is linear in the epochs.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, const GaussMarkovError& error,
                         std::span<const PositionVector<Axes>> weights);

/// The same variance for the white noise of the measurements, whose covariances are the stated ones
/// times `scale` squared.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, double scale,
                         std::span<const PositionVector<Axes>> weights);

}  // namespace runcert
