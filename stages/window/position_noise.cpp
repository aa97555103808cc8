#include "stages/window/position_noise.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/accuracy_measures.h"

namespace runcert {
namespace {

double variance_of(const WindowStretch& stretch, const EstimationModel& model,
                   std::string_view definition) {
    const SpeedEstimate speed = speed_by_definition(smooth<2>(stretch.epochs, model),
                                                    stretch.window, stretch.duration_s, definition);
    return speed.standard_uncertainty_mps * speed.standard_uncertainty_mps;
}

/// Derivative of the variance by the logarithm of one noise's variance, by central difference.
template <class Scale>
double part_of(const WindowStretch& stretch, const EstimationModel& model,
               std::string_view definition, Scale&& scale) {
    constexpr double step = 1e-3;
    EstimationModel more = model;
    EstimationModel less = model;
    scale(more, std::exp(0.5 * step));
    scale(less, std::exp(-0.5 * step));
    return (variance_of(stretch, more, definition) - variance_of(stretch, less, definition)) /
           (2.0 * step);
}

}  // namespace

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
        sum += stated_covariance<2>(row).trace() / 2.0;
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

double position_r95_m(const SmoothedArc<2>& smoothed, EpochPair window, const ErrorBound& bound) {
    double radius_m = 0.0;
    for (const std::size_t k : {window.first, window.last}) {
        const Eigen::Matrix2d covariance =
            smoothed.states[k].covariance.topLeftCorner<2, 2>() +
            bound.sigma_m * bound.sigma_m * Eigen::Matrix2d::Identity();
        radius_m = std::max(radius_m, r95(covariance));
    }
    for (const BridgedStep& step : smoothed.bridged_between(window.first, window.last)) {
        const auto position = [&](std::size_t k) -> Eigen::Vector2d {
            return smoothed.states[k].mean.head<2>();
        };
        const Eigen::Vector2d offset = position(step.epoch) - position(step.epoch - 1) -
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

PositionNoise position_noise(const WindowStretch& stretch, const EstimationModel& model,
                             std::string_view definition) {
    const SmoothedArc<2> smoothed = smooth<2>(stretch.epochs, model);
    PositionNoise noise;
    noise.speed = speed_by_definition(smoothed, stretch.window, stretch.duration_s, definition);
    noise.displacement_m = displacement(smoothed, stretch.window.first, stretch.window.last).norm();
    noise.velocity_covariance =
        displacement_covariance(smoothed, stretch.window.first, stretch.window.last) /
        (stretch.duration_s * stretch.duration_s);
    const double white = part_of(stretch, model, definition, [](EstimationModel& one, double by) {
        one.measurement_scale *= by;
    });
    const double correlated =
        part_of(stretch, model, definition, [](EstimationModel& one, double by) {
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

FittedSpeed fitted_speed(const WindowStretch& stretch, const std::vector<WeightedModel>& models,
                         std::string_view definition) {
    double weight = 0.0;
    double mean = 0.0;
    double square = 0.0;  // of the deviation from the first model's speed
    double first = 0.0;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const SpeedEstimate one =
            speed_by_definition(smooth<2>(stretch.epochs, models[i].model), stretch.window,
                                stretch.duration_s, definition);
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

}  // namespace runcert
