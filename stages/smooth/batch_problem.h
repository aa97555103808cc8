#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stages/smooth/batch.h"

namespace runcert {

/// What makes the errors of a measurement, of scaled stated covariance P = L L', independent with
/// unit variances: inverse(L).
template <int Axes>
PositionMatrix<Axes> whitener(const PositionMeasurement<Axes>& measurement,
                              const EstimationModel& model);

/// A measurement's difference from the position and error of a state, in standard deviations by its
/// whitener.
template <int Axes>
PositionVector<Axes> whitened_residual(const PositionMeasurement<Axes>& measurement,
                                       const EstimationModel& model,
                                       const StateVector<Axes>& state);

/// How Ceres ended.
struct Convergence {
    bool converged = false;
    bool usable = false;  ///< a solution, though perhaps not yet to the tolerance
    std::int64_t iterations = 0;
    std::string message;
};

/// The least-squares problem of one stretch of an arc, in Ceres: whitened residuals of prior,
/// measurements (with a Cauchy loss where a scale is given) and process noise, and the offsets of
/// bridged steps. Not for use outside the batch: batch.h solves arcs.
///
/// The unknowns are the differences of states and offsets from a reference, in units of the
/// standard deviation of one step's process noise. In metres and seconds the Jacobian's columns
/// would differ by many orders of magnitude, and a factorisation would take the small ones for
/// rounding; about a near reference, rounding of large coordinates does not hide what the cost
/// still changes by. Each axis of an epoch is a block of its own: axes move independently, and
/// blocks of zeros would be multiplied and factorised like others.
template <int Axes>
class BatchProblem {
  public:
    /// The stretch must outlive the problem; its first epoch must have a measurement.
    /// `reference` has a state for each epoch.
    BatchProblem(std::span<const ArcEpoch<Axes>> stretch, const EstimationModel& model,
                 std::span<const StateVector<Axes>> reference,
                 std::optional<double> cauchy_scale = std::nullopt);

    /// Iterates from where the problem stands, until the cost changes by less than
    /// `function_tolerance` of itself.
    Convergence solve(int iterations, double function_tolerance);

    /// The states where the problem stands.
    std::vector<StateVector<Axes>> states() const;

    /// Which times the stretch covers, for a Failure.
    std::string where() const;

  private:
    /// Position, velocity, acceleration and error of one axis.
    static constexpr int axis_size = 4;
    using AxisState = Eigen::Matrix<double, axis_size, 1>;
    using AxisJacobian = Eigen::Matrix<double, axis_size, axis_size, Eigen::RowMajor>;
    using State = StateVector<Axes>;
    /// A state with a column for each axis, which is a block of unknowns.
    using AxisStates = Eigen::Matrix<double, axis_size, Axes>;

    /// The offset of a bridged step. Of several without a measurement between them only the sum of
    /// the offsets is determined, and least squares shares it equally: they have one.
    struct Offset {
        PositionVector<Axes> reference = PositionVector<Axes>::Zero();
        PositionVector<Axes> unknown = PositionVector<Axes>::Zero();
        double weight = 0.0;  ///< of the unknown in its prior
    };

    /// One length of step: what makes whitened process noise of two states of an axis, and of two
    /// unknowns.
    struct Step {
        AxisJacobian before;
        AxisJacobian after;
        AxisJacobian before_unknown;
        AxisJacobian after_unknown;
        AxisState offset_unknown;
    };

    static AxisStates by_axis(const State& state);

    ceres::CostFunction* keep(ceres::CostFunction* cost);
    void add_prior();
    void add_measurement(std::size_t k);
    void add_process(std::size_t k);
    void add_offsets();
    const Step& step_of(const StepKind& kind);

    std::span<const ArcEpoch<Axes>> stretch_;
    EstimationModel model_;
    std::vector<State> reference_;
    AxisState unit_;
    std::vector<AxisStates> unknowns_;
    AxisJacobian prior_unknown_;
    std::deque<Offset> offsets_;
    std::map<std::size_t, Offset*> offset_before_;  ///< by the epoch that follows the step
    std::map<StepKind, Step> steps_;                ///< the problem's costs refer to them
    std::unique_ptr<ceres::LossFunction> loss_;     ///< of the measurements
    std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
    ceres::Problem problem_;
};

}  // namespace runcert
