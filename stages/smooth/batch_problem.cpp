#include "stages/smooth/batch_problem.h"

#include <ceres/ceres.h>
#include <ceres/sized_cost_function.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace runcert {
namespace {

template <int Size>
using CostVector = Eigen::Matrix<double, Size, 1>;

/// Ceres memory viewed as a matrix.
template <class Matrix>
Eigen::Map<Matrix> view(double* memory) {
    return Eigen::Map<Matrix>(memory);
}
template <class Matrix>
Eigen::Map<const Matrix> view(const double* memory) {
    return Eigen::Map<const Matrix>(memory);
}

/// Residual `offset + sum of jacobians[i] * unknowns[i]`, with one block for each of `Columns`.
template <int Rows, int... Columns>
class LinearCost final : public ceres::SizedCostFunction<Rows, Columns...> {
  public:
    static constexpr std::size_t blocks = sizeof...(Columns);

    /// The Jacobians are in row order, and must outlive the cost.
    LinearCost(const CostVector<Rows>& offset, const std::array<const double*, blocks>& jacobians)
        : offset_(offset), jacobians_(jacobians) {}

    bool Evaluate(double const* const* unknowns, double* residuals,
                  double** jacobians) const override {
        view<CostVector<Rows>>(residuals) = offset_;
        evaluate(unknowns, residuals, jacobians, std::make_index_sequence<blocks>());
        return true;
    }

  private:
    template <int Size>
    using Jacobian = Eigen::Matrix<double, Rows, Size, Eigen::RowMajor>;

    template <std::size_t... Block>
    void evaluate(double const* const* unknowns, double* residuals, double** jacobians,
                  std::index_sequence<Block...>) const {
        (evaluate_block<Columns>(Block, unknowns, residuals, jacobians), ...);
    }

    template <int Size>
    void evaluate_block(std::size_t block, double const* const* unknowns, double* residuals,
                        double** jacobians) const {
        const auto jacobian = view<Jacobian<Size>>(jacobians_[block]);
        view<CostVector<Rows>>(residuals) += jacobian * view<CostVector<Size>>(unknowns[block]);
        if (jacobians && jacobians[block]) view<Jacobian<Size>>(jacobians[block]) = jacobian;
    }

    CostVector<Rows> offset_;
    std::array<const double*, blocks> jacobians_;
};

/// Residual of a measurement, which observes position and error of each axis:
/// `offset - whitener * (position + error)`. The two are the first and last unknowns of each axis
/// times their units.
template <int Axes>
class MeasurementCost final : public ceres::CostFunction {
  public:
    MeasurementCost(const PositionVector<Axes>& offset, const PositionMatrix<Axes>& whitener,
                    double position_unit, double error_unit)
        : offset_(offset),
          by_position_(-whitener * position_unit),
          by_error_(-whitener * error_unit) {
        set_num_residuals(Axes);
        mutable_parameter_block_sizes()->assign(Axes, 4);
    }

    bool Evaluate(double const* const* unknowns, double* residuals,
                  double** jacobians) const override {
        auto residual = view<CostVector<Axes>>(residuals);
        residual = offset_;
        for (int axis = 0; axis < Axes; ++axis) {
            residual += by_position_.col(axis) * unknowns[axis][0];
            residual += by_error_.col(axis) * unknowns[axis][3];
            if (!jacobians || !jacobians[axis]) continue;
            auto jacobian = view<Eigen::Matrix<double, Axes, 4, Eigen::RowMajor>>(jacobians[axis]);
            jacobian.setZero();
            jacobian.col(0) = by_position_.col(axis);
            jacobian.col(3) = by_error_.col(axis);
        }
        return true;
    }

  private:
    PositionVector<Axes> offset_;
    PositionMatrix<Axes> by_position_;
    PositionMatrix<Axes> by_error_;
};

ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    // No parameter block overlaps another or repeats in a residual, so Ceres need not check.
    options.disable_all_safety_checks = true;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
}

ceres::Solver::Options solver_options(int iterations, double function_tolerance) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    // Eigen's factorisation needs no BLAS, whose rounding varies between machines.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    // No initial damping. Undamped steps solve the linear problem, and cannot raise a Cauchy cost,
    // because they are those of iterative reweighting.
    options.initial_trust_region_radius = 1e32;
    options.max_trust_region_radius = 1e32;
    options.min_lm_diagonal = 1e-32;
    options.max_num_iterations = iterations;
    options.function_tolerance = function_tolerance;
    options.gradient_tolerance = 1e-12;  // for scaled unknowns; above rounding
    options.parameter_tolerance = 0.0;
    // The unknowns are already scaled.
    options.jacobi_scaling = false;
    return options;
}

}  // namespace

template <int Axes>
PositionMatrix<Axes> whitener(const PositionMeasurement<Axes>& measurement,
                              const EstimationModel& model) {
    const PositionMatrix<Axes> factor = measurement.covariance.llt().matrixL();
    return factor.inverse() / model.measurement_scale;
}

template <int Axes>
PositionVector<Axes> whitened_residual(const PositionMeasurement<Axes>& measurement,
                                       const EstimationModel& model,
                                       const StateVector<Axes>& state) {
    return whitener<Axes>(measurement, model) *
           (measurement.position - state.template head<Axes>() - state.template tail<Axes>());
}

