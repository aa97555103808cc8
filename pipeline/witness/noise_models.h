#pragma once

#include <vector>

#include "estimation/noise_fit.h"
#include "schemas/attempt/attempt.h"
#include "schemas/trajectory/trajectory.h"
#include "witness/arcs.h"

namespace runcert {

/// The noise model that a trajectory was estimated with.
EstimationModel model_of(const NoiseSummary& noise);

/// The models of the motion that an attempt's choice allows.
NoiseFitOptions::Motion motion_of(MotionChoice choice);

/// What an estimate rests on after this fit.
NoiseBasis basis_of(NoiseFit::Status status);

/// The horizontal (Axes 2) or vertical (1) noise that a trajectory says it was estimated with.
/// Failure without heights for the vertical one.
template <int Axes>
const NoiseSummary& noise_of(const TrajectoryTable& trajectory);

/// The arcs of a screened table with the jerk densities that the trajectory was estimated with.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& screened, const TrajectoryTable& trajectory);

/// The models that the recording allows, with their shares; that of the trajectory alone where
/// nothing was fitted.
std::vector<WeightedModel> posterior_of(const NoiseSummary& noise);

}  // namespace runcert
