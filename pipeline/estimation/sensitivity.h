#pragma once

#include "estimation/smoother.h"

namespace runcert {

/// By how much each measured position of an arc moves a linear functional of its smoothed states.
///
/// `gradients` are the functional's, from state `s` on; the answer has one vector for each epoch of
/// the arc, zero where it has no measurement. The derivative of the posterior mean by a measurement
/// is its covariance with the measured quantity times the measurement's weight. Linear in the
/// epochs.
template <int Axes>
std::vector<PositionVector<Axes>> sensitivities(std::span<const ArcEpoch<Axes>> arc,
                                                const EstimationModel& model,
                                                const SmoothedArc<Axes>& smoothed, std::size_t s,
                                                const Gradients<Axes>& gradients);

/// Variance of the sum over the epochs of weight times a Gauss-Markov error of the measured
/// positions, axis by axis; in m^2 for weights without a unit. Linear in the epochs.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, const GaussMarkovError& error,
                         std::span<const PositionVector<Axes>> weights);

/// The same of the white noise of the measurements: the stated covariances times `scale` squared.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, double scale,
                         std::span<const PositionVector<Axes>> weights);

}  // namespace runcert