template <int Axes>
BatchProblem<Axes>::BatchProblem(std::span<const ArcEpoch<Axes>> stretch,
                                 const EstimationModel& model,
                                 std::span<const StateVector<Axes>> reference,
                                 std::optional<double> cauchy_scale)
    : stretch_(stretch),
      model_(model),
      reference_(reference.begin(), reference.end()),
      unit_(AxisState::Ones()),
      unknowns_(stretch.size(), AxisStates::Zero()),
      problem_(problem_options()) {
    assert(reference.size() == stretch.size() && stretch.front().measurement);
    if (stretch.size() > 1) {
        const AxisStep step = axis_step(model, step_kind(stretch[0], stretch[1]));
        unit_ << step.process_noise.diagonal().cwiseSqrt(), std::sqrt(step.error_noise);
    }
    if (cauchy_scale) loss_ = std::make_unique<ceres::CauchyLoss>(*cauchy_scale);
    add_prior();
    for (std::size_t k = 0; k < stretch.size(); ++k) {
        if (k > 0) add_process(k);
        if (stretch[k].measurement) add_measurement(k);
    }
}

template <int Axes>
typename BatchProblem<Axes>::AxisStates BatchProblem<Axes>::by_axis(const State& state) {
    return Eigen::Map<const Eigen::Matrix<double, Axes, axis_size>>(state.data()).transpose();
}

template <int Axes>
ceres::CostFunction* BatchProblem<Axes>::keep(ceres::CostFunction* cost) {
    costs_.emplace_back(cost);
    return cost;
}

template <int Axes>
void BatchProblem<Axes>::add_prior() {
    const StateEstimate<Axes> prior =
        KalmanFilter<Axes>(model_).prior(stretch_.front().measurement->position);
    // The prior's covariance is diagonal, and the same for each axis.
    const AxisStates weights = by_axis(prior.covariance.diagonal().cwiseSqrt().cwiseInverse());
    const AxisStates offset = weights.cwiseProduct(by_axis(reference_.front() - prior.mean));
    prior_unknown_ = weights.col(0).cwiseProduct(unit_).asDiagonal();
    for (int axis = 0; axis < Axes; ++axis)
        problem_.AddResidualBlock(
            keep(new LinearCost<axis_size, axis_size>(offset.col(axis), {prior_unknown_.data()})),
            nullptr, unknowns_.front().col(axis).data());
}

template <int Axes>
void BatchProblem<Axes>::add_measurement(std::size_t k) {
    const PositionMeasurement<Axes>& measurement = *stretch_[k].measurement;
    std::array<double*, Axes> unknowns;
    for (int axis = 0; axis < Axes; ++axis)
        unknowns[static_cast<std::size_t>(axis)] = unknowns_[k].col(axis).data();
    problem_.AddResidualBlock(
        keep(new MeasurementCost<Axes>(whitened_residual<Axes>(measurement, model_, reference_[k]),
                                       whitener<Axes>(measurement, model_), unit_(0), unit_(3))),
        loss_.get(), unknowns.data(), Axes);
}

template <int Axes>
void BatchProblem<Axes>::add_process(std::size_t k) {
    const Step& step = step_of(step_kind(stretch_[k - 1], stretch_[k]));
    const AxisStates noise =
        step.before * by_axis(reference_[k - 1]) + step.after * by_axis(reference_[k]);
    for (int axis = 0; axis < Axes; ++axis) {
        double* const before = unknowns_[k - 1].col(axis).data();
        double* const after = unknowns_[k].col(axis).data();
        problem_.AddResidualBlock(
            keep(new LinearCost<axis_size, axis_size, axis_size>(
                noise.col(axis), {step.before_unknown.data(), step.after_unknown.data()})),
            nullptr, before, after);
    }
}

template <int Axes>
const typename BatchProblem<Axes>::Step& BatchProblem<Axes>::step_of(const StepKind& kind) {
    const auto [at, is_new] = steps_.try_emplace(kind);
    Step& stored = at->second;
    if (!is_new) return stored;
    const AxisStep step = axis_step(model_, kind);
    Eigen::Matrix4d moved = Eigen::Matrix4d::Zero();
    moved.topLeftCorner<3, 3>() = step.transition;
    moved(3, 3) = step.error_transition;
    stored.after.setZero();
    stored.after.template topLeftCorner<3, 3>() = axis_process_whitener(step);
    stored.after(3, 3) = 1.0 / std::sqrt(step.error_noise);
    stored.before = -stored.after * moved;
    stored.before_unknown = stored.before * unit_.asDiagonal();
    stored.after_unknown = stored.after * unit_.asDiagonal();
    return stored;
}

template <int Axes>
Convergence BatchProblem<Axes>::solve(int iterations, double function_tolerance) {
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(iterations, function_tolerance), &problem_, &summary);
    return {.converged = summary.termination_type == ceres::CONVERGENCE,
            .usable = summary.IsSolutionUsable(),
            .iterations = summary.num_successful_steps + summary.num_unsuccessful_steps,
            .message = summary.message};
}

template <int Axes>
std::vector<StateVector<Axes>> BatchProblem<Axes>::states() const {
    std::vector<State> states = reference_;
    for (std::size_t k = 0; k < states.size(); ++k)
        for (int axis = 0; axis < Axes; ++axis)
            for (int i = 0; i < axis_size; ++i)
                states[k](i * Axes + axis) += unknowns_[k](i, axis) * unit_(i);
    return states;
}

template <int Axes>
std::string BatchProblem<Axes>::where() const {
    return fmt::format("arc from {:.3f} s to {:.3f} s", stretch_.front().time_s,
                       stretch_.back().time_s);
}

#define RUNCERT_INSTANTIATE(AXES)                                                            \
    template PositionMatrix<AXES> whitener<AXES>(const PositionMeasurement<AXES>&,           \
                                                 const EstimationModel&);                    \
    template PositionVector<AXES> whitened_residual<AXES>(                                   \
        const PositionMeasurement<AXES>&, const EstimationModel&, const StateVector<AXES>&); \
    template class BatchProblem<AXES>;
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
