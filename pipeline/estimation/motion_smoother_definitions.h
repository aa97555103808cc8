#pragma once

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/failure.h"
#include "estimation/motion_smoother.h"

// The definitions of MotionSmoother, for whoever instantiates it: motion_smoother.cpp does for one
// axis and two.

namespace runcert {
namespace motion_smoother {

[[noreturn]] inline void not_positive_definite(const char* which, double time_s) {
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  fmt::format("the {} covariance is not positive definite", which),
                  "Check the stated standard deviations and the time steps around this epoch");
}

/// Whether a filtered state is known so badly that P - P N P would lose digits: 10 m, 1 m/s or
/// 10 m/s^2.
template <int Axes, class Covariance>
bool is_vague(const Covariance& covariance) {
    for (int axis = 0; axis < Axes; ++axis)
        if (covariance(axis, axis) > 100.0 || covariance(Axes + axis, Axes + axis) > 1.0 ||
            covariance(2 * Axes + axis, 2 * Axes + axis) > 100.0)
            return true;
    return false;
}

}  // namespace motion_smoother

template <int Axes, int Blocks>
MotionSmoother<Axes, Blocks>::MotionSmoother(std::span<const ArcEpoch<Axes>> arc,
                                             const EstimationModel& model)
    : arc_(arc), model_(model) {
    assert(!arc.empty() && arc.front().measurement);
    kept_.reserve((arc.size() + epochs_at_once - 1) / epochs_at_once);
    Visited at{.filtered = begin(), .seen = {}};
    for (std::size_t k = 0; k < arc.size(); ++k) {
        at.seen = k == 0 ? take_in(0, at.filtered) : carry_and_take_in(k, at.filtered);
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

/// The step from epoch k - 1 to k.
template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::prepare(std::size_t k) {
    const StepKind kind = step_kind(arc_[k - 1], arc_[k]);
    if (kind == kind_) return;
    kind_ = kind;
    step_ = axis_step(model_, kind);
    transition_ = kernel::Transition(step_);
}

template <int Axes, int Blocks>
typename MotionSmoother<Axes, Blocks>::Filtered MotionSmoother<Axes, Blocks>::begin() const {
    const StateEstimate<Axes> prior =
        KalmanFilter<Axes>(model_).prior(arc_.front().measurement->position);
    return {.mean = prior.mean.template head<size>(),
            .covariance = prior.covariance.template topLeftCorner<size, size>()};
}

template <int Axes, int Blocks>
kernel::Seen<Axes, Blocks> MotionSmoother<Axes, Blocks>::take_in(std::size_t k,
                                                                 Filtered& state) const {
    if (!arc_[k].measurement) return {};
    const PositionMeasurement<Axes>& measurement = *arc_[k].measurement;
    require_positive_definite<Axes>(measurement.covariance, arc_[k].time_s);
    const double scale = model_.measurement_scale * model_.measurement_scale;
    const PositionMatrix<Axes> noise = scale * measurement.covariance;
    const auto seen = kernel::see<Axes, Blocks>(state.mean.data(), state.covariance.data(),
                                                measurement.position.data(), noise.data());
    if (!(seen.determinant > 0.0))
        motion_smoother::not_positive_definite("predicted", arc_[k].time_s);
    kernel::take_in<Axes, Blocks>(seen, noise.data(), state.mean.data(), state.covariance.data());
    return seen;
}

template <int Axes, int Blocks>
kernel::Seen<Axes, Blocks> MotionSmoother<Axes, Blocks>::carry_and_take_in(std::size_t k,
                                                                           Filtered& state) {
    prepare(k);
    carry_on(k, state);
    return take_in(k, state);
}

/// From epoch k - 1 to k, over the step prepared.
template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::carry_on(std::size_t k, Filtered& state) const {
    kernel::carry<Axes, Blocks>(transition_, state.mean.data());
    kernel::carry_covariance<Axes, Blocks>(transition_, state.covariance.data());
    kernel::add_noise<Axes, Blocks>(step_, state.covariance.data());
    if (arc_[k].step_before)
        state.covariance.diagonal().template head<Axes>().array() +=
            vague_position_sigma_m * vague_position_sigma_m;
}

/// Filters a piece of the arc again, and keeps every state of it.
template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::filter_again(std::size_t piece) {
    const std::size_t first = piece * epochs_at_once;
    const std::size_t last = std::min(first + epochs_at_once, arc_.size());
    piece_.front() = kept_[piece];
    for (std::size_t k = first + 1; k < last; ++k) {
        Visited& visited = piece_[k - first];
        visited.filtered = piece_[k - first - 1].filtered;
        visited.seen = carry_and_take_in(k, visited.filtered);
    }
}

template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::step_back() {
    if (epoch_ == 0) {
        done_ = true;
        return;
    }
    const std::size_t place = epoch_ % epochs_at_once;
    const bool may_be_vague =
        place == 0 || motion_smoother::is_vague<Axes>(piece_[place - 1].filtered.covariance);
    if (may_be_vague) next_ = {.mean = mean_, .covariance = covariance()};
    if (arc_[epoch_].measurement) back_through_measurement(here().seen);
    prepare(epoch_);
    kernel::carry_back<Axes, Blocks>(transition_, gradient_.data());
    kernel::carry_information_back<Axes, Blocks>(transition_, information_.data());
    --epoch_;
    if (place == 0) filter_again(epoch_ / epochs_at_once);
    by_rts_ = may_be_vague && motion_smoother::is_vague<Axes>(here().filtered.covariance);
    if (by_rts_)
        smooth_here_by_rts();
    else
        smooth_here();
}

/// From behind the measurement to before it, with S = U D U' and V = P H' inverse(U'):
/// (I - K H)' g - H' inverse(S) r and (I - K H)' N (I - K H) + H' inverse(S) H.
template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::back_through_measurement(
    const kernel::Seen<Axes, Blocks>& seen) {
    using Columns = Eigen::Matrix<double, size, Axes>;
    using Small = PositionMatrix<Axes>;
    const auto v = kernel::independent_cross<Axes, Blocks>(seen);
    const Eigen::Map<const Columns> cross(v.data());
    const Eigen::Map<const PositionVector<Axes>> weights(seen.inverse_variance.data());
    const Eigen::Map<const PositionVector<Axes>> independent(seen.independent.data());
    const Small inverse = kernel::inverse_factor<Axes, Blocks>(seen);  // of U

    const PositionVector<Axes> pull =
        inverse.transpose() *
        weights.cwiseProduct(cross.transpose() * gradient_ + independent).eval();
    const Columns carried =
        kernel::times_columns<size, Axes>(information_, cross) * weights.asDiagonal();
    Small middle = weights.asDiagonal() * (cross.transpose() * carried).eval();
    middle.diagonal() += weights;
    // N - Y H - H' Y', the rows of H being position and, where there is one, error.
    Columns y = carried * inverse;
    const Small half = 0.5 * (inverse.transpose() * middle * inverse);
    y.template topRows<Axes>() -= half;
    if constexpr (Blocks == 4) y.template bottomRows<Axes>() -= half;
    gradient_.template head<Axes>() -= pull;
    information_.template leftCols<Axes>() -= y;
    information_.template topRows<Axes>() -= y.transpose();
    if constexpr (Blocks == 4) {
        gradient_.template tail<Axes>() -= pull;
        information_.template rightCols<Axes>() -= y;
        information_.template bottomRows<Axes>() -= y.transpose();
    }
}

template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::smooth_here() {
    const Filtered& filtered = here().filtered;
    mean_ = filtered.mean - filtered.covariance.lazyProduct(gradient_);
}

template <int Axes, int Blocks>
void MotionSmoother<Axes, Blocks>::smooth_here_by_rts() {
    const Filtered& filtered = here().filtered;
    prepare(epoch_ + 1);
    Filtered predicted = filtered;
    carry_on(epoch_ + 1, predicted);
    // F P, the covariance of the next state with this one.
    StateCovariance cross = filtered.covariance;
    for (int column = 0; column < size; ++column)
        kernel::carry<Axes, Blocks>(transition_, cross.col(column).data());
    const Eigen::LLT<StateCovariance> factor(predicted.covariance);
    if (factor.info() != Eigen::Success)
        motion_smoother::not_positive_definite("predicted", arc_[epoch_ + 1].time_s);
    const StateCovariance gain = factor.solve(cross).transpose();
    mean_ = filtered.mean + gain * (next_.mean - predicted.mean);
    const StateCovariance smoothed =
        filtered.covariance + gain * (next_.covariance - predicted.covariance) * gain.transpose();
    covariance_ = 0.5 * (smoothed + smoothed.transpose());
}

template <int Axes, int Blocks>
PositionMatrix<Axes> MotionSmoother<Axes, Blocks>::covariance(int kind) const {
    if (by_rts_) return covariance().template block<Axes, Axes>(kind * Axes, kind * Axes);
    using Columns = Eigen::Matrix<double, size, Axes>;
    const Filtered& filtered = here().filtered;
    const Columns columns = filtered.covariance.template middleCols<Axes>(kind * Axes);
    const Columns informed = kernel::times_columns<size, Axes>(information_, columns);
    PositionMatrix<Axes> smoothed =
        filtered.covariance.template block<Axes, Axes>(kind * Axes, kind * Axes);
    for (int column = 0; column < Axes; ++column)
        for (int row = column; row < Axes; ++row) {
            double sum = 0.0;
            for (int i = 0; i < size; ++i)
                sum += columns(i, row) * informed(i, column);
            smoothed(row, column) -= sum;
            smoothed(column, row) = smoothed(row, column);
        }
    if (!(smoothed.diagonal().array() > 0.0).all())
        motion_smoother::not_positive_definite("smoothed", arc_[epoch_].time_s);
    return smoothed;
}

template <int Axes, int Blocks>
typename MotionSmoother<Axes, Blocks>::StateCovariance MotionSmoother<Axes, Blocks>::unsymmetrised()
    const {
    if (by_rts_) return covariance_;
    const StateCovariance& p = here().filtered.covariance;
    return p - p * (information_ * p);
}

template <int Axes, int Blocks>
typename MotionSmoother<Axes, Blocks>::StateCovariance MotionSmoother<Axes, Blocks>::covariance()
    const {
    const StateCovariance smoothed = unsymmetrised();
    return 0.5 * (smoothed + smoothed.transpose());
}

template <int Axes, int Blocks>
double MotionSmoother<Axes, Blocks>::asymmetry() const {
    const StateCovariance smoothed = unsymmetrised();
    return (smoothed - smoothed.transpose()).norm() / smoothed.norm();
}

}  // namespace runcert
