#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "witness/witnessed_spans.h"

namespace runcert {

/// A recorded velocity (m/s). Those with the same `stretch` follow one another without a gap.
template <int Axes>
struct TimedVelocity {
    double time_s = 0.0;
    PositionVector<Axes> velocity = PositionVector<Axes>::Zero();
    std::int64_t stretch = 0;
    /// Ratio of its stated standard deviation to the median of the recording; at least 1.
    double worse = 1.0;
};

/// Least error assumed for recorded velocities whose errors are estimated. Good receivers have been
/// seen to err by this much.
inline constexpr double least_velocity_sigma_m_s = 0.03;

/// The errors of recorded velocities.
///
/// Their effect on a displacement over a time T is bounded from two sides. The recording shows how
/// much displacements by velocities and by positions differ, over spans of many lengths L. If
/// errors are not negatively correlated, the variance of a displacement grows at least as L and at
/// most as its square. The variance over any longer span, times T / L, is therefore an upper bound:
/// `density` is the least sd / sqrt(L) over all spans.
///
/// What a span shows beyond all that the positions' own errors can explain gives a lower bound, by
/// (T / L)^2: `shown_m_s` is the largest such sd / L. Between the two the stated standard deviation
/// applies, as one error that lasts for `correlation_time_s`. The estimate is never below
/// `least_velocity_sigma_m_s`.
struct VelocityErrorModel {
    double delay_s = 0.0;        ///< of the recorded velocity relative to the position
    double sigma_delay_s = 0.0;  ///< its standard uncertainty
    double density = std::numeric_limits<double>::infinity();  ///< m s^-1/2, each axis
    std::optional<double> stated_m_s;                          ///< standard deviation, each axis
    double shown_m_s = 0.0;                                    ///< of a lasting error, each axis
    double correlation_time_s = 10.0;

    /// Whether anything bounds the errors.
    bool is_known() const { return std::isfinite(density) || stated_m_s.has_value(); }

    /// Variance (m^2) on each axis of a displacement over `time_s`, without the part from the
    /// delay.
    double displacement_variance(double time_s) const;
};

/// Variance of the integral, over `time_s`, of a first-order Gauss-Markov process with unit
/// variance and this correlation time: 2 tau (T - tau (1 - exp(-T / tau))), s^2.
double integrated_gauss_markov(double time_s, double tau_s);

/// Recorded velocities as a witness. They are integrated, one delay later, as cubic Hermite
/// polynomials between samples, with slopes from the differences of neighbours.
///
/// The covariance has three parts. One is the error model, enlarged where samples are stated to be
/// less accurate than most. One is the delay, by the change of velocity between the two instants.
/// The third is the craft's motion between samples, with a white jerk of `jerk_density` (m s^-2.5).
///
/// Where the delay reaches beyond a stretch, by three of its steps at most, the velocity is
/// extrapolated, with the variance of a white jerk added. Otherwise the end of a recording would
/// have no witness.
template <int Axes>
class VelocityWitness final : public Witness<Axes> {
  public:
    /// The times of `samples` must increase within each stretch, and stretches must follow one
    /// another.
    VelocityWitness(std::vector<TimedVelocity<Axes>> samples, const VelocityErrorModel& errors,
                    double jerk_density);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    std::optional<double> path_between(double from_s, double to_s) const override;

    const VelocityErrorModel& errors() const { return errors_; }

  private:
    /// An instant: the preceding sample and the fraction of the step after it, 0 to 1. Beyond the
    /// ends of a stretch, it is how far the instant lies outside the first or last sample, s.
    struct Instant {
        std::size_t sample = 0;
        double part = 0.0;
        double beyond_s = 0.0;
    };
    struct Ends {
        Instant from, to;
    };
    std::optional<Instant> instant_at(double time_s) const;
    /// An instant beyond a stretch's first or last sample, by the delay at most.
    std::optional<Instant> instant_beyond(std::size_t end, std::size_t neighbour,
                                          double time_s) const;
    /// The two ends of a span, one delay later. Empty unless samples of one stretch cover all of
    /// it.
    std::optional<Ends> ends_of(double from_s, double to_s) const;
    double step_s(std::size_t k) const { return samples_[k + 1].time_s - samples_[k].time_s; }
    PositionVector<Axes> velocity_at(const Instant& instant) const;
    /// Displacement from the first or last sample to an instant beyond it.
    PositionVector<Axes> displacement_beyond(const Instant& instant) const;
    double variance_beyond(const Instant& instant) const;
    /// Displacement from a sample to a fraction of the step after it.
    PositionVector<Axes> displacement_in_step(std::size_t k, double part) const;
    double path_in_step(std::size_t k, double part) const;

    std::vector<TimedVelocity<Axes>> samples_;
    std::vector<PositionVector<Axes>> slopes_;
    std::vector<PositionVector<Axes>> displacement_;  ///< up to each sample
    std::vector<double> path_;
    std::vector<double> worse_;   ///< sum of the squares of `worse` before each sample
    std::vector<double> unseen_;  ///< sum of the fifth powers of the steps up to each sample, s^5
    VelocityErrorModel errors_;
    double jerk_density_;
};

/// The error model of velocities delayed by `delay_s`, with the spreads over 3, 10, 30, 100 and
/// 300 s from which it is derived. The errors of `witness` need only its delay.
template <int Axes>
struct EstimatedVelocityErrors {
    VelocityErrorModel model;
    std::vector<DisplacementSpread> spreads;
};
template <int Axes>
EstimatedVelocityErrors<Axes> estimate_velocity_errors(
    const VelocityWitness<Axes>& witness, std::span<const TimedPosition<Axes>> positions,
    std::optional<double> stated_m_s);

}  // namespace runcert
