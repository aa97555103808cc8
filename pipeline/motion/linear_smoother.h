#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "motion/smoother.h"

namespace runcert {

/// One number for each of `Lanes` recordings: here always a coordinate, in m.
template <int Lanes>
using Lane = Eigen::Array<double, Lanes, 1>;

/// The positions of `Lanes` recordings at one epoch, by axis.
template <int Axes, int Lanes>
using LanePositions = std::array<Lane<Lanes>, static_cast<std::size_t>(Axes)>;

/// The smoother of one arc as a linear operation. It computes the gains once and then smooths any
/// positions measured at the same epochs with the same covariances, at a small fraction of the cost
/// of `smooth`. Positions are in m, along the axes of the arc (east and north, or up alone).
///
/// The forward pass is the filter's. The backward pass carries the scores of the measurements from
/// each epoch on ([JP98], as in `ArcDiagnosis`) instead of smoothed states. Each smoothed position
/// then needs only the predicted one and a few rows of its covariance. The RTS form needs a gain of
/// the full state size at every epoch.
template <int Axes>
class LinearSmoother {
  public:
    /// Every epoch of the arc must have a measurement. Failure as for `smooth`.
    LinearSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    /// The smoothed positions (m), one for each epoch of the arc.
    std::vector<PositionVector<Axes>> operator()(
        std::span<const PositionVector<Axes>> measured) const;

    /// Smooths several recordings side by side, each bit for bit as on its own. They share each
    /// load of the gains.
    template <int Lanes>
    std::vector<LanePositions<Axes, Lanes>> smooth_lanes(
        std::span<const LanePositions<Axes, Lanes>> measured) const;

  private:
    static constexpr auto axes = static_cast<std::size_t>(Axes);
    static constexpr std::size_t size = 4 * axes;
    using Rows = std::array<std::array<double, size>, axes>;

    /// What a smoothed position needs of an epoch.
    struct Epoch {
        std::size_t step = 0;                                 ///< to the next epoch, an index into
                                                              ///< `steps_`
        Rows gain{};                                          ///< transposed
        std::array<std::array<double, axes>, axes> weight{};  ///< inverse innovation covariance
        Rows position{};  ///< the position's rows of the predicted state's covariance
    };
    template <int Lanes>
    struct Pass;

    std::vector<Epoch> epochs_;
    std::vector<kernel::StepNumbers<double>> steps_;  ///< one for each run of equal lengths
};

}  // namespace runcert
