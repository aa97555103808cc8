#pragma once

#include <cmath>
#include <cstdint>

#include "motion/kalman.h"

namespace runcert {

/// One kind of step in a chain of states: the transition F of all axes, its noise Q, and the
/// whitener W of that noise, W' W = inverse(Q). Its operations use the structure of the matrices.
template <int Axes>
class ChainStep {
  public:
    using State = StateVector<Axes>;

    ChainStep(const EstimationModel& model, const StepKind& kind) {
        const AxisStep step = axis_step(model, kind);
        motion_whitener_ = axis_process_whitener(step);
        error_whitener_ = 1.0 / std::sqrt(step.error_noise);
        numbers_ = kernel::numbers_of(step);
    }

    /// F x.
    State carried(const State& state) const {
        State after = state;
        kernel::carry<Axes>(numbers_, after.data());
        return after;
    }

    /// F' x.
    State carried_back(const State& state) const {
        State before = state;
        kernel::carry_back<Axes>(numbers_, before.data());
        return before;
    }

    /// Replaces P by F P F' + Q.
    void predict(StateMatrix<Axes>& covariance) const {
        kernel::carry_covariance<Axes>(numbers_, covariance.data());
        kernel::mirror<state_size<Axes>>(covariance.data());
    }

    /// W x.
    State whitened(const State& defect) const {
        const Eigen::Matrix3d& w = motion_whitener_;
        const auto block = [&](int i) { return defect.template segment<Axes>(i * Axes); };
        State white;
        white << w(0, 0) * block(0) + w(0, 1) * block(1) + w(0, 2) * block(2),
            w(1, 1) * block(1) + w(1, 2) * block(2), w(2, 2) * block(2), error_whitener_ * block(3);
        return white;
    }

    /// W' x.
    State unwhitened(const State& white) const {
        const Eigen::Matrix3d& w = motion_whitener_;
        const auto block = [&](int i) { return white.template segment<Axes>(i * Axes); };
        State result;
        result << w(0, 0) * block(0), w(0, 1) * block(0) + w(1, 1) * block(1),
            w(0, 2) * block(0) + w(1, 2) * block(1) + w(2, 2) * block(2),
            error_whitener_ * block(3);
        return result;
    }

  private:
    kernel::StepNumbers<double> numbers_;
    Eigen::Matrix3d motion_whitener_;
    double error_whitener_ = 0.0;
};

}  // namespace runcert
