#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "witness/witnessed_spans.h"

namespace runcert {

/// A velocity as recorded (m/s). Those with the same `stretch` follow one another without a hole.
template <int Axes>
struct TimedVelocity {
    double time_s = 0.0;
    PositionVector<Axes> velocity = PositionVector<Axes>::Zero();
    std::int64_t stretch = 0;
    /// By how much less accurate it is stated to be than the middle of the recording's; at least 1.
    double worse = 1.0;
};

/// No estimate of the errors of recorded velocities is better than this: good receivers were seen
/// to err so.
inline constexpr double least_velocity_sigma_m_s = 0.03;

/// The errors of recorded velocities.
///
/// What they leave in a displacement over a time T is known from two sides. The recording shows by
/// how much displacements by velocities and by positions differ, over spans of many lengths L. Of
/// errors that are not negatively correlated the variance of a displacement grows at least as L and
/// at most as its square. So that of any longer span times T / L bounds it from above: `density` is
/// the least sd / sqrt(L) over all spans. And what a span shows beyond all that the positions' own
/// errors can explain bounds it from below, by (T / L)^2: `shown_m_s` is the largest such sd / L.
/// Between the two the stated standard deviation holds, taken as one error that lasts for
/// `correlation_time_s`. What is estimated is never better than `least_velocity_sigma_m_s`.
struct VelocityErrorModel {
    double delay_s = 0.0;        ///< of the recorded velocity behind the position
    double sigma_delay_s = 0.0;  ///< its standard uncertainty
    double density = std::numeric_limits<double>::infinity();  ///< m s^-1/2, each axis
    std::optional<double> stated_m_s;                          ///< standard deviation, each axis
    double shown_m_s = 0.0;                                    ///< of one that lasts, each axis
    double correlation_time_s = 10.0;

    /// Whether anything bounds the errors.
    bool is_known() const { return std::isfinite(density) || stated_m_s.has_value(); }

    /// Variance (m^2), each axis, of a displacement over `time_s`, without that of the delay.
    double displacement_variance(double time_s) const;
};

/// Variance of the integral, over `time_s`, of a first-order Gauss-Markov process with unit
/// variance and this correlation time: 2 tau (T - tau (1 - exp(-T / tau))), s^2.
double integrated_gauss_markov(double time_s, double tau_s);

/// Recorded velocities as a witness: their integral, between samples by cubic Hermite polynomials
/// whose slopes are the differences of neighbours, taken a delay later. The covariance is that of
/// the error model, of the delay (by what the velocity changes between the two instants), and of
/// what the craft may do between samples with a white jerk of `jerk_density` (m s^-2.5). Where
/// samples are stated to be worse than most, so is that of the error model. Where the
/// delay reaches beyond a stretch, by three of its steps at most, the velocity is taken to go on
/// changing as it did, and what a white jerk may do there is added: else the end of a recording had
/// no witness.
template <int Axes>
class VelocityWitness final : public Witness<Axes> {
  public:
    /// `samples` with increasing times within each stretch, stretches one after the other.
    VelocityWitness(std::vector<TimedVelocity<Axes>> samples, const VelocityErrorModel& errors,
                    double jerk_density);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    std::optional<double> path_between(double from_s, double to_s) const override;

    const VelocityErrorModel& errors() const { return errors_; }

  private:
    /// An instant: the sample before it, and the part of the step after that sample, 0 to 1; or how
    /// far it lies beyond the first or last sample of a stretch, s.
    struct Place {
        std::size_t sample = 0;
        double part = 0.0;
        double beyond_s = 0.0;
    };
    struct Ends {
        Place from, to;
    };
    std::optional<Place> place_of(double time_s) const;
    /// Beyond a stretch's first or last sample, by the delay at most.
    std::optional<Place> place_beyond(std::size_t end, std::size_t neighbour, double time_s) const;
    /// Where samples of one stretch cover all of it, a delay later.
    std::optional<Ends> ends_of(double from_s, double to_s) const;
    double step_s(std::size_t k) const { return samples_[k + 1].time_s - samples_[k].time_s; }
    PositionVector<Axes> velocity_at(const Place& place) const;
    /// From the first or last sample on.
    PositionVector<Axes> moved_beyond(const Place& place) const;
    double variance_beyond(const Place& place) const;
    /// From a sample to a part of the step after it.
    PositionVector<Axes> moved_in_step(std::size_t k, double part) const;
    double path_in_step(std::size_t k, double part) const;

    std::vector<TimedVelocity<Axes>> samples_;
    std::vector<PositionVector<Axes>> slopes_;
    std::vector<PositionVector<Axes>> moved_;  ///< up to each sample
    std::vector<double> path_;
    std::vector<double> worse_;   ///< sum of the squares before each sample
    std::vector<double> unseen_;  ///< sum of the fifth powers of the steps up to each sample, s^5
    VelocityErrorModel errors_;
    double jerk_density_;
};

/// The error model of velocities that lag by `delay_s`, with the spreads over 3, 10, 30, 100 and
/// 300 s that it comes from. `witness` needs the delay alone in its errors.
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
