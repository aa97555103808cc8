#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "estimation/filter_kernel.h"
#include "estimation/motion_model.h"

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

/// One epoch of an arc: a time, and the measured position where it takes part.
template <int Axes>
struct ArcEpoch {
    double time_s = 0.0;
    std::optional<PositionMeasurement<Axes>> measurement;
    /// The measured positions are offset by an unknown constant from here on (a cycle slip), and
    /// so are the estimated ones: the step is bridged. Says nothing at an arc's first epoch.
    bool step_before = false;
    /// The craft's jerk density from the epoch before to this one, in units of the model's.
    double jerk_factor = 1.0;
};

/// The step from one epoch of an arc to the next.
template <int Axes>
StepKind step_kind(const ArcEpoch<Axes>& from, const ArcEpoch<Axes>& to) {
    return {.length_ns = std::llround((to.time_s - from.time_s) * 1e9),
            .jerk_factor = to.jerk_factor};
}

/// Standard deviation of a position, or of an offset of positions, of which nothing is known.
inline constexpr double vague_position_sigma_m = 100.0;

/// What a measurement says against a prediction.
template <int Axes>
struct Innovation {
    PositionVector<Axes> residual = PositionVector<Axes>::Zero();  ///< measured less predicted
    PositionMatrix<Axes> covariance = PositionMatrix<Axes>::Identity();
    double statistic = 0.0;  ///< residual' covariance^-1 residual, chi-squared with Axes degrees
    /// Whether it says something of the model: not so where the measurement only tells the motion
    /// at the arc's beginning, or the offset of a bridged step.
    bool tests_model = true;
};

/// The Kalman filter of one model. Transition and process noise are kept from one step to the next
/// while these are of one kind.
template <int Axes>
class KalmanFilter {
  public:
    using FactoredInnovation = kernel::FactoredInnovation<Axes, double>;
    /// What an innovation moves the state by: P H' S^-1.
    using GainMatrix = Eigen::Matrix<double, state_size<Axes>, Axes>;

    explicit KalmanFilter(const EstimationModel& model) : model_(model) {}

    const EstimationModel& model() const { return model_; }

    /// A prior that says next to nothing of the motion: at a position, with standard deviations of
    /// 100 m, 300 m/s and 100 m/s^2, and the error's own at the beginning of an arc. Against one
    /// measurement of 10 mm it moves a position by 1e-8 of the distance between the two.
    StateEstimate<Axes> prior(const PositionVector<Axes>& position) const;

    /// Carries the estimate on by `dt` seconds, at the model's own jerk density.
    StateEstimate<Axes> predict(StateEstimate<Axes> estimate, double dt_s);

    /// Carries the estimate of `from` on to the arc's next epoch. Across a bridged step the
    /// position becomes vague, as in the prior, in the frame of the offset positions.
    void carry_to(StateEstimate<Axes>& estimate, const ArcEpoch<Axes>& from,
                  const ArcEpoch<Axes>& to);

    /// Takes a measurement in: P - P H' inverse(S) H P, or, where the measurement is so much better
    /// than the prediction that this would lose digits, Joseph's form, one side after the other.
    FactoredInnovation take_in(StateEstimate<Axes>& estimate,
                               const PositionMeasurement<Axes>& measurement) const;

    /// A step for one axis, the five numbers of its transition, and the transition for all axes.
    const AxisStep& step_of(const StepKind& kind);
    const kernel::StepNumbers<double>& numbers_of(const StepKind& kind);
    const StateMatrix<Axes>& transition_of(const StepKind& kind);

    /// A measured position less the predicted one: the measurement sees position and error.
    static PositionVector<Axes> residual(const StateVector<Axes>& predicted,
                                         const PositionVector<Axes>& measured) {
        return measured - predicted.template head<Axes>() - predicted.template tail<Axes>();
    }

    Innovation<Axes> innovation(const StateEstimate<Axes>& predicted,
                                const PositionMeasurement<Axes>& measurement) const;

    GainMatrix gain(const StateEstimate<Axes>& predicted, const Innovation<Axes>& seen) const;

  private:
    void prepare(const StepKind& kind);
    void carry(StateEstimate<Axes>& estimate, const StepKind& kind);
    /// The measurement's covariance as the model has it.
    kernel::Triangle<double, Axes> noise_of(const PositionMeasurement<Axes>& measurement) const;

    EstimationModel model_;
    StepKind kind_;
    AxisStep step_;
    kernel::StepNumbers<double> numbers_;
    StateMatrix<Axes> transition_;
};

/// How many of an arc's first measurements a vague prior makes worthless as a test of the model.
inline constexpr int measurements_of_the_prior = 3;

/// What an arc's measurements have yet to tell before they test the model: its first ones the
/// motion, and the first after a bridged step its offset.
class UnknownsToTell {
  public:
    /// Of steps without a measurement between them only the sum of the offsets can be told.
    void add_step() {
        if (!step_open_) ++unknowns_;
        step_open_ = true;
    }

    /// Takes a measurement; whether it was needed to tell one of the unknowns.
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

/// Failure at that time unless the covariance (m^2) of a measurement is positive definite.
template <int Axes>
void require_positive_definite(const PositionMatrix<Axes>& covariance, double time_s);

/// Runs the filter along an arc. `visit(k, predicted, innovation, filtered)` is called at each
/// epoch; the innovation is null where the epoch has no measurement. The first epoch must have one.
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
        Innovation<Axes> seen = filter.innovation(predicted, *arc[k].measurement);
        seen.tests_model = !unknowns.determined_by_measurement();
        filter.take_in(estimate, *arc[k].measurement);
        visit(k, predicted, &seen, estimate);
    }
}

/// Time (s) over which an estimate under the model forgets what was before by a factor of 1e12,
/// twelve digits of the distance of what is supposed there from what is: 28 times the longest time
/// constant of the filter, which is below the correlation time of the time-correlated error, two
/// intervals, and twice the times in which the motion becomes as uncertain as white noise and
/// time-correlated error leave it ((density / jerk density)^(1/3), the pole of the steady filter of
/// third order). White noise, at its largest, and mean interval are those of the epochs, of which
/// there must be two.
template <int Axes>
double memory_s(std::span<const ArcEpoch<Axes>> epochs, const EstimationModel& model);

}  // namespace runcert
