#include "witness/velocity_witness.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr std::array spans_s{3.0, 10.0, 30.0, 100.0, 300.0};

/// Integral, over the fraction `s` of a step, of the cubic with these values and slopes at its
/// ends.
template <class Value>
Value hermite_integral(double step_s, double s, const Value& before, const Value& after,
                       const Value& slope_before, const Value& slope_after) {
    const double s2 = s * s, s3 = s2 * s, s4 = s3 * s;
    return step_s * ((s - s3 + 0.5 * s4) * before + (s3 - 0.5 * s4) * after +
                     step_s * ((0.5 * s2 - 2.0 * s3 / 3.0 + 0.25 * s4) * slope_before +
                               (0.25 * s4 - s3 / 3.0) * slope_after));
}

template <class Value>
Value hermite(double step_s, double s, const Value& before, const Value& after,
              const Value& slope_before, const Value& slope_after) {
    const double s2 = s * s, s3 = s2 * s;
    return (1.0 - 3.0 * s2 + 2.0 * s3) * before + (3.0 * s2 - 2.0 * s3) * after +
           step_s * ((s - 2.0 * s2 + s3) * slope_before + (s3 - s2) * slope_after);
}

/// The slope of the velocity at a sample, from its neighbours in the same stretch.
template <int Axes>
PositionVector<Axes> slope_at(const std::vector<TimedVelocity<Axes>>& samples, std::size_t k) {
    const bool before = k > 0 && samples[k - 1].stretch == samples[k].stretch;
    const bool after = k + 1 < samples.size() && samples[k + 1].stretch == samples[k].stretch;
    if (!before && !after) return PositionVector<Axes>::Zero();
    const TimedVelocity<Axes>& from = samples[before ? k - 1 : k];
    const TimedVelocity<Axes>& to = samples[after ? k + 1 : k];
    return (to.velocity - from.velocity) / (to.time_s - from.time_s);
}

}  // namespace

double integrated_gauss_markov(double time_s, double tau_s) {
    return 2.0 * tau_s * (time_s + tau_s * std::expm1(-time_s / tau_s));
}

double VelocityErrorModel::displacement_variance(double time_s) const {
    const double lasting = integrated_gauss_markov(time_s, correlation_time_s);
    double variance = density * density * time_s;
    if (stated_m_s) variance = std::min(variance, *stated_m_s * *stated_m_s * lasting);
    return std::max(variance, shown_m_s * shown_m_s * time_s * time_s);
}

template <int Axes>
VelocityWitness<Axes>::VelocityWitness(std::vector<TimedVelocity<Axes>> samples,
                                       const VelocityErrorModel& errors, double jerk_density)
    : samples_(std::move(samples)), errors_(errors), jerk_density_(jerk_density) {
    const std::size_t count = samples_.size();
    slopes_.reserve(count);
    for (std::size_t k = 0; k < count; ++k)
        slopes_.push_back(slope_at(samples_, k));
    displacement_.assign(count, PositionVector<Axes>::Zero());
    path_.assign(count, 0.0);
    unseen_.assign(count, 0.0);
    worse_.assign(count + 1, 0.0);
    for (std::size_t k = 0; k < count; ++k)
        worse_[k + 1] = worse_[k] + samples_[k].worse * samples_[k].worse;
    for (std::size_t k = 1; k < count; ++k) {
        displacement_[k] = displacement_[k - 1];
        path_[k] = path_[k - 1];
        unseen_[k] = unseen_[k - 1];
        if (samples_[k].stretch != samples_[k - 1].stretch) continue;
        const double h = step_s(k - 1);
        assert(h > 0.0);
        displacement_[k] += displacement_in_step(k - 1, 1.0);
        path_[k] += path_in_step(k - 1, 1.0);
        unseen_[k] += std::pow(h, 5);
    }
}

