#include "motion/motion_smoother.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/failure.h"

namespace runcert {
namespace {

[[noreturn]] void not_positive_definite(const char* which, double time_s) {
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  fmt::format("the {} covariance is not positive definite", which),
                  "Check the stated standard deviations and the time steps around this epoch");
}

/// Whether a filtered state is so uncertain (10 m, 1 m/s or 10 m/s^2) that P - P N P would lose
/// digits.
template <int Axes>
bool is_vague(const StateMatrix<Axes>& covariance) {
    for (int axis = 0; axis < Axes; ++axis)
        if (covariance(axis, axis) > 100.0 || covariance(Axes + axis, Axes + axis) > 1.0 ||
            covariance(2 * Axes + axis, 2 * Axes + axis) > 100.0)
            return true;
    return false;
}

/// A square matrix times some columns, accumulated over whole columns of the matrix.
template <int Size, int Count>
Eigen::Matrix<double, Size, Count> times_columns(
    const Eigen::Matrix<double, Size, Size>& matrix,
    const Eigen::Matrix<double, Size, Count>& columns) {
    Eigen::Matrix<double, Size, Count> product;
    for (int column = 0; column < Count; ++column) {
        double sum[Size] = {};
        for (int i = 0; i < Size; ++i) {
            const double factor = columns(i, column);
            for (int row = 0; row < Size; ++row)
                sum[row] += matrix.data()[i * Size + row] * factor;
        }
        for (int row = 0; row < Size; ++row)
            product(row, column) = sum[row];
    }
    return product;
}

/// The inverse of U in S = U D U'.
template <int Axes>
PositionMatrix<Axes> inverse_factor(const typename KalmanFilter<Axes>::FactoredInnovation& seen) {
    PositionMatrix<Axes> inverse = PositionMatrix<Axes>::Identity();
    for (int j = 1; j < Axes; ++j)
        for (int k = 0; k < j; ++k)
            inverse.row(j) -= seen.factor[kernel::in_triangle(j, k)] * inverse.row(k);
    return inverse;
}

}  // namespace

template <int Axes>
MotionSmoother<Axes>::MotionSmoother(std::span<const ArcEpoch<Axes>> arc,
                                     const EstimationModel& model)
    : arc_(arc), filter_(model) {
    assert(!arc.empty() && arc.front().measurement);
    kept_.reserve((arc.size() + epochs_at_once - 1) / epochs_at_once);
    Visited at{.filtered = filter_.prior(arc.front().measurement->position), .seen = {}};
    take_in(0, at);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (k > 0) carry_and_take_in(k, at);
        if (arc[k].measurement) {
            innovation_sum_ += at.seen.statistic;
            ++measurements_;
        }
        if (k % epochs_at_once == 0) kept_.push_back(at);
    }
    piece_.resize(std::min(arc.size(), epochs_at_once));
    epoch_ = arc.size() - 1;
    filter_again(epoch_ / epochs_at_once);
    smooth_here();
}

template <int Axes>
void MotionSmoother<Axes>::take_in(std::size_t k, Visited& at) {
    if (!arc_[k].measurement) return;
    require_positive_definite<Axes>(arc_[k].measurement->covariance, arc_[k].time_s);
    at.seen = filter_.take_in(at.filtered, *arc_[k].measurement);
    if (!(at.seen.determinant > 0.0)) not_positive_definite("predicted", arc_[k].time_s);
}

template <int Axes>
void MotionSmoother<Axes>::carry_and_take_in(std::size_t k, Visited& at) {
    filter_.carry_to(at.filtered, arc_[k - 1], arc_[k]);
    take_in(k, at);
}

/// Filters a piece of the arc again and keeps all its states.
template <int Axes>
void MotionSmoother<Axes>::filter_again(std::size_t piece) {
    const std::size_t first = piece * epochs_at_once;
    const std::size_t last = std::min(first + epochs_at_once, arc_.size());
    piece_.front() = kept_[piece];
    for (std::size_t k = first + 1; k < last; ++k) {
        Visited& visited = piece_[k - first];
        visited.filtered = piece_[k - first - 1].filtered;
        carry_and_take_in(k, visited);
    }
}

template <int Axes>
void MotionSmoother<Axes>::step_back() {
    if (epoch_ == 0) {
        done_ = true;
        return;
    }
    const std::size_t place = epoch_ % epochs_at_once;
    const bool may_be_vague = place == 0 || is_vague<Axes>(piece_[place - 1].filtered.covariance);
    if (may_be_vague) next_ = {.mean = mean_, .covariance = covariance()};
    if (arc_[epoch_].measurement) back_through_measurement(here().seen);
    const auto& step = filter_.numbers_of(step_kind(arc_[epoch_ - 1], arc_[epoch_]));
    kernel::carry_back<Axes>(step, gradient_.data());
    kernel::carry_information_back<Axes>(step, information_.data());
    --epoch_;
    if (place == 0) filter_again(epoch_ / epochs_at_once);
    by_rts_ = may_be_vague && is_vague<Axes>(here().filtered.covariance);
    if (by_rts_)
        smooth_here_by_rts();
    else
        smooth_here();
}

