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

}  // namespace runcert
