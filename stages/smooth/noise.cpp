#include "stages/smooth/noise.h"

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "motion/local_motion.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

constexpr int decimals = 6;

double six_digits(double value) {
    return rounded(value, decimals);
}

NoiseParameter parameter(const FittedParameter& fitted) {
    NoiseParameter result{.value = six_digits(fitted.value),
                          .relative_uncertainty = std::nullopt,
                          .at_bound = fitted.at_bound};
    if (std::isfinite(fitted.relative_uncertainty))
        result.relative_uncertainty = six_digits(fitted.relative_uncertainty);
    return result;
}

NoiseModelShare share(const WeightedModel& one) {
    NoiseModelShare result{.weight = six_digits(one.weight),
                           .jerk_density = six_digits(one.model.motion.jerk_density),
                           .acceleration_time_s = std::nullopt,
                           .measurement_scale = six_digits(one.model.measurement_scale),
                           .error_sigma_m = six_digits(one.model.error.initial_sigma_m),
                           .error_tau_s = six_digits(one.model.error.tau_s)};
    if (std::isfinite(one.model.motion.acceleration_time_s))
        result.acceleration_time_s = six_digits(one.model.motion.acceleration_time_s);
    return result;
}

template <int Axes>
void describe_stated(const std::vector<Arc<Axes>>& arcs, NoiseSummary& noise) {
    double sum = 0.0;
    const PositionMatrix<Axes>* first = nullptr;
    noise.stated_all_equal = true;
    for (const Arc<Axes>& arc : arcs)
        for (const ArcEpoch<Axes>& epoch : arc.epochs) {
            if (!epoch.measurement) continue;
            const PositionMatrix<Axes>& stated = epoch.measurement->covariance;
            if (!first) first = &stated;
            noise.stated_all_equal = noise.stated_all_equal && stated == *first;
            sum += stated.trace() / Axes;
            ++noise.epochs;
        }
    if (noise.epochs > 0)
        noise.stated_sigma_m = six_digits(std::sqrt(sum / static_cast<double>(noise.epochs)));
}

template <int Axes>
std::vector<std::span<const ArcEpoch<Axes>>> spans_of(const std::vector<Arc<Axes>>& arcs) {
    std::vector<std::span<const ArcEpoch<Axes>>> spans;
    spans.reserve(arcs.size());
    for (const Arc<Axes>& arc : arcs)
        spans.emplace_back(arc.epochs);
    return spans;
}

void set_noise(const NoiseFit& fit, NoiseSummary& noise) {
    noise.status = NoiseBasis::fitted;
    noise.jerk_density = parameter(fit.jerk_density);
    noise.measurement_scale = parameter(fit.measurement_scale);
    if (std::isfinite(fit.acceleration_time.value))
        noise.acceleration_time_s = parameter(fit.acceleration_time);
    noise.singer_gain = rounded(fit.singer_gain, 2);
    noise.correlated_error_detected = fit.correlated_error_detected;
    noise.error_gain = rounded(fit.error_gain, 2);
    if (fit.correlated_error_detected) {
        noise.error_diffusion = parameter(fit.error_diffusion);
        noise.error_tau_s = parameter(fit.error_tau);
        noise.error_sigma_m = parameter(fit.error_sigma);
    }
    noise.white_scale = six_digits(fit.white_scale);
    noise.passes = rounded(fit.passes, 1);
    noise.converged = fit.converged;
    for (const WeightedModel& one : fit.posterior)
        noise.posterior.push_back(share(one));
}

/// Sets the noise as stated, times the a posteriori variance factor if that exceeds 1.
template <int Axes>
void scale_stated(const std::vector<Arc<Axes>>& arcs, NoiseSummary& noise) {
    const auto spans = spans_of(arcs);
    const InnovationSums sums = innovation_sums<Axes>(spans, model_of(noise));
    if (sums.values == 0) return;
    const double factor = std::sqrt(sums.statistic / static_cast<double>(sums.values));
    noise.white_scale = six_digits(factor);
    const double applied = six_digits(std::max(1.0, factor));
    noise.measurement_scale.value = applied;
    noise.jerk_density.value = six_digits(noise.jerk_density.value * applied);
}

/// Sets the jerk density along the recording, in units of that of the whole, for fitting the noise.
template <int Axes>
void follow_motion(std::vector<Arc<Axes>>& arcs) {
    const LocalMotion motion = local_motion<Axes>(spans_of(arcs));
    for (std::size_t a = 0; a < motion.jerk_density.size(); ++a)
        for (std::size_t k = 0; k < arcs[a].epochs.size(); ++k)
            arcs[a].epochs[k].jerk_factor = motion.jerk_density[a][k] / motion.whole;
}

template <int Axes>
void forget_motion(std::vector<Arc<Axes>>& arcs) {
    for (Arc<Axes>& arc : arcs)
        for (ArcEpoch<Axes>& epoch : arc.epochs)
            epoch.jerk_factor = 1.0;
}

}  // namespace

template <int Axes>
NoiseSummary estimate_noise(std::vector<Arc<Axes>>& arcs, const SmoothConfig& config) {
    NoiseSummary noise;
    noise.epochs_needed = config.fit.epochs_needed + measurements_of_the_prior * std::ssize(arcs);
    noise.tau_min_s = config.fit.tau_min_s;
    noise.tau_max_s = config.fit.tau_max_s;
    noise.jerk_density.value = config.fit.initial_jerk_density;
    noise.measurement_scale.value = 1.0;
    describe_stated(arcs, noise);
    if (config.fit_noise) {
        follow_motion(arcs);
        const NoiseFit fit = fit_noise<Axes>(spans_of(arcs), config.fit);
        if (fit.status == NoiseFit::Status::fitted) {
            set_noise(fit, noise);
            return noise;
        }
        forget_motion(arcs);
        noise.status = basis_of(fit.status);
    } else {
        noise.status = NoiseBasis::stated;
    }
    scale_stated(arcs, noise);
    return noise;
}

template <int Axes>
void set_jerk_densities(std::vector<Arc<Axes>>& arcs, const NoiseSummary& noise,
                        const SmoothConfig& config) {
    if (noise.status != NoiseBasis::fitted) return;
    const double fitted = noise.jerk_density.value;
    const double of_class = config.fit.initial_jerk_density;
    for (Arc<Axes>& arc : arcs)
        for (ArcEpoch<Axes>& epoch : arc.epochs)
            epoch.jerk_factor =
                six_digits(std::max(of_class, fitted * std::max(1.0, epoch.jerk_factor))) / fitted;
}

template void set_jerk_densities<1>(std::vector<Arc<1>>&, const NoiseSummary&, const SmoothConfig&);
template void set_jerk_densities<2>(std::vector<Arc<2>>&, const NoiseSummary&, const SmoothConfig&);

template NoiseSummary estimate_noise<1>(std::vector<Arc<1>>&, const SmoothConfig&);
template NoiseSummary estimate_noise<2>(std::vector<Arc<2>>&, const SmoothConfig&);

}  // namespace runcert
