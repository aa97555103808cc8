#include "stages/window/position_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/accuracy_measures.h"
#include "core/uncertainty.h"
#include "estimation/sensitivity.h"

namespace runcert {
namespace {

/// From the measured position at one end of the window to that at the other.
template <int Axes>
PositionVector<Axes> sampled_displacement(std::span<const ArcEpoch<Axes>> epochs,
                                          EpochPair window) {
    return epochs[window.last].measurement.value().position -
           epochs[window.first].measurement.value().position;
}

}  // namespace

template <int Axes>
ErrorBound error_bound(const ScreenedTable& screened, std::size_t first_row, std::size_t last_row,
                       const NoiseSummary& noise, const Profile::Uncertainty& rule) {
    ErrorBound bound;
    bound.tau_min_s = rule.tau_min_s;
    bound.tau_max_s = rule.tau_max_s;
    double sum = 0.0;
    std::int64_t count = 0;
    for (std::size_t i = first_row; i <= last_row; ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable) continue;
        sum += stated_covariance<Axes>(row).trace() / Axes;
        ++count;
        const auto floor = rule.error_floor_m.find(std::string(to_text(row.fix)));
        if (floor != rule.error_floor_m.end() &&
            (bound.floor_fix.empty() || floor->second > bound.floor_m)) {
            bound.floor_m = floor->second;
            bound.floor_fix = floor->first;
        }
    }
    // A scale below one is that of errors which differ from epoch to epoch: the smooth ones it
    // cannot see.
    bound.stated_m = std::max(1.0, noise.white_scale) * std::sqrt(sum / static_cast<double>(count));
    if (noise.error_told)
        bound.fitted_m = noise.error_diffusion->value * std::sqrt(0.5 * rule.tau_min_s);
    bound.sigma_m = std::max({bound.fitted_m, bound.stated_m, bound.floor_m});
    bound.decided_by = bound.sigma_m == bound.floor_m    ? "floor"
                       : bound.sigma_m == bound.stated_m ? "stated"
                                                         : "fitted";
    return bound;
}

template <int Axes>
double position_r95_m(const SmoothedArc<Axes>& smoothed, EpochPair window,
                      const ErrorBound& bound) {
    constexpr int counted = counted_axes<Axes>;
    double radius_m = 0.0;
    for (const std::size_t k : {window.first, window.last}) {
        const CountedMatrix<Axes> covariance =
            smoothed.states[k].covariance.template topLeftCorner<counted, counted>() +
            bound.sigma_m * bound.sigma_m * CountedMatrix<Axes>::Identity();
        if constexpr (Axes == 1)
            radius_m = std::max(
                radius_m, coverage_factor(0.95, std::nullopt) * std::sqrt(covariance.value()));
        else
            radius_m = std::max(radius_m, r95(covariance));
    }
    for (const BridgedStep& step : smoothed.bridged_between(window.first, window.last)) {
        const auto position = [&](std::size_t k) -> CountedVector<Axes> {
            return smoothed.states[k].mean.template head<counted>();
        };
        const CountedVector<Axes> offset = position(step.epoch) - position(step.epoch - 1) -
                                           displacement(smoothed, step.epoch - 1, step.epoch);
        radius_m += offset.norm();
    }
    return radius_m;
}

GaussMarkovError bounding_error(const NoiseSummary& noise, const ErrorBound& bound) {
    const GaussMarkovError error =
        GaussMarkovError::bounding(bound.sigma_m, bound.tau_min_s, bound.tau_max_s);
    if (!noise.error_told) return error;
    return GaussMarkovError::larger(error, GaussMarkovError::bounding_diffusion(
                                               noise.error_diffusion->value, bound.tau_max_s));
}

template <int Axes>
SpeedWeights<Axes> speed_weights(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity) {
    if (quantity.of_samples) {
        SpeedWeights<Axes> weights(at.epochs.size(), PositionVector<Axes>::Zero());
        const PositionVector<Axes> per_second =
            sampled_displacement(at.epochs, at.window).normalized() / at.duration_s;
        weights[at.window.first] = -per_second;
        weights[at.window.last] = per_second;
        return weights;
    }
    const auto [from, gradients] =
        speed_gradients(at.smoothed, at.window, at.duration_s, quantity);
    return sensitivities<Axes>(at.epochs, at.model, at.smoothed, from, gradients);
}

template <int Axes>
PositionNoise position_noise(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                             const SpeedWeights<Axes>& weights, const GaussMarkovError& bounding) {
    PositionNoise noise;
    const double white = weighted_variance<Axes>(at.epochs, at.model.measurement_scale, weights);
    const double correlated = weighted_variance<Axes>(at.epochs, bounding, weights);
    double motion = 0.0;
    if (quantity.of_samples) {
        noise.displacement_m = sampled_displacement(at.epochs, at.window).norm();
        noise.speed.speed_mps = noise.displacement_m / at.duration_s;
    } else {
        noise.speed = speed_by_definition(at.smoothed, at.window, at.duration_s, quantity);
        noise.displacement_m = displacement(at.smoothed, at.window.first, at.window.last).norm();
        motion = noise.speed.standard_uncertainty_mps * noise.speed.standard_uncertainty_mps -
                 white - weighted_variance<Axes>(at.epochs, at.model.error, weights);
    }
    noise.white_mps = std::sqrt(white);
    noise.correlated_mps = std::sqrt(correlated);
    noise.motion_mps = std::sqrt(std::max(motion, 0.0));
    noise.speed.standard_uncertainty_mps =
        std::sqrt(white + correlated + noise.motion_mps * noise.motion_mps);
    return noise;
}

template <int Axes>
FittedSpeed fitted_speed(const WindowStretch<Axes>& stretch,
                         const std::vector<WeightedModel>& models, const SpeedQuantity& quantity) {
    double weight = 0.0;
    double mean = 0.0;
    double square = 0.0;  // of the deviation from the first model's speed
    double first = 0.0;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const SpeedEstimate one = speed_by_definition(smooth<Axes>(stretch.epochs, models[i].model),
                                                      stretch.window, stretch.duration_s, quantity);
        if (i == 0) first = one.speed_mps;
        const double deviation = one.speed_mps - first;
        weight += models[i].weight;
        mean += models[i].weight * deviation;
        square += models[i].weight * (deviation * deviation +
                                      one.standard_uncertainty_mps * one.standard_uncertainty_mps);
    }
    mean /= weight;
    return {.speed_mps = first + mean,
            .standard_uncertainty_mps = std::sqrt(square / weight - mean * mean),
            .models = static_cast<std::int64_t>(models.size())};
}

template double position_r95_m<1>(const SmoothedArc<1>&, EpochPair, const ErrorBound&);
template double position_r95_m<2>(const SmoothedArc<2>&, EpochPair, const ErrorBound&);
#define RUNCERT_INSTANTIATE(AXES)                                                              \
    template ErrorBound error_bound<AXES>(const ScreenedTable&, std::size_t, std::size_t,      \
                                          const NoiseSummary&, const Profile::Uncertainty&);   \
    template SpeedWeights<AXES> speed_weights<AXES>(const EstimatedWindow<AXES>&,              \
                                                    const SpeedQuantity&);                     \
    template PositionNoise position_noise<AXES>(const EstimatedWindow<AXES>&,                  \
                                                const SpeedQuantity&, const SpeedWeights<AXES>&, \
                                                const GaussMarkovError&);                      \
    template FittedSpeed fitted_speed<AXES>(                                                   \
        const WindowStretch<AXES>&, const std::vector<WeightedModel>&, const SpeedQuantity&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)

}  // namespace runcert
