#include "stages/window/position_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/accuracy_measures.h"
#include "core/uncertainty.h"

namespace runcert {
namespace {

template <int Axes>
double variance_of(const WindowStretch<Axes>& stretch, const EstimationModel& model,
                   const SpeedQuantity& quantity) {
    const SpeedEstimate speed = speed_by_definition(smooth<Axes>(stretch.epochs, model),
                                                    stretch.window, stretch.duration_s, quantity);
    return speed.standard_uncertainty_mps * speed.standard_uncertainty_mps;
}

/// Derivative of the variance by the logarithm of one noise's variance, by central difference.
template <int Axes, class Scale>
double part_of(const WindowStretch<Axes>& stretch, const EstimationModel& model,
               const SpeedQuantity& quantity, Scale&& scale) {
    constexpr double step = 1e-3;
    EstimationModel more = model;
    EstimationModel less = model;
    scale(more, std::exp(0.5 * step));
    scale(less, std::exp(-0.5 * step));
    return (variance_of(stretch, more, quantity) - variance_of(stretch, less, quantity)) /
           (2.0 * step);
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
    bound.stated_m = noise.white_scale * std::sqrt(sum / static_cast<double>(count));
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

EstimationModel bounded_model(const NoiseSummary& noise, const ErrorBound& bound) {
    EstimationModel model = model_of(noise);
    model.error = GaussMarkovError::bounding(bound.sigma_m, bound.tau_min_s, bound.tau_max_s);
    return model;
}

template <int Axes>
PositionNoise position_noise(const WindowStretch<Axes>& stretch, const EstimationModel& model,
                             const SpeedQuantity& quantity) {
    constexpr int counted = counted_axes<Axes>;
    const SmoothedArc<Axes> smoothed = smooth<Axes>(stretch.epochs, model);
    PositionNoise noise;
    noise.speed = speed_by_definition(smoothed, stretch.window, stretch.duration_s, quantity);
    noise.displacement_m = displacement(smoothed, stretch.window.first, stretch.window.last).norm();
    noise.velocity_covariance.topLeftCorner<counted, counted>() =
        displacement_covariance(smoothed, stretch.window.first, stretch.window.last) /
        (stretch.duration_s * stretch.duration_s);
    const double white = part_of(stretch, model, quantity, [](EstimationModel& one, double by) {
        one.measurement_scale *= by;
    });
    const double correlated =
        part_of(stretch, model, quantity, [](EstimationModel& one, double by) {
            one.error.process_density *= by;
            one.error.initial_sigma_m *= by;
        });
    const double whole =
        noise.speed.standard_uncertainty_mps * noise.speed.standard_uncertainty_mps;
    const auto root = [](double variance) { return std::sqrt(std::max(variance, 0.0)); };
    noise.white_mps = root(white);
    noise.correlated_mps = root(correlated);
    noise.motion_mps = root(whole - white - correlated);
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
    template PositionNoise position_noise<AXES>(const WindowStretch<AXES>&,                    \
                                                const EstimationModel&, const SpeedQuantity&); \
    template FittedSpeed fitted_speed<AXES>(                                                   \
        const WindowStretch<AXES>&, const std::vector<WeightedModel>&, const SpeedQuantity&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)

}  // namespace runcert