template <int Axes>
std::optional<typename VelocityWitness<Axes>::Instant> VelocityWitness<Axes>::instant_at(
    double time_s) const {
    constexpr double rounding_s = 1e-7;
    const auto after =
        std::ranges::upper_bound(samples_, time_s + rounding_s, {}, &TimedVelocity<Axes>::time_s);
    const auto first = static_cast<std::size_t>(after - samples_.begin());
    if (first == 0) return errors_.delay_s < 0.0 ? instant_beyond(0, 1, time_s) : std::nullopt;
    const std::size_t k = first - 1;
    const double beyond_s = std::max(0.0, time_s - samples_[k].time_s);
    if (beyond_s <= rounding_s) return Instant{.sample = k};
    if (first == samples_.size() || samples_[first].stretch != samples_[k].stretch)
        return errors_.delay_s > 0.0 ? instant_beyond(k, k - 1, time_s)
                                     : instant_beyond(first, first + 1, time_s);
    return Instant{.sample = k, .part = beyond_s / step_s(k)};
}

template <int Axes>
std::optional<typename VelocityWitness<Axes>::Instant> VelocityWitness<Axes>::instant_beyond(
    std::size_t end, std::size_t neighbour, double time_s) const {
    constexpr double rounding_s = 1e-7;
    constexpr double most_steps = 3.0;
    if (end >= samples_.size() || neighbour >= samples_.size() ||
        samples_[neighbour].stretch != samples_[end].stretch)
        return std::nullopt;
    const double beyond_s = time_s - samples_[end].time_s;
    const double step = std::abs(samples_[end].time_s - samples_[neighbour].time_s);
    if (std::abs(beyond_s) > std::min(std::abs(errors_.delay_s), most_steps * step) + rounding_s)
        return std::nullopt;
    return Instant{.sample = end, .part = 0.0, .beyond_s = beyond_s};
}

template <int Axes>
PositionVector<Axes> VelocityWitness<Axes>::velocity_at(const Instant& instant) const {
    const auto [k, part, beyond_s] = instant;
    if (beyond_s != 0.0) return samples_[k].velocity + beyond_s * slopes_[k];
    if (part == 0.0) return samples_[k].velocity;
    return hermite(step_s(k), part, samples_[k].velocity, samples_[k + 1].velocity, slopes_[k],
                   slopes_[k + 1]);
}

template <int Axes>
PositionVector<Axes> VelocityWitness<Axes>::displacement_beyond(const Instant& instant) const {
    return instant.beyond_s * samples_[instant.sample].velocity +
           0.5 * instant.beyond_s * instant.beyond_s * slopes_[instant.sample];
}

/// Variance caused by a white jerk, starting from a known velocity and a slope that is one step
/// old.
template <int Axes>
double VelocityWitness<Axes>::variance_beyond(const Instant& instant) const {
    if (instant.beyond_s == 0.0) return 0.0;
    const std::size_t k = instant.sample;
    const double step =
        k > 0 && samples_[k - 1].stretch == samples_[k].stretch ? step_s(k - 1) : step_s(k);
    const double time = std::abs(instant.beyond_s);
    return jerk_density_ * jerk_density_ *
           (std::pow(time, 5) / 20.0 + 0.25 * std::pow(time, 4) * step);
}

template <int Axes>
PositionVector<Axes> VelocityWitness<Axes>::displacement_in_step(std::size_t k, double part) const {
    return hermite_integral(step_s(k), part, samples_[k].velocity, samples_[k + 1].velocity,
                            slopes_[k], slopes_[k + 1]);
}

/// Integrated by Simpson's rule.
template <int Axes>
double VelocityWitness<Axes>::path_in_step(std::size_t k, double part) const {
    return step_s(k) * part / 6.0 *
           (samples_[k].velocity.norm() + 4.0 * velocity_at({k, 0.5 * part}).norm() +
            velocity_at({k, part}).norm());
}

template <int Axes>
std::optional<typename VelocityWitness<Axes>::Ends> VelocityWitness<Axes>::ends_of(
    double from_s, double to_s) const {
    assert(to_s > from_s);
    const auto from = instant_at(from_s + errors_.delay_s);
    const auto to = instant_at(to_s + errors_.delay_s);
    if (!from || !to || samples_[from->sample].stretch != samples_[to->sample].stretch)
        return std::nullopt;
    return Ends{*from, *to};
}

