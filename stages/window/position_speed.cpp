#include "stages/window/position_speed.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/accuracy_measures.h"
#include "core/uncertainty.h"
#include "motion/chain.h"
#include "schemas/observations/stated_covariance.h"
#include "stages/window/stands.h"

namespace runcert {
namespace {

/// The measured positions as a track, which has no velocities.
template <int Axes>
auto measured_track(std::span<const ArcEpoch<Axes>> epochs) {
    return SpeedTrack{
        [epochs](std::size_t k) -> PositionVector<Axes> {
            return epochs[k].measurement.value().position;
        },
        [](std::size_t) -> PositionVector<Axes> { return PositionVector<Axes>::Zero(); }};
}

}  // namespace

std::optional<double> error_floor_m(const UncertaintyRule& rule, FixType fix) {
    const auto floor = rule.error_floor_m.find(std::string(to_text(fix)));
    return floor == rule.error_floor_m.end() ? std::nullopt : std::optional(floor->second);
}

template <int Axes>
ErrorBound error_bound(const ScreenedTable& screened, std::size_t first_row, std::size_t last_row,
                       const NoiseSummary& noise, const UncertaintyRule& rule, double along,
                       const std::vector<Stand>& stands) {
    ErrorBound bound;
    bound.along = along;
    bound.tau_min_s = rule.tau_min_s;
    bound.tau_max_s = rule.tau_max_s;
    double sum = 0.0;
    std::int64_t count = 0;
    std::set<FixType> fixes;
    for (std::size_t i = first_row; i <= last_row; ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable) continue;
        sum += stated_covariance<Axes>(row).trace() / Axes;
        ++count;
        fixes.insert(row.fix);
        const auto floor_m = error_floor_m(rule, row.fix);
        if (floor_m && (!bound.floor_fix || *floor_m > bound.floor_m)) {
            bound.floor_m = *floor_m;
            bound.floor_fix = row.fix;
        }
    }
    // A scale below one comes from errors that differ from epoch to epoch. It does not see smooth
    // ones.
    bound.stated_m = std::max(1.0, noise.white_scale) * std::sqrt(sum / static_cast<double>(count));
    if (noise.correlated_error_detected)
        bound.fitted_m = along * noise.error_diffusion->value * std::sqrt(0.5 * rule.tau_min_s);
    const double lag_s =
        screened.rows[last_row].time.seconds() - screened.rows[first_row].time.seconds();
    for (const FixType fix : fixes)
        if (const auto shown =
                standing_error_m<Axes>(screened, stands, fix, lag_s, noise.measurement_scale.value))
            bound.standing_m = std::max(*shown, bound.standing_m.value_or(0.0));
    bound.sigma_m =
        std::max({bound.fitted_m, bound.stated_m, bound.standing_m.value_or(0.0), bound.floor_m});
    bound.decided_by = bound.sigma_m == bound.floor_m    ? BoundSource::floor
                       : bound.sigma_m == bound.stated_m ? BoundSource::stated
                       : bound.sigma_m == bound.fitted_m ? BoundSource::fitted
                                                         : BoundSource::standing;
    return bound;
}

template <int Axes>
double position_r95_m(const Chain<Axes>& smoothed, EpochPair window, const ErrorBound& bound) {
    double radius_m = 0.0;
    for (const std::size_t k : {window.first, window.last}) {
        const SpeedMatrix<Axes> covariance =
            smoothed.covariance_of(0, k) +
            bound.sigma_m * bound.sigma_m * SpeedMatrix<Axes>::Identity();
        if constexpr (Axes == 1)
            radius_m = std::max(
                radius_m, coverage_factor(0.95, std::nullopt) * std::sqrt(covariance.value()));
        else
            radius_m = std::max(radius_m, r95(covariance));
    }
    return radius_m;
}

double sigma_at(const ErrorBound& bound, double tau_s) {
    return std::max(bound.sigma_m, bound.fitted_m * std::sqrt(tau_s / bound.tau_min_s));
}

template <int Axes>
SpeedWeights<Axes> speed_weights(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity) {
    if (quantity.of_samples) {
        SpeedWeights<Axes> weights(at.epochs.size(), PositionVector<Axes>::Zero());
        speed_of(measured_track<Axes>(at.epochs), at.window, at.duration_s, quantity,
                 [&](std::size_t k, const PositionVector<Axes>& weight) { weights[k] += weight; });
        return weights;
    }
    return at.smoothed.weights(at.window.first,
                               speed_gradients(at.smoothed, at.window, at.duration_s, quantity));
}

namespace {

/// Variance of the sum of weight times error, along one axis, for a stationary Gauss-Markov error
/// of variance 1.
template <int Axes>
double unit_variance(std::span<const ArcEpoch<Axes>> epochs, const SpeedWeights<Axes>& weights,
                     Eigen::Index axis, double tau_s) {
    double with_sum = 0.0;  // covariance of the error with the sum so far
    double of_sum = 0.0;
    StepKind kind;
    double decay = 1.0;
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        if (k > 0) {
            const StepKind next = step_kind(epochs[k - 1], epochs[k]);
            if (next.length_ns != kind.length_ns) decay = std::exp(-next.dt_s() / tau_s);
            kind = next;
            with_sum *= decay;
        }
        const double weight = weights[k](axis);
        of_sum += weight * (2.0 * with_sum + weight);
        with_sum += weight;
    }
    return of_sum;
}

