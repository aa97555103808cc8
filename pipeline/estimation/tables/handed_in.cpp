#include "estimation/tables/handed_in.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "estimation/same_origin.h"

namespace runcert {
namespace {

constexpr std::size_t fewest_epochs = 30;
constexpr double largest_delay_s = 1.0;
constexpr double delay_step_s = 0.02;
constexpr double longest_step_s = 2.5;

/// Of the plane.
double speed_of(const TrackEpoch& epoch) {
    return epoch.velocity_m_s.head<2>().norm();
}

/// Linearly between samples that are no more than 2.5 s apart.
std::optional<double> value_at(std::span<const TimedValue> samples, double time_s) {
    const auto after = std::ranges::lower_bound(samples, time_s, {}, &TimedValue::time_s);
    if (after == samples.end()) return std::nullopt;
    if (after->time_s == time_s) return after->value;
    if (after == samples.begin()) return std::nullopt;
    const TimedValue& before = *(after - 1);
    if (after->time_s - before.time_s > longest_step_s) return std::nullopt;
    const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
    return before.value + share * (after->value - before.value);
}

/// Between samples further apart than rows only the rows next to one are one filter of them.
bool is_near_a_sample(std::span<const TimedValue> samples, double time_s, double near_s) {
    const auto after = std::ranges::lower_bound(samples, time_s - near_s, {}, &TimedValue::time_s);
    return after != samples.end() && after->time_s <= time_s + near_s;
}

/// How the wheel fits the smoothed speeds at one delay.
struct WheelFit {
    double scale = 1.0;
    double squares = 0.0;  ///< sum of squared residuals, m^2/s^2
    std::size_t epochs = 0;

    double mean_square() const {
        return epochs > 0 ? squares / static_cast<double>(epochs)
                          : std::numeric_limits<double>::infinity();
    }
};

WheelFit fit_at(std::span<const TimedValue> wheel, const Track& track, double delay_s) {
    double cross = 0.0, square = 0.0, smoothed = 0.0;
    WheelFit fit;
    for (const TrackEpoch& epoch : track.epochs) {
        const auto speed = value_at(wheel, epoch.time_s + delay_s);
        if (!speed) continue;
        const double of_track = speed_of(epoch);
        cross += *speed * of_track;
        square += *speed * *speed;
        smoothed += of_track * of_track;
        ++fit.epochs;
    }
    if (!(square > 0.0)) return {};
    fit.scale = cross / square;
    fit.squares = std::max(0.0, smoothed - fit.scale * cross);
    return fit;
}

struct WheelDelay {
    double delay_s = 0.0;
    double sigma_s = 0.0;
};

/// The delay of the best fit. Where the speed hardly changes, or the best lies at the end of the
/// range, it is not known: then it is none, with the uncertainty of the range.
WheelDelay delay_of(std::span<const TimedValue> wheel, const Track& track) {
    const auto steps = static_cast<int>(std::lround(largest_delay_s / delay_step_s));
    std::vector<WheelFit> fits;
    for (int k = -steps; k <= steps; ++k)
        fits.push_back(fit_at(wheel, track, k * delay_step_s));
    const auto best = std::ranges::min_element(fits, {}, &WheelFit::mean_square);
    const WheelDelay unknown_delay{.delay_s = 0.0,
                                   .sigma_s = rectangular_uncertainty(largest_delay_s)};
    if (best == fits.begin() || best + 1 == fits.end()) return unknown_delay;
    const double left = (best - 1)->mean_square(), middle = best->mean_square(),
                 right = (best + 1)->mean_square();
    const double curvature = (left - 2.0 * middle + right) / (delay_step_s * delay_step_s);
    if (!(curvature > 0.0)) return unknown_delay;
    const double shift_s = 0.5 * delay_step_s * (left - right) / (left - 2.0 * middle + right);
    // Errors that last for a second: as many count as seconds.
    const double seconds =
        std::max(1.0, static_cast<double>(best->epochs) * track.nominal_interval_s);
    WheelDelay delay;
    delay.delay_s = (static_cast<double>(best - fits.begin()) - steps) * delay_step_s + shift_s;
    delay.sigma_s = std::sqrt(2.0 * middle / (curvature * seconds));
    return delay.sigma_s < unknown_delay.sigma_s ? delay : unknown_delay;
}

/// Both paths over a span of 3 s or more while the craft moves fast.
struct FastSpan {
    TimeSpan span;
    Eigen::Vector2d velocities = Eigen::Vector2d::Zero();  ///< sum
    double smoothed = 0.0;
    double wheeled = 0.0;

