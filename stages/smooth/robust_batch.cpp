#include "stages/smooth/robust_batch.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cassert>
#include <cmath>

namespace runcert {
namespace {

template <int Size>
using Vector = Eigen::Matrix<double, Size, 1>;

/// Memory of Ceres seen as a matrix.
template <class Matrix>
Eigen::Map<Matrix> view(double* memory) {
    return Eigen::Map<Matrix>(memory);
}
template <class Matrix>
Eigen::Map<const Matrix> view(const double* memory) {
    return Eigen::Map<const Matrix>(memory);
}

/// Residual `offset + jacobian * unknown`: of a prior or of a measurement.
template <int Rows, int States>
class OneStateCost : public ceres::SizedCostFunction<Rows, States> {
  public:
    using Jacobian =
        Eigen::Matrix<double, Rows, States, States == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

    OneStateCost(const Jacobian& jacobian, const Vector<Rows>& offset)
        : jacobian_(jacobian), offset_(offset) {}

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        view<Vector<Rows>>(residuals) = offset_ + jacobian_ * view<Vector<States>>(parameters[0]);
        if (jacobians && jacobians[0]) view<Jacobian>(jacobians[0]) = jacobian_;
        return true;
    }

  private:
    Jacobian jacobian_;
    Vector<Rows> offset_;
};

ceres::Solver::Options solver_options(int iterations, double function_tolerance) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    // Eigen's factorisation needs no BLAS, whose rounding differs from one machine to the next.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    // No damping to begin with: undamped steps solve the linear problem, and cannot raise a Cauchy
    // cost (they are those of iterated reweighting).
    options.initial_trust_region_radius = 1e32;
    options.max_trust_region_radius = 1e32;
    options.min_lm_diagonal = 1e-32;
    options.max_num_iterations = iterations;
    options.function_tolerance = function_tolerance;
    options.gradient_tolerance = 1e-12;  // for unknowns in their units; above rounding
    options.parameter_tolerance = 0.0;
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

/// Residual `offset + before * unknown + after * next unknown`: of whitened process noise.
template <int Axes>
class BatchProblem<Axes>::ProcessCost : public ceres::SizedCostFunction<n, n, n> {
  public:
    /// The step must outlive the cost.
    ProcessCost(const Step& step, const State& offset) : step_(step), offset_(offset) {}

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        view<State>(residuals) = offset_ + step_.before_unknown * view<State>(parameters[0]) +
                                 step_.after_unknown * view<State>(parameters[1]);
        if (jacobians && jacobians[0]) view<RowMajor>(jacobians[0]) = step_.before_unknown;
        if (jacobians && jacobians[1]) view<RowMajor>(jacobians[1]) = step_.after_unknown;
        return true;
    }

  private:
    const Step& step_;
    State offset_;
};

/// The same less what the offset of a bridged step makes of the position.
template <int Axes>
class BatchProblem<Axes>::BridgedProcessCost : public ceres::SizedCostFunction<n, n, n, Axes> {
  public:
    using OffsetJacobian =
        Eigen::Matrix<double, n, Axes, Axes == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

    BridgedProcessCost(const Step& step, const State& offset, const OffsetJacobian& jacobian)
        : process_(step, offset), jacobian_(jacobian) {}

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        process_.Evaluate(parameters, residuals, jacobians);
        view<State>(residuals) += jacobian_ * view<PositionVector<Axes>>(parameters[2]);
        if (jacobians && jacobians[2]) view<OffsetJacobian>(jacobians[2]) = jacobian_;
        return true;
    }

  private:
    ProcessCost process_;
    OffsetJacobian jacobian_;
};

template <int Axes>
BatchProblem<Axes>::BatchProblem(std::span<const ArcEpoch<Axes>> stretch,
                                 const EstimationModel& model,
                                 std::span<const StateVector<Axes>> reference,
                                 std::optional<double> cauchy_scale)
    : stretch_(stretch),
      model_(model),
      reference_(reference.begin(), reference.end()),
      unit_(State::Ones()),
      unknowns_(stretch.size(), State::Zero()) {
    assert(reference.size() == stretch.size() && stretch.front().measurement);
    if (stretch.size() > 1) {
        const AxisStep step = axis_step(model, stretch[1].time_s - stretch[0].time_s);
        unit_ = process_noise<Axes>(step).diagonal().cwiseSqrt();
    }
    // The problem owns losses and costs.
    ceres::LossFunction* loss = cauchy_scale ? new ceres::CauchyLoss(*cauchy_scale) : nullptr;
    add_prior();
    add_offsets();
    for (std::size_t k = 0; k < stretch.size(); ++k) {
        if (k > 0) add_process(k);
        if (stretch[k].measurement) add_measurement(k, loss);
    }
}

template <int Axes>
void BatchProblem<Axes>::add_prior() {
    const StateEstimate<Axes> prior =
        KalmanFilter<Axes>(model_).prior(stretch_.front().measurement->position);
    // The prior's covariance is diagonal.
    const State weight = prior.covariance.diagonal().cwiseSqrt().cwiseInverse();
    const State offset = weight.cwiseProduct(reference_.front() - prior.mean);
    const RowMajor jacobian = weight.cwiseProduct(unit_).asDiagonal();
    problem_.AddResidualBlock(new OneStateCost<n, n>(jacobian, offset), nullptr,
                              unknowns_.front().data());
}