/// The largest value of a function of the correlation time between these, which changes little
/// while that time changes by a fifth: it is averaged over times apart by factors of several.
template <class Function>
double largest_over(double tau_min_s, double tau_max_s, const Function& function) {
    constexpr double widest_step = 0.2;  // of the logarithm
    constexpr int refinements = 20;
    const double shortest = std::log(tau_min_s);
    const double range = std::log(tau_max_s) - shortest;
    const double steps = std::ceil(range / widest_step);
    const double step = range / steps;
    std::vector<double> values;
    for (double i = 0.0; i <= steps; ++i)
        values.push_back(function(std::exp(shortest + step * i)));
    const auto best = std::ranges::max_element(values);
    double largest = *best;
    const auto at = static_cast<double>(best - values.begin());
    double from = shortest + step * std::max(at - 1.0, 0.0);
    double to = shortest + step * std::min(at + 1.0, steps);
    // By golden sections between the neighbours of the largest.
    const double part = 1.0 / std::numbers::phi;
    for (int i = 0; i < refinements; ++i) {
        const double lower = to - part * (to - from), upper = from + part * (to - from);
        const double at_lower = function(std::exp(lower)), at_upper = function(std::exp(upper));
        largest = std::max({largest, at_lower, at_upper});
        (at_lower < at_upper ? from : to) = at_lower < at_upper ? lower : upper;
    }
    return largest;
}

}  // namespace

template <int Axes>
double largest_correlated_variance(std::span<const ArcEpoch<Axes>> epochs,
                                   const SpeedWeights<Axes>& weights, const ErrorBound& bound) {
    double sum = 0.0;
    for (Eigen::Index axis = 0; axis < Axes; ++axis)
        sum += largest_over(bound.tau_min_s, bound.tau_max_s, [&](double tau_s) {
            const double sigma_m = sigma_at(bound, tau_s);
            return sigma_m * sigma_m * unit_variance<Axes>(epochs, weights, axis, tau_s);
        });
    return sum;
}

template <int Axes>
PositionSpeed speed_by_positions(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                                 const SpeedWeights<Axes>& weights, const ErrorBound& bound) {
    PositionSpeed measured;
    const double white = weighted_variance<Axes>(at.epochs, at.model.measurement_scale, weights);
    const double correlated = largest_correlated_variance<Axes>(at.epochs, weights, bound);
    double motion = 0.0;
    if (quantity.of_samples) {
        measured.speed.speed_m_s =
            speed_of(measured_track<Axes>(at.epochs), at.window, at.duration_s, quantity);
        measured.displacement_m = measured.speed.speed_m_s * at.duration_s;
    } else {
        measured.speed = smoothed_speed(at.smoothed, at.window, at.duration_s, quantity);
        measured.displacement_m = displacement(at.smoothed, at.window.first, at.window.last).norm();
        motion = measured.speed.standard_uncertainty_m_s * measured.speed.standard_uncertainty_m_s -
                 white - weighted_variance<Axes>(at.epochs, at.model.error, weights);
    }
    measured.white_m_s = std::sqrt(white);
    measured.correlated_m_s = std::sqrt(correlated);
    measured.motion_m_s = std::sqrt(std::max(motion, 0.0));
    measured.speed.standard_uncertainty_m_s =
        std::sqrt(white + correlated + measured.motion_m_s * measured.motion_m_s);
    return measured;
}

double error_along(std::span<const ArcEpoch<2>> epochs, const EstimationModel& model,
                   const Eigen::Vector2d& direction) {
    constexpr int sizes = 6;
    std::vector<ArcEpoch<1>> along;
    along.reserve(epochs.size());
    for (const ArcEpoch<2>& epoch : epochs) {
        ArcEpoch<1>& one = along.emplace_back();
        one.time_s = epoch.time_s;
        one.jerk_factor = epoch.jerk_factor;
        if (!epoch.measurement) continue;
        one.measurement.emplace();
        one.measurement->position(0) = direction.dot(epoch.measurement->position);
        one.measurement->covariance(0, 0) =
            direction.dot(epoch.measurement->covariance * direction);
    }
    std::vector<EstimationModel> models;
    std::vector<double> factors;
    for (int i = 0; i < sizes; ++i) {
        factors.push_back(std::sqrt(1.0 + static_cast<double>(i) / (sizes - 1)));
        EstimationModel& one = models.emplace_back(model);
        one.error.process_density *= factors.back();
        one.error.initial_sigma_m *= factors.back();
    }
    const std::span<const ArcEpoch<1>> arc(along);
    const auto sums = innovation_sums_of<1>({&arc, 1}, models);
    const auto best = std::ranges::max_element(
        sums, {}, [](const InnovationSums& one) { return one.log_likelihood(); });
    return factors[static_cast<std::size_t>(best - sums.begin())];
}

