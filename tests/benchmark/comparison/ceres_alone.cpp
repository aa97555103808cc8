#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <deque>
#include <limits>
#include <nlohmann/json.hpp>

#include "comparison_data.h"
#include "core/failure.h"

// The same estimate as one sparse least-squares problem, solved by Ceres: nine unknowns an epoch,
// analytic constant Jacobians, sparse normal Cholesky, one thread. Means alone: the covariances of
// all epochs are no sparse problem, and Ceres would take minutes for them.

namespace runcert::comparison {
namespace {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using RowMatrix9 = Eigen::Matrix<double, 9, 9, Eigen::RowMajor>;
using RowMatrix39 = Eigen::Matrix<double, 3, 9, Eigen::RowMajor>;

/// Whitened `W (x - m)` of the first state.
class PriorCost : public ceres::SizedCostFunction<9, 9> {
  public:
    PriorCost(const Vector9& mean, const Vector9& sigma)
        : mean_(mean), weight_(sigma.cwiseInverse()) {}
    bool Evaluate(double const* const* states, double* residuals,
                  double** jacobians) const override {
        const Eigen::Map<const Vector9> x(states[0]);
        Eigen::Map<Vector9>(residuals).noalias() = weight_.cwiseProduct(x - mean_);
        if (jacobians && jacobians[0]) Eigen::Map<RowMatrix9>{jacobians[0]} = weight_.asDiagonal();
        return true;
    }

  private:
    Vector9 mean_, weight_;
};

/// Whitened `W (H x - z)` of a measured position.
class PositionCost : public ceres::SizedCostFunction<3, 9> {
  public:
    explicit PositionCost(const MeasuredPosition& measured) : position_(measured.position) {
        const Eigen::Matrix3d information = measured.covariance.inverse();
        whitener_ = information.llt().matrixL().transpose();
    }
    bool Evaluate(double const* const* states, double* residuals,
                  double** jacobians) const override {
        const Eigen::Map<const Vector9> x(states[0]);
        Eigen::Map<Eigen::Vector3d>(residuals).noalias() = whitener_ * (x.head<3>() - position_);
        if (jacobians && jacobians[0]) {
            Eigen::Map<RowMatrix39> jacobian(jacobians[0]);
            jacobian.setZero();
            jacobian.leftCols<3>() = whitener_;
        }
        return true;
    }

  private:
    Eigen::Vector3d position_;
    Eigen::Matrix3d whitener_;
};

/// The jacobians of `W (x' - F x)`, one for all steps.
struct MotionJacobians {
    RowMatrix9 before, after;
};

MotionJacobians motion_jacobians() {
    constexpr double dt = step_s;
    Eigen::Matrix3d f, q;
    f << 1, dt, dt * dt / 2, 0, 1, dt, 0, 0, 1;
    // In units of the step, so that the inverse loses no digits.
    q << 1.0 / 20, 1.0 / 8, 1.0 / 6, 1.0 / 8, 1.0 / 3, 1.0 / 2, 1.0 / 6, 1.0 / 2, 1.0;
    const Eigen::Vector3d unit = Eigen::Vector3d(dt * dt, dt, 1.0) * (jerk_density * std::sqrt(dt));
    const Eigen::Matrix3d information = q.inverse();
    const Eigen::Matrix3d factor = information.llt().matrixL();
    const Eigen::Matrix3d whitener = factor.transpose() * unit.cwiseInverse().asDiagonal();
    const Eigen::Matrix3d carried = -whitener * f;
    MotionJacobians jacobians;
    for (Eigen::Index row = 0; row < 3; ++row)
        for (Eigen::Index column = 0; column < 3; ++column) {
            const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
            jacobians.after.block<3, 3>(3 * row, 3 * column) = whitener(row, column) * one;
            jacobians.before.block<3, 3>(3 * row, 3 * column) = carried(row, column) * one;
        }
    return jacobians;
}

class MotionCost : public ceres::SizedCostFunction<9, 9, 9> {
  public:
    explicit MotionCost(const MotionJacobians& jacobians) : jacobians_(jacobians) {}
    bool Evaluate(double const* const* states, double* residuals,
                  double** jacobians) const override {
        const Eigen::Map<const Vector9> before(states[0]), after(states[1]);
        Eigen::Map<Vector9>(residuals).noalias() =
            jacobians_.before * before + jacobians_.after * after;
        if (jacobians && jacobians[0]) Eigen::Map<RowMatrix9>{jacobians[0]} = jacobians_.before;
        if (jacobians && jacobians[1]) Eigen::Map<RowMatrix9>{jacobians[1]} = jacobians_.after;
        return true;
    }

  private:
    const MotionJacobians& jacobians_;
};

/// The steps all share one cost object, which the problem must then not own.
ceres::Problem::Options sharing_costs() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
}

/// The problem is linear: the first step is the solution, and the next ones refine its rounding.
ceres::Solver::Options linear_problem() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.num_threads = 1;
    options.initial_trust_region_radius = 1e16;
    options.max_trust_region_radius = 1e32;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    return options;
}

std::vector<Vector9> solved(const std::vector<MeasuredPosition>& measured) {
    std::vector<Vector9> states(measured.size(), Vector9::Zero());
    Vector9 sigma;
    sigma << 100, 100, 100, 300, 300, 300, 100, 100, 100;
    states[0].head<3>() = measured[0].position;
    PriorCost prior(states[0], sigma);
    std::deque<PositionCost> positions;  // costs cannot be moved
    const MotionJacobians jacobians = motion_jacobians();
    MotionCost motion(jacobians);
    ceres::Problem problem(sharing_costs());
    problem.AddResidualBlock(&prior, nullptr, states[0].data());
    for (std::size_t k = 0; k < measured.size(); ++k) {
        states[k].head<3>() = measured[k].position;
        problem.AddResidualBlock(&positions.emplace_back(measured[k]), nullptr, states[k].data());
        if (k > 0)
            problem.AddResidualBlock(&motion, nullptr, states[k - 1].data(), states[k].data());
    }
    ceres::Solver::Summary summary;
    ceres::Solve(linear_problem(), &problem, &summary);
    if (summary.termination_type != ceres::CONVERGENCE)
        throw Failure("Ceres", "did not converge: " + summary.message, "See its message");
    return states;
}

nlohmann::ordered_json program(const Arguments& arguments) {
    const std::vector<MeasuredPosition> measured = read_positions(arguments.data);
    std::vector<Vector9> states;
    const double seconds = seconds_of([&] { states = solved(measured); });
    write_points(arguments.result, measured.size(), arguments.every, [&](std::size_t k) {
        constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
        return SmoothedPoint{.mean = states[k].head<6>(),
                             .sigma = Eigen::Matrix<double, 6, 1>::Constant(unknown)};
    });
    return {{"epochs", measured.size()}, {"seconds", seconds}};
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run_program(argc, argv, runcert::comparison::program);
}