    double ratio() const { return smoothed / wheeled; }
};

std::vector<FastSpan> fast_spans(std::span<const TimedValue> wheel, const Track& track,
                                 double delay_s, double scale) {
    constexpr double span_s = 3.0;
    double fastest = 0.0;
    for (const TrackEpoch& epoch : track.epochs)
        fastest = std::max(fastest, speed_of(epoch));
    std::vector<FastSpan> spans;
    FastSpan open;
    bool is_open = false;
    for (const TrackEpoch& epoch : track.epochs) {
        const auto speed = value_at(wheel, epoch.time_s + delay_s);
        if (!speed || speed_of(epoch) < 0.5 * fastest) {
            is_open = false;
            continue;
        }
        if (!is_open) open = {.span = {.first_s = epoch.time_s}};
        is_open = true;
        open.span.last_s = epoch.time_s;
        open.velocities += epoch.velocity_m_s.head<2>();
        open.smoothed += speed_of(epoch);
        open.wheeled += scale * *speed;
        if (epoch.time_s - open.span.first_s < span_s || !(open.wheeled > 0.0)) continue;
        spans.push_back(open);
        is_open = false;
    }
    return spans;
}

std::vector<WheelRun> runs_of(const std::vector<FastSpan>& spans) {
    std::vector<WheelRun> runs;
    FastSpan sum;
    for (const FastSpan& one : spans) {
        if (runs.empty() || one.span.first_s - sum.span.last_s >= between_runs_s) {
            sum = {.span = one.span};
            runs.emplace_back();
        }
        sum.span.last_s = one.span.last_s;
        sum.velocities += one.velocities;
        sum.smoothed += one.smoothed;
        sum.wheeled += one.wheeled;
        runs.back() = {.span = sum.span, .direction = sum.velocities, .scale = sum.ratio()};
    }
    return runs;
}

/// Samples with the scale that fits the run that each is nearest to: what a run's positions drift
/// in proportion to the speed is no error of the wheel's.
std::vector<TimedVelocity<2>> as_fitted(std::vector<TimedVelocity<2>> samples,
                                        const std::vector<WheelRun>& runs) {
    const auto beside_s = [](const WheelRun& run, double time_s) {
        return std::max({0.0, run.span.first_s - time_s, time_s - run.span.last_s});
    };
    if (runs.empty()) return samples;
    for (TimedVelocity<2>& one : samples)
        one.velocity *= std::ranges::min_element(runs, {}, [&](const WheelRun& run) {
                            return beside_s(run, one.time_s);
                        })->scale;
    return samples;
}

/// Standard uncertainty of the scale that fits all: of the ratios of both paths, as many as do not
/// overlap.
double sigma_of_scale(const std::vector<FastSpan>& spans) {
    constexpr double least = 1e-4;
    if (spans.size() < 3) return 0.01;
    std::vector<double> ratios;
    for (const FastSpan& one : spans)
        ratios.push_back(one.ratio());
    const double middle = median(ratios);
    for (double& ratio : ratios)
        ratio = std::abs(ratio - middle);
    const auto count = static_cast<double>(ratios.size());
    const double sd = median(std::move(ratios)) / normal_quantile(0.75);
    return std::max(least, 1.2533 * sd / std::sqrt(count));
}

/// The epoch of the track nearest to a time; null where none is near.
const TrackEpoch* epoch_near(const Track& track, double time_s) {
    const double nearest_s = 0.6 * std::max(track.nominal_interval_s, 1e-3);
    const auto after = std::ranges::lower_bound(track.epochs, time_s, {}, &TrackEpoch::time_s);
    const TrackEpoch* best = after == track.epochs.end() ? nullptr : &*after;
    if (after != track.epochs.begin() &&
        (best == nullptr || time_s - (after - 1)->time_s < best->time_s - time_s))
        best = &*(after - 1);
    return best != nullptr && std::abs(best->time_s - time_s) <= nearest_s ? best : nullptr;
}

std::vector<velocities::SpeedBesidePosition> rows_of(std::span<const TimedPosition<2>> positions) {
    std::vector<velocities::SpeedBesidePosition> rows;
    for (const TimedPosition<2>& one : positions)
        rows.push_back({.time_s = one.time_s, .position_m = one.position});
    return rows;
}

}  // namespace

bool are_from_positions(std::span<const TimedValue> speeds,
                        std::span<const TimedPosition<2>> positions, double delay_s, double scale) {
    std::vector<velocities::SpeedBesidePosition> rows = rows_of(positions);
    for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
        const double time_s = rows[k].time_s + delay_s;
        if (!is_near_a_sample(speeds, time_s, 0.501 * (rows[k + 1].time_s - rows[k].time_s)))
            continue;
        if (const auto speed = value_at(speeds, time_s)) rows[k].speed_m_s = scale * *speed;
    }
    return are_filtered_positions(rows) ||
           velocities::origin_of_speeds(rows, 0.0).origin == velocities::Origin::positions;
}