template <int Axes>
void BatchProblem<Axes>::add_measurement(std::size_t k, ceres::LossFunction* loss) {
    using Cost = OneStateCost<Axes, n>;
    const PositionMeasurement<Axes>& measurement = *stretch_[k].measurement;
    const PositionMatrix<Axes> white = whitener<Axes>(measurement, model_);
    typename Cost::Jacobian jacobian = Cost::Jacobian::Zero();
    jacobian.template leftCols<Axes>() = -white * unit_.template head<Axes>().asDiagonal();
    jacobian.template rightCols<Axes>() = -white * unit_.template tail<Axes>().asDiagonal();
    const PositionVector<Axes> offset = whitened_residual<Axes>(measurement, model_, reference_[k]);
    problem_.AddResidualBlock(new Cost(jacobian, offset), loss, unknowns_[k].data());
}

/// The offsets that the stretch determines, with their prior. A step that no measurement follows
/// has none: its expected size is zero, and it changes no state.
template <int Axes>
void BatchProblem<Axes>::add_offsets() {
    using Cost = OneStateCost<Axes, Axes>;
    std::vector<std::size_t> open;
    for (std::size_t k = 1; k < stretch_.size(); ++k) {
        if (stretch_[k].step_before) open.push_back(k);
        if (!stretch_[k].measurement || open.empty()) continue;
        const auto steps = static_cast<double>(open.size());
        Offset& offset = offsets_.emplace_back();
        for (const std::size_t at : open) {
            offset_before_[at] = &offset;
            const double dt_s = stretch_[at].time_s - stretch_[at - 1].time_s;
            const State moved = transition<Axes>(axis_step(model_, dt_s)) * reference_[at - 1];
            offset.reference += (reference_[at] - moved).template head<Axes>() / steps;
        }
        const double weight = std::sqrt(steps) / vague_position_sigma_m;
        problem_.AddResidualBlock(
            new Cost(weight * unit_.template head<Axes>().asDiagonal(), weight * offset.reference),
            nullptr, offset.unknown.data());
        open.clear();
    }
}

template <int Axes>
void BatchProblem<Axes>::add_process(std::size_t k) {
    const Step& step = step_over(stretch_[k].time_s - stretch_[k - 1].time_s);
    const State noise = step.before * reference_[k - 1] + step.after * reference_[k];
    double* const before = unknowns_[k - 1].data();
    double* const after = unknowns_[k].data();
    const auto bridged = offset_before_.find(k);
    if (bridged == offset_before_.end()) {
        problem_.AddResidualBlock(new ProcessCost(step, noise), nullptr, before, after);
        return;
    }
    Offset& offset = *bridged->second;
    const State known = noise - step.after.template leftCols<Axes>() * offset.reference;
    problem_.AddResidualBlock(
        new BridgedProcessCost(step, known, -step.after_unknown.template leftCols<Axes>()), nullptr,
        before, after, offset.unknown.data());
}

template <int Axes>
const typename BatchProblem<Axes>::Step& BatchProblem<Axes>::step_over(double dt_s) {
    const std::int64_t step_ns = std::llround(dt_s * 1e9);
    const auto [at, is_new] = steps_.try_emplace(step_ns);
    Step& kept = at->second;
    if (!is_new) return kept;
    const AxisStep step = axis_step(model_, static_cast<double>(step_ns) * 1e-9);
    const Eigen::Matrix3d motion = axis_process_whitener(step);
    kept.after.setZero();
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            kept.after.template block<Axes, Axes>(row * Axes, column * Axes)
                .diagonal()
                .setConstant(motion(row, column));
    kept.after.template bottomRightCorner<Axes, Axes>().diagonal().setConstant(
        1.0 / std::sqrt(step.error_noise));
    kept.before = -kept.after * transition<Axes>(step);
    kept.before_unknown = kept.before * unit_.asDiagonal();
    kept.after_unknown = kept.after * unit_.asDiagonal();
    return kept;
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
        states[k] += unknowns_[k].cwiseProduct(unit_);
    return states;
}

template <int Axes>
std::optional<TwoStateCovariance<Axes>> BatchProblem<Axes>::covariance(std::size_t s,
                                                                       std::size_t e) {
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::SPARSE_QR;
    options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    options.num_threads = 1;
    ceres::Covariance covariance(options);
    const double* first = unknowns_[s].data();
    const double* last = unknowns_[e].data();
    if (!covariance.Compute({{first, first}, {last, last}, {first, last}}, &problem_)) return {};
    const auto block = [&](const double* row, const double* column) {
        RowMajor scaled;
        covariance.GetCovarianceBlock(row, column, scaled.data());
        return StateMatrix<Axes>(unit_.asDiagonal() * scaled * unit_.asDiagonal());
    };
    return TwoStateCovariance<Axes>{
        .first = block(first, first), .last = block(last, last), .cross = block(first, last)};
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
RUNCERT_INSTANTIATE(3)

}  // namespace runcert
