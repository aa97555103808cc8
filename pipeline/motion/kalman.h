#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "motion/chain_kernel.h"
#include "motion/motion_model.h"

namespace runcert {

/// Mean and covariance of a state.
template <int Axes>
struct StateEstimate {
    StateVector<Axes> mean = StateVector<Axes>::Zero();
    StateMatrix<Axes> covariance = StateMatrix<Axes>::Identity();
};

/// A measured position (m) with the stated covariance (m^2) of its error.
template <int Axes>
struct PositionMeasurement {
    PositionVector<Axes> position = PositionVector<Axes>::Zero();
    PositionMatrix<Axes> covariance = PositionMatrix<Axes>::Identity();
};

/// One epoch of an arc: a time and, where the epoch takes part, its measured position.
template <int Axes>
struct ArcEpoch {
    double time_s = 0.0;
    std::optional<PositionMeasurement<Axes>> measurement;
    /// From here on the measured positions are offset by an unknown constant (a cycle slip), and so
    /// are the estimated ones. Only screening goes on past a step that it has found; arcs to be
    /// estimated end there. Has no meaning at an arc's first epoch.
    bool step_before = false;
    /// Jerk density of the craft between the previous epoch and this one, in units of the model's.
    double jerk_factor = 1.0;
};

/// The kind of the step between two consecutive epochs of an arc.
template <int Axes>
StepKind step_kind(const ArcEpoch<Axes>& from, const ArcEpoch<Axes>& to) {
    return {.length_ns = std::llround((to.time_s - from.time_s) * 1e9),
            .jerk_factor = to.jerk_factor};
}

/// Standard deviation of an unknown position, or of an unknown offset between positions.
inline constexpr double vague_position_sigma_m = 100.0;

/// A measured position compared with its prediction, coordinate after coordinate in terms of
/// independent errors.
template <int Axes>
struct Innovation {
    kernel::Whitening<Axes> white;
    kernel::Numbers<kernel::Compared<Axes, double>, Axes> coordinates;
    /// Whether it tests the model. It does not where the measurement only determines the motion at
    /// the beginning of the arc, or the offset after a step.
    bool tests_model = true;

    /// Independent, of mean 0 and variance 1 under the model.
    PositionVector<Axes> normalised() const {
        PositionVector<Axes> all;
        for (int j = 0; j < Axes; ++j)
            all(j) = coordinates[j].innovation / std::sqrt(coordinates[j].variance);
        return all;
    }
    /// Chi-squared with Axes degrees of freedom under the model.
    double statistic() const { return normalised().squaredNorm(); }
};

/// The Kalman filter of one model. Consecutive steps of the same kind share their transition and
/// process noise.
template <int Axes>
class KalmanFilter {
  public:
    explicit KalmanFilter(const EstimationModel& model) : model_(model) {}

    const EstimationModel& model() const { return model_; }

    /// A vague prior at a position. Its standard deviations are 100 m, 300 m/s and 100 m/s^2, and
    /// for the Gauss-Markov error that of the beginning of an arc. Combined with one measurement of
    /// 10 mm, it moves the position by 1e-8 of the distance between the two.
    StateEstimate<Axes> prior(const PositionVector<Axes>& position) const;

    /// Propagates the estimate by `dt_s` seconds at the model's own jerk density.
    StateEstimate<Axes> predict(StateEstimate<Axes> estimate, double dt_s);

    /// Propagates the estimate from epoch `from` to the arc's next epoch `to`. Across a step of
    /// the positions they become as vague as in the prior.
    void carry_to(StateEstimate<Axes>& estimate, const ArcEpoch<Axes>& from,
                  const ArcEpoch<Axes>& to);

    /// Updates the estimate with a measurement, whose covariance must be positive definite.
    Innovation<Axes> update(StateEstimate<Axes>& estimate,
                            const PositionMeasurement<Axes>& measurement) const;

    /// For a kind of step: the five numbers of its transition.
    const kernel::StepNumbers<double>& numbers_of(const StepKind& kind);

  private:
    void prepare(const StepKind& kind);
    void carry(StateEstimate<Axes>& estimate, const StepKind& kind);

    EstimationModel model_;
    StepKind kind_;
    kernel::StepNumbers<double> numbers_;
};

/// Number of measurements at the beginning of an arc that cannot test the model, because the prior
/// is vague.
inline constexpr int measurements_of_the_prior = 3;

/// Counts the unknowns that measurements must determine before they test the model: the motion at
/// the beginning of an arc, and the offset after a step.
class UnknownsToTell {
  public:
    /// Of consecutive steps without a measurement between them, only the sum of the offsets can be
    /// determined.
    void add_step() {
        if (!step_open_) ++unknowns_;
        step_open_ = true;
    }

    /// Registers a measurement. Returns whether it was needed to determine one of the unknowns.
    bool determined_by_measurement() {
        step_open_ = false;
        if (unknowns_ == 0) return false;
        --unknowns_;
        return true;
    }

  private:
    int unknowns_ = measurements_of_the_prior;
    bool step_open_ = false;
};

/// Failure, naming the time, unless the covariance (m^2) of a measurement is positive definite.
template <int Axes>
void require_positive_definite(const PositionMatrix<Axes>& covariance, double time_s);

/// Runs the filter along an arc. Calls `visit(k, predicted, innovation, filtered)` at each epoch,
/// with a null innovation where the epoch has no measurement. The first epoch must have one.
/// Failure, naming the time, where a measurement's covariance is not positive definite.
template <int Axes, class Visit>
void filter_along(KalmanFilter<Axes>& filter, std::span<const ArcEpoch<Axes>> arc, Visit&& visit) {
    StateEstimate<Axes> estimate;
    UnknownsToTell unknowns;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (k == 0)
            estimate = filter.prior(arc[0].measurement.value().position);
        else
            filter.carry_to(estimate, arc[k - 1], arc[k]);
        if (k > 0 && arc[k].step_before) unknowns.add_step();
        const StateEstimate<Axes> predicted = estimate;
        if (!arc[k].measurement) {
            visit(k, predicted, static_cast<const Innovation<Axes>*>(nullptr), estimate);
            continue;
        }
        require_positive_definite<Axes>(arc[k].measurement->covariance, arc[k].time_s);
        Innovation<Axes> seen = filter.update(estimate, *arc[k].measurement);
        seen.tests_model = !unknowns.determined_by_measurement();
        visit(k, predicted, &seen, estimate);
    }
}

/// Time (s) over which an estimate under the model forgets its past by a factor of 1e12: twelve
/// digits of the distance between an assumed earlier state and the true one. It is 28 times the
/// longest time constant of the filter.
///
/// That constant is at most a sum of three terms: the correlation time of the Gauss-Markov error,
/// two intervals, and twice the times in which the motion becomes as uncertain as white noise and
/// time-correlated error leave it. Those times are (density / jerk density)^(1/3), the pole of the
/// steady filter of third order. The largest white noise and the mean interval come from the
/// epochs, of which there must be at least two.
template <int Axes>
double memory_s(std::span<const ArcEpoch<Axes>> epochs, const EstimationModel& model);

}  // namespace runcert