/// Steps back across the measurement, with S = U D U' and V = P H' inverse(U'): (I - K H)' g - H'
/// inverse(S) r and (I - K H)' N (I - K H) + H' inverse(S) H.
template <int Axes>
void MotionSmoother<Axes>::back_through_measurement(const FactoredInnovation& seen) {
    using Columns = Eigen::Matrix<double, state_size<Axes>, Axes>;
    using Small = PositionMatrix<Axes>;
    const auto v = kernel::independent_cross(seen);
    const Eigen::Map<const Columns> cross(v.data());
    const Eigen::Map<const PositionVector<Axes>> weights(seen.inverse_variance.data());
    const Eigen::Map<const PositionVector<Axes>> independent(seen.independent.data());
    const Small inverse = inverse_factor<Axes>(seen);  // of U

    const PositionVector<Axes> pull =
        inverse.transpose() *
        weights.cwiseProduct(cross.transpose() * gradient_ + independent).eval();
    const Columns carried =
        times_columns<state_size<Axes>, Axes>(information_, cross) * weights.asDiagonal();
    Small middle = weights.asDiagonal() * (cross.transpose() * carried).eval();
    middle.diagonal() += weights;
    // N - Y H - H' Y', where the rows of H are position and error.
    Columns y = carried * inverse;
    const Small half = 0.5 * (inverse.transpose() * middle * inverse);
    y.template topRows<Axes>() -= half;
    y.template bottomRows<Axes>() -= half;
    gradient_.template head<Axes>() -= pull;
    information_.template leftCols<Axes>() -= y;
    information_.template topRows<Axes>() -= y.transpose();
    gradient_.template tail<Axes>() -= pull;
    information_.template rightCols<Axes>() -= y;
    information_.template bottomRows<Axes>() -= y.transpose();
}

template <int Axes>
void MotionSmoother<Axes>::smooth_here() {
    const StateEstimate<Axes>& filtered = here().filtered;
    mean_ = filtered.mean - filtered.covariance.lazyProduct(gradient_);
}

template <int Axes>
void MotionSmoother<Axes>::smooth_here_by_rts() {
    const StateEstimate<Axes>& filtered = here().filtered;
    const ArcEpoch<Axes>&own = arc_[epoch_], &later = arc_[epoch_ + 1];
    StateEstimate<Axes> predicted = filtered;
    filter_.carry_to(predicted, own, later);
    // F P, the covariance of the next state with this one.
    const StateMatrix<Axes> cross =
        filter_.transition_of(step_kind(own, later)) * filtered.covariance;
    const Eigen::LLT<StateMatrix<Axes>> factor(predicted.covariance);
    if (factor.info() != Eigen::Success) not_positive_definite("predicted", later.time_s);
    const StateMatrix<Axes> gain = factor.solve(cross).transpose();
    mean_ = filtered.mean + gain * (next_.mean - predicted.mean);
    const StateMatrix<Axes> smoothed =
        filtered.covariance + gain * (next_.covariance - predicted.covariance) * gain.transpose();
    covariance_ = 0.5 * (smoothed + smoothed.transpose());
}

template <int Axes>
PositionMatrix<Axes> MotionSmoother<Axes>::covariance(int kind) const {
    if (by_rts_) return covariance().template block<Axes, Axes>(kind * Axes, kind * Axes);
    using Columns = Eigen::Matrix<double, state_size<Axes>, Axes>;
    const StateEstimate<Axes>& filtered = here().filtered;
    const Columns columns = filtered.covariance.template middleCols<Axes>(kind * Axes);
    const Columns informed = times_columns<state_size<Axes>, Axes>(information_, columns);
    PositionMatrix<Axes> smoothed =
        filtered.covariance.template block<Axes, Axes>(kind * Axes, kind * Axes);
    for (int column = 0; column < Axes; ++column)
        for (int row = column; row < Axes; ++row) {
            double sum = 0.0;
            for (int i = 0; i < state_size<Axes>; ++i)
                sum += columns(i, row) * informed(i, column);
            smoothed(row, column) -= sum;
            smoothed(column, row) = smoothed(row, column);
        }
    if (!(smoothed.diagonal().array() > 0.0).all())
        not_positive_definite("smoothed", arc_[epoch_].time_s);
    return smoothed;
}

template <int Axes>
StateMatrix<Axes> MotionSmoother<Axes>::unsymmetrised() const {
    if (by_rts_) return covariance_;
    const StateMatrix<Axes>& p = here().filtered.covariance;
    return p - p * (information_ * p);
}

template <int Axes>
StateMatrix<Axes> MotionSmoother<Axes>::covariance() const {
    const StateMatrix<Axes> smoothed = unsymmetrised();
    return 0.5 * (smoothed + smoothed.transpose());
}

template <int Axes>
double MotionSmoother<Axes>::asymmetry() const {
    const StateMatrix<Axes> smoothed = unsymmetrised();
    return (smoothed - smoothed.transpose()).norm() / smoothed.norm();
}

template class MotionSmoother<1>;
template class MotionSmoother<2>;
template class MotionSmoother<3>;  // for tests/benchmark

}  // namespace runcert