std::optional<WheelWitness> wheel_witness(const WheelSpeeds& speeds,
                                          std::span<const TimedPosition<2>> positions,
                                          const Track& track, double jerk_density) {
    const std::span<const TimedValue> wheel = speeds.m_s;
    const WheelDelay delay = delay_of(wheel, track);
    const WheelFit fit = fit_at(wheel, track, delay.delay_s);
    if (fit.epochs < fewest_epochs || !(fit.scale > 0.0)) return std::nullopt;
    const double scale = speeds.calibrated_scale.value_or(fit.scale);
    const std::vector<FastSpan> spans = fast_spans(wheel, track, delay.delay_s, scale);
    std::vector<TimedVelocity<2>> samples;
    for (const TimedValue& one : wheel) {
        const TrackEpoch* const at = epoch_near(track, one.time_s - delay.delay_s);
        if (at == nullptr) continue;
        const Eigen::Vector2d velocity = at->velocity_m_s.head<2>();
        if (!(velocity.norm() > 0.0)) continue;
        const std::int64_t stretch =
            samples.empty() ? 0
                            : samples.back().stretch +
                                  (one.time_s - samples.back().time_s > longest_step_s ? 1 : 0);
        samples.push_back({.time_s = one.time_s,
                           .velocity = scale * one.value * velocity.normalized(),
                           .stretch = stretch});
    }
    if (samples.size() < fewest_epochs) return std::nullopt;
    VelocityErrorModel delay_alone;
    delay_alone.delay_s = delay.delay_s;
    delay_alone.sigma_delay_s = delay.sigma_s;
    delay_alone.density = 0.0;
    std::vector<WheelRun> runs = runs_of(spans);
    const VelocityWitness<2> undisturbed(as_fitted(samples, runs), delay_alone, jerk_density);
    const auto estimated = estimate_velocity_errors<2>(undisturbed, positions, std::nullopt);
    if (!estimated.model.is_known()) return std::nullopt;
    const bool made = keep_to_positions(estimated.spreads, false) ||
                      are_from_positions(wheel, positions, delay.delay_s, fit.scale);
    const bool calibrated = speeds.calibrated_scale.has_value();
    const double sigma_scale = sigma_of_scale(spans);
    return WheelWitness{
        .motion = WheelMotion(VelocityWitness<2>(std::move(samples), estimated.model, jerk_density),
                              std::move(runs), calibrated ? speeds.sigma_calibrated : sigma_scale,
                              calibrated),
        .scale = fit.scale,
        .sigma_scale = sigma_scale,
        .delay_s = delay.delay_s,
        .sigma_delay_s = delay.sigma_s,
        .made_from_positions = made};
}

bool are_between_positions(std::span<const TimedValue> passages,
                           std::span<const TimedPosition<2>> positions) {
    const double noise_m = velocities::white_noise_m(rows_of(positions));
    if (!(noise_m > 0.0)) return false;
    const auto position_at = [&](double time_s) -> std::optional<Eigen::Vector2d> {
        const auto after =
            std::ranges::lower_bound(positions, time_s, {}, &TimedPosition<2>::time_s);
        if (after == positions.end()) return std::nullopt;
        if (after->time_s == time_s) return after->position;
        if (after == positions.begin()) return std::nullopt;
        const TimedPosition<2>& before = *(after - 1);
        const double part = (time_s - before.time_s) / (after->time_s - before.time_s);
        return before.position + part * (after->position - before.position);
    };
    std::vector<double> differences;
    for (std::size_t i = 1; i < passages.size(); ++i) {
        const auto from = position_at(passages[i - 1].time_s), to = position_at(passages[i].time_s);
        if (from && to)
            differences.push_back(
                (passages[i].value - passages[i - 1].value - (*to - *from).norm()) /
                (std::numbers::sqrt2 * noise_m));
    }
    return agree_too_well(differences);
}

std::optional<GateWitness> gate_witness(std::span<const TimedValue> passages,
                                        const GateErrors& errors, const Track& track) {
    std::vector<GatePassage> passed;
    for (const TimedValue& one : passages) {
        const TrackEpoch* const at = epoch_near(track, one.time_s);
        if (at == nullptr) continue;
        const double since_s = one.time_s - at->time_s;
        const Eigen::Vector2d acceleration = at->acceleration_m_s2.head<2>();
        const Eigen::Vector2d velocity = at->velocity_m_s.head<2>() + since_s * acceleration;
        const double speed_m_s = velocity.norm();
        passed.push_back(
            {.time_s = one.time_s,
             .distance_m = one.value,
             .position_m = at->position_m.head<2>() + since_s * at->velocity_m_s.head<2>(),
             .speed_m_s = speed_m_s,
             .acceleration_m_s2 = speed_m_s > 0.0 ? acceleration.dot(velocity) / speed_m_s : 0.0});
    }
    if (passed.size() < 2) return std::nullopt;
    return GateWitness(std::move(passed), errors);
}

}  // namespace runcert
