#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stages/smooth/batch.h"

namespace runcert {

/// The whitener inverse(L) of a measurement whose scaled stated covariance is P = L L'. It makes
/// the errors independent with unit variances.
template <int Axes>
PositionMatrix<Axes> whitener(const PositionMeasurement<Axes>& measurement,
                              const EstimationModel& model);

/// A measurement minus the sum of position and error of a state, in standard deviations by its
/// whitener.
template <int Axes>
PositionVector<Axes> whitened_residual(const PositionMeasurement<Axes>& measurement,
                                       const EstimationModel& model,
                                       const StateVector<Axes>& state);

/// The outcome of Ceres.
struct Convergence {
    bool converged = false;
    bool usable = false;  ///< has a solution, though perhaps not to the tolerance
    std::int64_t iterations = 0;
    std::string message;
};

/// The least-squares problem of one stretch of an arc, in Ceres. It holds the whitened residuals of
/// prior, measurements (with a Cauchy loss if a scale is given) and process noise. Not for use
/// outside the batch: batch.h solves arcs.
///
/// The unknowns are the differences of states from a reference, in units of the
/// standard deviation of one step's process noise. In metres and seconds the columns of the
/// Jacobian would differ by many orders of magnitude, and a factorisation would take the small ones
/// for rounding. With a close reference, rounding of large coordinates does not hide the remaining
/// changes of the cost. Each axis of an epoch is a separate block. Axes are independent, and blocks
/// of zeros would cost as much as others.
template <int Axes>
class BatchProblem {
  public:
    /// The stretch must outlive the problem, and its first epoch must have a measurement.
    /// `reference` has a state for each epoch.
    BatchProblem(std::span<const ArcEpoch<Axes>> stretch, const EstimationModel& model,
                 std::span<const StateVector<Axes>> reference,
                 std::optional<double> cauchy_scale = std::nullopt);

    /// Iterates from the current state until the cost changes by less than the fraction
    /// `function_tolerance`.
    Convergence solve(int iterations, double function_tolerance);

    /// The current states.
    std::vector<StateVector<Axes>> states() const;

    /// The times that the stretch covers, for a Failure.
    std::string where() const;

  private:
    /// Position, velocity, acceleration and error of one axis.
    static constexpr int axis_size = 4;
    using AxisState = Eigen::Matrix<double, axis_size, 1>;
    using AxisJacobian = Eigen::Matrix<double, axis_size, axis_size, Eigen::RowMajor>;
    using State = StateVector<Axes>;
    /// A state with a column for each axis, which is a block of unknowns.
    using AxisStates = Eigen::Matrix<double, axis_size, Axes>;

    /// The matrices of one kind of step. They give the whitened process noise from two states of an
    /// axis, or from two unknowns.
    struct Step {
        AxisJacobian before;
        AxisJacobian after;
        AxisJacobian before_unknown;
        AxisJacobian after_unknown;
    };

    static AxisStates by_axis(const State& state);

    ceres::CostFunction* keep(ceres::CostFunction* cost);
    void add_prior();
    void add_measurement(std::size_t k);
    void add_process(std::size_t k);
    const Step& step_of(const StepKind& kind);

    std::span<const ArcEpoch<Axes>> stretch_;
    EstimationModel model_;
    std::vector<State> reference_;
    AxisState unit_;
    std::vector<AxisStates> unknowns_;
    AxisJacobian prior_unknown_;
    std::map<StepKind, Step> steps_;             ///< the problem's costs refer to these
    std::unique_ptr<ceres::LossFunction> loss_;  ///< of the measurements
    std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
    ceres::Problem problem_;
};

}  // namespace runcert