namespace {

/// The speed after smoothing again with a stiffer or softer model of the motion.
template <int Axes>
double speed_with(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                  std::span<const ArcEpoch<Axes>> epochs, double density_factor) {
    EstimationModel model = at.model;
    model.motion.jerk_density *= density_factor;
    return speed_of(smoothed_track(Chain<Axes>(epochs, model)), at.window, at.duration_s, quantity);
}

/// Whether the window begins and ends at measured epochs.
template <int Axes>
bool has_chord(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity) {
    const auto [first, last] = at.window;
    return quantity.definition == SpeedDefinition::displacement && at.epochs[first].measurement &&
           at.epochs[last].measurement;
}

}  // namespace

template <int Axes>
OtherEstimates other_estimates(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                               const SpeedWeights<Axes>& weights, const PositionSpeed& measured) {
    constexpr double factor = 3.1622776601683795;  // sqrt(10)
    constexpr double coverage = 2.0;
    std::vector<ArcEpoch<Axes>> of_whole(at.epochs.begin(), at.epochs.end());
    for (ArcEpoch<Axes>& epoch : of_whole)
        epoch.jerk_factor = 1.0;
    OtherEstimates other{.stiffer_m_s = speed_with(at, quantity, at.epochs, 1.0 / factor),
                         .softer_m_s = speed_with(at, quantity, at.epochs, factor),
                         .whole_m_s = speed_with<Axes>(at, quantity, of_whole, 1.0)};
    const double speed_m_s = measured.speed.speed_m_s;
    if (quantity.of_samples) {  // the speed depends on no model
        other.stiffer_m_s = other.softer_m_s = speed_m_s;
        return other;
    }
    other.half_width_m_s =
        std::max(std::abs(other.stiffer_m_s - speed_m_s), std::abs(other.softer_m_s - speed_m_s));
    if (!has_chord(at, quantity)) return other;
    SpeedQuantity of_samples = quantity;
    of_samples.of_samples = true;
    SpeedWeights<Axes> difference = speed_weights(at, of_samples);
    for (std::size_t k = 0; k < difference.size(); ++k)
        difference[k] -= weights[k];
    other.chord_m_s =
        speed_of(measured_track<Axes>(at.epochs), at.window, at.duration_s, of_samples);
    other.chord_difference_uncertainty_m_s =
        std::sqrt(weighted_variance<Axes>(at.epochs, at.model.measurement_scale, difference));
    other.half_width_m_s =
        std::max(other.half_width_m_s, std::abs(*other.chord_m_s - speed_m_s) -
                                           coverage * *other.chord_difference_uncertainty_m_s);
    return other;
}

template <int Axes>
FittedSpeed fitted_speed(const WindowStretch<Axes>& stretch,
                         const std::vector<WeightedModel>& models, const SpeedQuantity& quantity) {
    double weight = 0.0;
    double mean = 0.0;
    double square = 0.0;  // of the deviation from the first model's speed
    double first = 0.0;
    for (std::size_t i = 0; i < models.size(); ++i) {
        const SpeedEstimate one = smoothed_speed(Chain<Axes>(stretch.epochs, models[i].model),
                                                 stretch.window, stretch.duration_s, quantity);
        if (i == 0) first = one.speed_m_s;
        const double deviation = one.speed_m_s - first;
        weight += models[i].weight;
        mean += models[i].weight * deviation;
        square += models[i].weight * (deviation * deviation +
                                      one.standard_uncertainty_m_s * one.standard_uncertainty_m_s);
    }
    mean /= weight;
    return {.speed_m_s = first + mean,
            .standard_uncertainty_m_s = std::sqrt(square / weight - mean * mean),
            .models = static_cast<std::int64_t>(models.size())};
}

template double position_r95_m<1>(const Chain<1>&, EpochPair, const ErrorBound&);
template double position_r95_m<2>(const Chain<2>&, EpochPair, const ErrorBound&);
#define RUNCERT_INSTANTIATE(AXES)                                                                  \
    template ErrorBound error_bound<AXES>(const ScreenedTable&, std::size_t, std::size_t,          \
                                          const NoiseSummary&, const UncertaintyRule&, double,     \
                                          const std::vector<Stand>&);                              \
    template OtherEstimates other_estimates<AXES>(const EstimatedWindow<AXES>&,                    \
                                                  const SpeedQuantity&, const SpeedWeights<AXES>&, \
                                                  const PositionSpeed&);                           \
    template SpeedWeights<AXES> speed_weights<AXES>(const EstimatedWindow<AXES>&,                  \
                                                    const SpeedQuantity&);                         \
    template PositionSpeed speed_by_positions<AXES>(const EstimatedWindow<AXES>&,                  \
                                                    const SpeedQuantity&,                          \
                                                    const SpeedWeights<AXES>&, const ErrorBound&); \
    template double largest_correlated_variance<AXES>(                                             \
        std::span<const ArcEpoch<AXES>>, const SpeedWeights<AXES>&, const ErrorBound&);            \
    template FittedSpeed fitted_speed<AXES>(                                                       \
        const WindowStretch<AXES>&, const std::vector<WeightedModel>&, const SpeedQuantity&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
