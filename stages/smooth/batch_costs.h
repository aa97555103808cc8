#pragma once

#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include <array>
#include <utility>

#include "estimation/kalman.h"

// Parts of the batch problem (robust_batch.h) as Ceres takes them.

namespace runcert {

template <int Size>
using CostVector = Eigen::Matrix<double, Size, 1>;

/// Memory of Ceres seen as a matrix.
template <class Matrix>
Eigen::Map<Matrix> view(double* memory) {
    return Eigen::Map<Matrix>(memory);
}
template <class Matrix>
Eigen::Map<const Matrix> view(const double* memory) {
    return Eigen::Map<const Matrix>(memory);
}

/// Residual `offset + sum of jacobians[i] * unknowns[i]`, one for each of `Columns`.
template <int Rows, int... Columns>
class LinearCost final : public ceres::SizedCostFunction<Rows, Columns...> {
  public:
    static constexpr std::size_t blocks = sizeof...(Columns);

    /// The Jacobians are row by row, and must outlive the cost.
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
    using Jacobian =
        Eigen::Matrix<double, Rows, Size, Size == 1 ? Eigen::ColMajor : Eigen::RowMajor>;

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

/// Residual of a measurement, which sees position and error of each axis: `offset - whitener *
/// (position + error)`, these the first and last unknowns of each axis times their units.
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

/// How often a solution of the normal equations is refined with the same factors.
constexpr int refinements = 0;

}  // namespace runcert
