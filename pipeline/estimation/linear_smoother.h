#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "estimation/smoother.h"

namespace runcert {

/// One number of each of so many recordings: here always a coordinate, in m.
template <int Lanes>
using Lane = Eigen::Array<double, Lanes, 1>;

/// The positions of so many recordings at one epoch, by axis.
template <int Axes, int Lanes>
using LanePositions = std::array<Lane<Lanes>, static_cast<std::size_t>(Axes)>;

/// The smoother of one arc as the linear operation it is: with gains computed once, it smooths
/// any positions measured at the same epochs with the same covariances, at a small part of the
/// cost of `smooth`. Positions are in m, along the axes of the arc (east and north, or up alone).
///
/// The forward pass is the filter's; backward go the scores of the measurements from each epoch on
/// ([JP98], as in `ArcDiagnosis`) in place of the smoothed states: with them each
/// smoothed position is the predicted one and a few rows of its covariance, where the RTS form
/// needs a gain of the state's whole size at every epoch.
template <int Axes>
class LinearSmoother {
  public:
    /// Every epoch of the arc must have a measurement. Failure as `smooth`.
    LinearSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    /// The smoothed positions, one for each epoch; after bridged steps without the offsets, so that
    /// differences are displacements (`displacement` of speed.h).
    std::vector<PositionVector<Axes>> operator()(
        std::span<const PositionVector<Axes>> measured) const;

    /// The same of several recordings side by side, each to the bit as by itself: what is loaded of
    /// the gains serves them all.
    template <int Lanes>
    std::vector<LanePositions<Axes, Lanes>> smooth_lanes(
        std::span<const LanePositions<Axes, Lanes>> measured) const;

  private:
    static constexpr auto axes = static_cast<std::size_t>(Axes);
    static constexpr std::size_t size = 4 * axes;
    using Rows = std::array<std::array<double, size>, axes>;

    /// What a smoothed position takes of an epoch.
    struct Epoch {
        std::size_t step = 0;                                 ///< to the next epoch, in `steps_`
        Rows gain{};                                          ///< transposed
        std::array<std::array<double, axes>, axes> weight{};  ///< inverse innovation covariance
        Rows position{};  ///< of the predicted state's covariance, the rows of the position
    };
    /// A bridged step with the predicted covariances at its two ends.
    struct Bridge {
        BridgedStep step;
        StateMatrix<Axes> before = StateMatrix<Axes>::Zero();
        StateMatrix<Axes> after = StateMatrix<Axes>::Zero();
    };
    template <int Lanes>
    struct Pass;

    std::vector<Epoch> epochs_;
    std::vector<kernel::StepNumbers<double>> steps_;  ///< distinct ones
    std::vector<Bridge> bridges_;
};

}  // namespace runcert
