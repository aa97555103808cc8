#include "stages/window/selection.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "core/statistics.h"
#include "stages/window/selection_cluster.h"

namespace runcert {
namespace {

/// The fastest window over all clusters.
struct Draw {
    FastestWindow fastest;
    // Change of the chosen window's error caused by noise. Its mean is known to be zero, so
    // subtracting it makes the mean converge with fewer draws. It is zero in all clusters but one.
    double chosen_noise_m_s = 0.0;

    void take(const FastestWindow& one, double chosen_error_without_noise_m_s) {
        chosen_noise_m_s += one.chosen_error_m_s - chosen_error_without_noise_m_s;
        if (one.searched_m_s > fastest.searched_m_s) fastest = one;
    }
    double settled_error_m_s() const { return fastest.error_m_s - chosen_noise_m_s; }
};

struct Sample {
    Draw once;
    Draw again;
    double fastest_true_m_s = 0.0;

    void take(const ClusterDraw& drawn) {
        once.take(drawn.once, drawn.chosen_without_noise_once_m_s);
        again.take(drawn.again, drawn.chosen_without_noise_again_m_s);
        fastest_true_m_s = std::max(fastest_true_m_s, drawn.fastest_true_m_s);
    }
};

using Samples = std::array<Sample, selection_lanes>;

/// The samples for the numbers drawn, which are ordered by sample, then cluster.
template <int Axes>
Samples samples_from(const std::vector<SelectionCluster<Axes>>& clusters,
                     const std::vector<double>& numbers,
                     const std::optional<std::array<double, selection_lanes>>& tau_s) {
    std::array<const double*, selection_lanes> at;
    for (std::size_t l = 0; l < selection_lanes; ++l)
        at[l] = numbers.data() + l * (numbers.size() / selection_lanes);
    Samples samples;
    for (const SelectionCluster<Axes>& cluster : clusters) {
        const auto drawn = cluster.draw(at, tau_s);
        for (std::size_t l = 0; l < selection_lanes; ++l) {
            samples[l].take(drawn[l]);
            at[l] += cluster.normals();
        }
    }
    return samples;
}

/// Correlation times of the samples from `first` on, out of `samples`, spread evenly in the
/// logarithm over the range.
std::array<double, selection_lanes> correlation_times(const SelectionModels& models,
                                                      std::int64_t first, std::int64_t samples) {
    std::array<double, selection_lanes> tau_s;
    for (std::size_t l = 0; l < selection_lanes; ++l)
        tau_s[l] = models.tau_min_s *
                   std::pow(models.tau_max_s / models.tau_min_s,
                            (static_cast<double>(first) + static_cast<double>(l) + 0.5) /
                                static_cast<double>(samples));
    return tau_s;
}

/// All samples, in order. The random numbers are drawn in that order too; everything else runs on
/// several threads.
template <int Axes>
std::vector<Samples> draw_samples(const std::vector<SelectionCluster<Axes>>& clusters,
                                  const SelectionModels& models, DrawnErrors errors,
                                  std::int64_t samples, std::int64_t seed) {
    std::size_t normals = 0;
    for (const SelectionCluster<Axes>& cluster : clusters)
        normals += cluster.normals();
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    Turnstile turnstile;
    constexpr auto at_once = static_cast<std::int64_t>(selection_lanes);
    const std::int64_t passes = (samples + at_once - 1) / at_once;
    return results_of(passes, threads_allowed(), [&](std::int64_t i) {
        const auto numbers =
            turnstile.pass(i, [&] { return random.normals(selection_lanes * normals); });
        if (errors == DrawnErrors::fitted) return samples_from(clusters, numbers, std::nullopt);
        return samples_from(clusters, numbers,
                            correlation_times(models, i * at_once, passes * at_once));
    });
}

/// The bias estimated from the samples.
struct DrawnBias {
    double bias_m_s = 0.0;
    double uncertainty_m_s = 0.0;
    double chosen_sd_m_s = 0.0;
    double best_mean_m_s = 0.0;
    double best_sd_m_s = 0.0;
};

DrawnBias bias_from(const std::vector<Samples>& drawn, std::int64_t samples) {
    std::vector<double> errors;
    std::vector<double> calibrated;
    std::vector<double> best_true;
    for (std::size_t i = 0; i < static_cast<std::size_t>(samples); ++i) {
        const Sample& sample = drawn[i / selection_lanes][i % selection_lanes];
        errors.push_back(sample.once.fastest.error_m_s);
        calibrated.push_back(2.0 * sample.once.settled_error_m_s() -
                             sample.again.settled_error_m_s());
        best_true.push_back(sample.fastest_true_m_s);
    }
    return {
        .bias_m_s = mean(calibrated),
        .uncertainty_m_s = standard_deviation(calibrated) / std::sqrt(static_cast<double>(samples)),
        .chosen_sd_m_s = standard_deviation(errors),
        .best_mean_m_s = mean(best_true),
        .best_sd_m_s = standard_deviation(best_true)};
}

}  // namespace

double less_bias(double speed_m_s, double bias_m_s) {
    return std::max(0.0, speed_m_s - bias_m_s);
}

template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed) {
    constexpr std::int64_t most_numbers = 64'000'000, fewest_draws = 50;
    std::vector<SelectionCluster<Axes>> parts;
    SelectionBias result{.chosen_mean_m_s = stated_m_s, .best_mean_m_s = stated_m_s, .seed = seed};
    std::int64_t numbers = 1;
    for (const WindowCluster<Axes>& cluster : clusters) {
        result.candidates += std::ssize(cluster.windows);
        if (samples == 0) continue;
        parts.emplace_back(cluster, models);
        numbers += static_cast<std::int64_t>(parts.back().normals());
    }
    if (samples == 0) return result;
    samples = std::min(samples, std::max(fewest_draws, most_numbers / numbers));
    const DrawnBias fitted =
        bias_from(draw_samples(parts, models, DrawnErrors::fitted, samples, seed), samples);
    const DrawnBias bounded =
        bias_from(draw_samples(parts, models, DrawnErrors::bounded, samples, seed), samples);
    // Choosing the fastest never makes the speed too low.
    result.fitted_bias_m_s = std::max(0.0, fitted.bias_m_s);
    result.bounded_bias_m_s = std::max(result.fitted_bias_m_s, bounded.bias_m_s);
    result.bias_m_s = 0.5 * (result.fitted_bias_m_s + result.bounded_bias_m_s);
    result.bias_half_range_m_s = 0.5 * (result.bounded_bias_m_s - result.fitted_bias_m_s);
    result.bias_uncertainty_m_s = std::max(fitted.uncertainty_m_s, bounded.uncertainty_m_s);
    result.chosen_mean_m_s = stated_m_s - result.bias_m_s;
    result.chosen_sd_m_s = bounded.chosen_sd_m_s;
    result.best_mean_m_s = bounded.best_mean_m_s;
    result.best_sd_m_s = bounded.best_sd_m_s;
    result.samples = samples;
    return result;
}

template SelectionBias selection_bias<1>(const std::vector<WindowCluster<1>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);
template SelectionBias selection_bias<2>(const std::vector<WindowCluster<2>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);

}  // namespace runcert