template <int Axes>
std::optional<WitnessedMotion<Axes>> VelocityWitness<Axes>::between(double from_s,
                                                                    double to_s) const {
    const auto ends = ends_of(from_s, to_s);
    if (!ends) return std::nullopt;
    const auto& [from, to] = *ends;
    WitnessedMotion<Axes> motion;
    motion.displacement_m = displacement_[to.sample] - displacement_[from.sample];
    if (to.part > 0.0) motion.displacement_m += displacement_in_step(to.sample, to.part);
    if (from.part > 0.0) motion.displacement_m -= displacement_in_step(from.sample, from.part);
    motion.displacement_m += displacement_beyond(to) - displacement_beyond(from);
    const std::size_t last = to.sample + (to.part > 0.0 ? 1 : 0);
    // Variance factor of the integral over a step between known velocities and slopes, under a
    // white jerk.
    constexpr double of_step = 1.0 / 720.0;
    const double between_samples =
        jerk_density_ * jerk_density_ * of_step * (unseen_[last] - unseen_[from.sample]);
    const double worse =
        (worse_[last + 1] - worse_[from.sample]) / static_cast<double>(last + 1 - from.sample);
    const PositionVector<Axes> changed = velocity_at(to) - velocity_at(from);
    motion.covariance_m2 =
        (worse * errors_.displacement_variance(to_s - from_s) + between_samples +
         variance_beyond(from) + variance_beyond(to)) *
            PositionMatrix<Axes>::Identity() +
        errors_.sigma_delay_s * errors_.sigma_delay_s * changed * changed.transpose();
    return motion;
}

template <int Axes>
TimeSpan VelocityWitness<Axes>::covered() const {
    if (samples_.empty()) return {};
    return {.first_s = samples_.front().time_s - errors_.delay_s,
            .last_s = samples_.back().time_s - errors_.delay_s};
}

template <int Axes>
std::optional<double> VelocityWitness<Axes>::path_between(double from_s, double to_s) const {
    const auto ends = ends_of(from_s, to_s);
    if (!ends) return std::nullopt;
    const auto& [from, to] = *ends;
    double path_m = path_[to.sample] - path_[from.sample];
    if (to.part > 0.0) path_m += path_in_step(to.sample, to.part);
    if (from.part > 0.0) path_m -= path_in_step(from.sample, from.part);
    const auto along_m = [&](const Instant& instant) {
        return std::copysign(displacement_beyond(instant).norm(), instant.beyond_s);
    };
    return path_m + along_m(to) - along_m(from);
}

template <int Axes>
EstimatedVelocityErrors<Axes> estimate_velocity_errors(
    const VelocityWitness<Axes>& witness, std::span<const TimedPosition<Axes>> positions,
    std::optional<double> stated_m_s) {
    EstimatedVelocityErrors<Axes> estimated;
    VelocityErrorModel& model = estimated.model;
    model = witness.errors();
    model.density = std::numeric_limits<double>::infinity();
    model.shown_m_s = least_velocity_sigma_m_s;
    model.stated_m_s = stated_m_s;
    std::vector<double> sigmas;
    for (const TimedPosition<Axes>& one : positions)
        sigmas.push_back(one.sigma_m);
    if (sigmas.empty()) return estimated;
    const double sigma_m = median(std::move(sigmas));
    // Twice the stated errors at both ends bounds nearly all that positions can explain.
    const double by_positions = 2.0 * (2.0 * sigma_m) * (2.0 * sigma_m);
    for (const double span_s : spans_s) {
        const auto spread = displacement_spread(witness, positions, span_s);
        if (!spread) continue;
        estimated.spreads.push_back(*spread);
        model.density = std::min(model.density, spread->sd_upper_m / std::sqrt(span_s));
        const double beyond = spread->sd_m * spread->sd_m - by_positions;
        if (beyond > 0.0) model.shown_m_s = std::max(model.shown_m_s, std::sqrt(beyond) / span_s);
    }
    return estimated;
}

#define RUNCERT_INSTANTIATE(AXES)                                           \
    template class VelocityWitness<AXES>;                                   \
    template EstimatedVelocityErrors<AXES> estimate_velocity_errors(        \
        const VelocityWitness<AXES>&, std::span<const TimedPosition<AXES>>, \
        std::optional<double>);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
