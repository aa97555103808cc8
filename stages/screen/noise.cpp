#include "stages/screen/noise.h"

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "core/statistics.h"
#include "motion/noise_fit.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

constexpr std::size_t epochs_of_fit = 3000;
constexpr std::size_t epochs_of_stretch = 300;

/// The arcs or, if they are long, stretches evenly spread over them.
template <int Axes>
std::vector<std::span<const ArcEpoch<Axes>>> stretches_of(const std::vector<Arc<Axes>>& arcs) {
    std::vector<std::span<const ArcEpoch<Axes>>> stretches;
    std::size_t epochs = 0;
    for (const Arc<Axes>& arc : arcs)
        epochs += arc.epochs.size();
    const std::size_t every =
        epochs_of_stretch * std::max<std::size_t>(1, (epochs + epochs_of_fit - 1) / epochs_of_fit);
    std::size_t to_next = 0;  // epochs to skip before the next stretch
    for (const Arc<Axes>& arc : arcs) {
        const std::span<const ArcEpoch<Axes>> all(arc.epochs);
        if (epochs <= epochs_of_fit) {
            stretches.push_back(all);
            continue;
        }
        std::size_t k = to_next;
        for (; k < all.size(); k += every) {
            while (k < all.size() && !all[k].measurement)
                ++k;
            if (k < all.size())
                stretches.push_back(all.subspan(k, std::min(epochs_of_stretch, all.size() - k)));
        }
        to_next = k - all.size();
    }
    return stretches;
}

/// The scale of the stated standard deviations: the square root of the median innovation statistic
/// over its expected median, at least 1.
template <int Axes>
double robust_scale(const std::vector<std::span<const ArcEpoch<Axes>>>& stretches,
                    const EstimationModel& model) {
    std::vector<double> statistics;
    KalmanFilter<Axes> filter(model);
    for (const auto& stretch : stretches) {
        filter_along<Axes>(
            filter, stretch,
            [&](std::size_t, const auto&, const Innovation<Axes>* seen, const auto&) {
                if (seen && seen->tests_model) statistics.push_back(seen->statistic());
            });
    }
    if (statistics.empty()) return 1.0;
    return std::sqrt(std::max(1.0, median(statistics) / chi_squared_quantile(0.5, Axes)));
}

/// Whether most usable epochs have a velocity.
bool has_velocities(const ScreenedTable& table) {
    std::int64_t usable = 0;
    std::int64_t recorded = 0;
    for (const ScreenedEpoch& row : table.rows) {
        usable += row.usable ? 1 : 0;
        recorded += row.usable && row.recorded_velocity_east_m_s ? 1 : 0;
    }
    return 2 * recorded > usable;
}

}  // namespace

template <int Axes>
ScreeningNoise estimate_screening_noise(const ScreenedTable& first_look,
                                        const ScreenConfig& config) {
    const std::vector<Arc<Axes>> arcs = arcs_of<Axes>(first_look);
    const auto stretches = stretches_of<Axes>(arcs);
    ScreeningNoise noise;
    EstimationModel& model = noise.model;
    model.motion.jerk_density = config.jerk_density;
    noise.summary.axes = tested_axes<Axes>;
    noise.summary.noise = NoiseBasis::stated;
    if (config.noise == NoiseChoice::fitted) {
        const NoiseFit fit =
            fit_noise<Axes>(stretches, {.initial_jerk_density = config.jerk_density,
                                        .tau_min_s = config.tau_min_s,
                                        .tau_max_s = config.tau_max_s,
                                        .motion = NoiseFitOptions::Motion::constant_acceleration});
        noise.summary.noise = basis_of(fit.status);
        if (fit.status == NoiseFit::Status::fitted) {
            model = fit.model;
            noise.fitted = fit.model;
            noise.summary.white_scale = fit.white_scale;
            model.motion.jerk_density = std::max(config.jerk_density, fit.jerk_density.value);
            if (has_velocities(first_look))
                model.measurement_scale = std::max(model.measurement_scale, config.noise_scale_min);
        }
    }
    if (noise.summary.noise != NoiseBasis::fitted) {
        model.measurement_scale = robust_scale<Axes>(stretches, model);
        noise.fitted = model;
        noise.summary.white_scale = model.measurement_scale;
    }
    constexpr int decimals = 6;
    model.motion.jerk_density = rounded(model.motion.jerk_density, decimals);
    model.measurement_scale = rounded(model.measurement_scale, decimals);
    model.error = GaussMarkovError::steady(rounded(model.error.initial_sigma_m, decimals),
                                           rounded(model.error.tau_s, decimals));
    noise.summary.white_scale = rounded(noise.summary.white_scale, decimals);
    noise.summary.jerk_density = model.motion.jerk_density;
    noise.summary.measurement_scale = model.measurement_scale;
    noise.summary.error_sigma_m = model.error.initial_sigma_m;
    noise.summary.error_tau_s = model.error.tau_s;
    return noise;
}

template ScreeningNoise estimate_screening_noise<1>(const ScreenedTable&, const ScreenConfig&);
template ScreeningNoise estimate_screening_noise<2>(const ScreenedTable&, const ScreenConfig&);

}  // namespace runcert
