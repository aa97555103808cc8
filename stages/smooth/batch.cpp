#include "stages/smooth/batch.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
using RowMajor = Eigen::Matrix<double, state_size<Axes>, state_size<Axes>, Eigen::RowMajor>;

/// Memory of Ceres seen as a matrix.
template <class Matrix>
Eigen::Map<Matrix> view(double* memory) {
    return Eigen::Map<Matrix>(memory);
}
template <class Matrix>
Eigen::Map<const Matrix> view(const double* memory) {
    return Eigen::Map<const Matrix>(memory);
}

/// Whitened difference between a state and its prior.
template <int Axes>
class PriorCost : public ceres::SizedCostFunction<state_size<Axes>, state_size<Axes>> {
  public:
    explicit PriorCost(const StateEstimate<Axes>& prior)
        : mean_(prior.mean),
          // The prior's covariance is diagonal.
          whitener_(prior.covariance.diagonal().cwiseSqrt().cwiseInverse().asDiagonal()) {}

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const auto state = view<StateVector<Axes>>(parameters[0]);
        view<StateVector<Axes>>(residuals) = whitener_ * (state - mean_);
        if (jacobians && jacobians[0]) view<RowMajor<Axes>>(jacobians[0]) = whitener_;
        return true;
    }

  private:
    StateVector<Axes> mean_;
    StateMatrix<Axes> whitener_;
};

/// Whitened difference between a measured position and a state's.
template <int Axes>
class MeasurementCost : public ceres::SizedCostFunction<Axes, state_size<Axes>> {
  public:
    explicit MeasurementCost(const PositionMeasurement<Axes>& measurement)
        : position_(measurement.position) {
        // P = L L': inverse(L) whitens.
        const PositionMatrix<Axes> factor = measurement.covariance.llt().matrixL();
        whitener_ = factor.inverse();
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const auto state = view<PositionVector<Axes>>(parameters[0]);
        view<PositionVector<Axes>>(residuals) = whitener_ * (state - position_);
        if (jacobians && jacobians[0]) {
            Eigen::Map<Eigen::Matrix<double, Axes, state_size<Axes>, Eigen::RowMajor>> jacobian(
                jacobians[0]);
            jacobian.setZero();
            jacobian.template leftCols<Axes>() = whitener_;
        }
        return true;
    }

  private:
    PositionVector<Axes> position_;
    PositionMatrix<Axes> whitener_;
};

/// Whitened process noise between two states.
template <int Axes>
class ProcessCost
    : public ceres::SizedCostFunction<state_size<Axes>, state_size<Axes>, state_size<Axes>> {
  public:
    ProcessCost(const MotionModel& model, double dt_s) : transition_(transition<Axes>(dt_s)) {
        const Eigen::Matrix3d axis = axis_process_whitener(model, dt_s);
        whitener_.setZero();
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column)
                whitener_.template block<Axes, Axes>(row * Axes, column * Axes)
                    .diagonal()
                    .setConstant(axis(row, column));
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        const auto before = view<StateVector<Axes>>(parameters[0]);
        const auto after = view<StateVector<Axes>>(parameters[1]);
        view<StateVector<Axes>>(residuals) = whitener_ * (after - transition_ * before);
        if (jacobians && jacobians[0])
            view<RowMajor<Axes>>(jacobians[0]) = -whitener_ * transition_;
        if (jacobians && jacobians[1]) view<RowMajor<Axes>>(jacobians[1]) = whitener_;
        return true;
    }

  private:
    StateMatrix<Axes> transition_;
    StateMatrix<Axes> whitener_;
};

ceres::Solver::Options solver_options() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    // A linear problem: no damping, and further steps only take up rounding.
    options.initial_trust_region_radius = 1e32;
    options.max_trust_region_radius = 1e32;
    options.min_lm_diagonal = 1e-32;
    options.max_num_iterations = 8;
    options.function_tolerance = 0.0;
    options.gradient_tolerance = 0.0;
    options.parameter_tolerance = 1e-16;
    return options;
}

}  // namespace

template <int Axes>
std::vector<StateVector<Axes>> solve_batch(std::span<const ArcEpoch<Axes>> arc,
                                           const MotionModel& model) {
    const StateEstimate<Axes> prior = vague_prior<Axes>(arc.front().measurement->position);
    // Started from the measured positions at rest, far enough from the solution to be a check.
    std::vector<StateVector<Axes>> states(arc.size(), prior.mean);
    ceres::Problem problem;
    problem.AddResidualBlock(new PriorCost<Axes>(prior), nullptr, states[0].data());
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (k > 0) {
            states[k] = states[k - 1];
            problem.AddResidualBlock(
                new ProcessCost<Axes>(model, arc[k].time_s - arc[k - 1].time_s), nullptr,
                states[k - 1].data(), states[k].data());
        }
        if (!arc[k].measurement) continue;
        states[k].template head<Axes>() = arc[k].measurement->position;
        problem.AddResidualBlock(new MeasurementCost<Axes>(*arc[k].measurement), nullptr,
                                 states[k].data());
    }
    ceres::Solver::Summary summary;
    ceres::Solve(solver_options(), &problem, &summary);
    if (!summary.IsSolutionUsable())
        throw Failure(
            fmt::format("arc from {:.3f} s to {:.3f} s", arc.front().time_s, arc.back().time_s),
            "the batch least squares did not converge: " + summary.message,
            "Check the stated accuracies and the time steps of this stretch");
    return states;
}

template std::vector<StateVector<2>> solve_batch<2>(std::span<const ArcEpoch<2>>,
                                                    const MotionModel&);
template std::vector<StateVector<3>> solve_batch<3>(std::span<const ArcEpoch<3>>,
                                                    const MotionModel&);

}  // namespace runcert
