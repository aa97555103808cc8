#pragma once

#include "estimation/smoother.h"

namespace runcert {

/// The smoother of one arc as the linear operation it is: with gains computed once, it smooths
/// any positions measured at the same epochs with the same covariances, at a small part of the
/// cost of `smooth`.
template <int Axes>
class LinearSmoother {
  public:
    /// Every epoch of the arc must have a measurement.
    LinearSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    /// The smoothed positions, one for each epoch; after bridged steps without the offsets, so that
    /// differences are displacements (`displacement` of speed.h).
    std::vector<PositionVector<Axes>> operator()(
        std::span<const PositionVector<Axes>> measured) const;

  private:
    LinearSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                   SmoothedArc<Axes> smoothed);

    KalmanFilter<Axes> filter_;
    std::vector<StateMatrix<Axes>> transitions_;  ///< from each epoch to the next
    std::vector<typename KalmanFilter<Axes>::GainMatrix> filter_gains_;
    std::vector<StateMatrix<Axes>> smoother_gains_;
    std::vector<BridgedStep> bridged_;
};

}  // namespace runcert
