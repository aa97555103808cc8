#include "stages/window/velocity_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/statistics.h"
#include "stages/window/lasting_difference.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

constexpr double ten_s = 10.0;
constexpr std::size_t fewest_steps = 30;
constexpr std::size_t fewest_spans = 5;
constexpr double rounding_s = 1e-6;

/// The mean recorded speed of a span, and how much lower the smoothed path makes it.
struct SpanOfSpeeds {
    double mean_m_s = 0.0;
    double difference_m_s = 0.0;
    bool straight = false;

    double smoothed_m_s() const { return mean_m_s - difference_m_s; }
};

std::vector<SpanOfSpeeds> spans_of(std::span<const ComparedSpeed> compared, double span_s) {
    constexpr double longest = 1.2;
    constexpr double straight = 0.95;
    std::vector<SpanOfSpeeds> spans;
    for (std::size_t from = 0, to = 0; from < compared.size(); ++from) {
        const ComparedSpeed& a = compared[from];
        to = std::max(to, from + 1);
        while (to < compared.size() && compared[to].stretch == a.stretch &&
               compared[to].time_s < a.time_s + span_s - rounding_s)
            ++to;
        if (to == compared.size()) break;
        const ComparedSpeed& b = compared[to];
        const double length_s = b.time_s - a.time_s;
        if (b.stretch != a.stretch || length_s > longest * span_s) continue;
        const double recorded_m = b.recorded_m - a.recorded_m;
        const double smoothed_m = b.smoothed_m - a.smoothed_m;
        spans.push_back(
            {.mean_m_s = recorded_m / length_s,
             .difference_m_s = (recorded_m - smoothed_m) / length_s,
             .straight = (b.track.position - a.track.position).norm() >= straight * smoothed_m});
        from = to - 1;
    }
    return spans;
}

/// The spans of a length in which the craft is fast and goes straight; all fast ones where too few
/// are straight. None where these are too few.
std::vector<SpanOfSpeeds> fast_spans(std::span<const ComparedSpeed> compared, double span_s) {
    std::vector<SpanOfSpeeds> spans = spans_of(compared, span_s);
    if (spans.size() < fewest_spans) return {};
    const auto tenth = spans.begin() + std::ssize(spans) * 9 / 10;
    std::ranges::nth_element(spans, tenth, {}, &SpanOfSpeeds::mean_m_s);
    const double least_m_s = 0.5 * tenth->mean_m_s;
    std::erase_if(spans, [&](const SpanOfSpeeds& one) { return one.mean_m_s < least_m_s; });
    const auto straight = std::ranges::count_if(spans, &SpanOfSpeeds::straight);
    if (straight >= std::ptrdiff_t{fewest_spans})
        std::erase_if(spans, [](const SpanOfSpeeds& one) { return !one.straight; });
    if (spans.size() < fewest_spans) return {};
    return spans;
}

/// Whether recorded speeds and positions part by less than positions wander on their own.
bool part_too_little(std::span<const ComparedSpeed> compared, double position_sigma_m) {
    constexpr double least_share = 0.25;
    double most_m = 0.0;
    for (const double span_s : {10.0, 30.0, 100.0}) {
        std::vector<double> parted_m;
        for (const SpanOfSpeeds& one : spans_of(compared, span_s))
            parted_m.push_back(one.difference_m_s * span_s);
        if (parted_m.size() >= fewest_spans) most_m = std::max(most_m, root_mean_square(parted_m));
    }
    return most_m > 0.0 && most_m < least_share * std::numbers::sqrt2 * position_sigma_m;
}

/// The median stated standard deviation (m, each axis) of the usable positions. 0 if there are
/// none.
double position_sigma_m(const ScreenedTable& screened, Dimension dimension) {
    std::vector<double> sigmas;
    const auto add = [&](const auto& positions) {
        for (const auto& one : positions)
            sigmas.push_back(one.sigma_m);
    };
    if (dimension == Dimension::vertical)
        add(timed_positions<1>(screened.rows));
    else
        add(timed_positions<2>(screened.rows));
    return sigmas.empty() ? 0.0 : median(std::move(sigmas));
}

double square(double value) {
    return value * value;
}

/// The remainder after removing a part from a whole, all as standard deviations.
double quadrature_difference(double whole, double part) {
    return std::sqrt(std::max(0.0, square(whole) - square(part)));
}

SpeedErrors as_stated(double stated_m_s, SpeedErrors errors) {
    errors.mean_white_m_s = std::min(errors.mean_white_m_s, stated_m_s);
    errors.slow_m_s = quadrature_difference(stated_m_s, errors.mean_white_m_s);
    errors.slow = SlowError::stated;
    return errors;
}

}  // namespace

std::optional<SpeedSpread> white_noise(std::span<const ComparedSpeed> compared, double from_s,
                                       double to_s) {
    constexpr double around_s = 30.0;
    constexpr double efficiency_of_median = 0.37;
    constexpr double ever = std::numeric_limits<double>::infinity();
    std::vector<double> steps, third;
    const auto gather = [&](double first_s, double last_s) {
        steps.clear();
        third.clear();
        for (std::size_t k = 1; k < compared.size(); ++k) {
            const ComparedSpeed &a = compared[k - 1], &b = compared[k];
            if (a.stretch != b.stretch || a.time_s < first_s || b.time_s > last_s) continue;
            steps.push_back(
                std::abs(b.recorded_m_s - b.smoothed_m_s - a.recorded_m_s + a.smoothed_m_s));
            if (k < 3 || compared[k - 3].stretch != b.stretch || compared[k - 3].time_s < first_s)
                continue;
            third.push_back(std::abs(b.recorded_m_s - compared[k - 3].recorded_m_s -
                                     3.0 * (a.recorded_m_s - compared[k - 2].recorded_m_s)));
        }
        return third.size() >= fewest_steps;
    };
    if (!gather(from_s - around_s, to_s + around_s) && !gather(-ever, ever)) return std::nullopt;
    const double independent = efficiency_of_median * static_cast<double>(third.size());
    return SpeedSpread{
        .sd_m_s = std::min(robust_sd(std::move(steps), 2.0), robust_sd(std::move(third), 20.0)),
        .independent = independent};
}

std::optional<SpeedScale> speed_scale(std::span<const ComparedSpeed> compared) {
    constexpr double spans_alike = 3.0;
    const std::vector<SpanOfSpeeds> spans = fast_spans(compared, ten_s);
    double products = 0.0, squares = 0.0, residuals = 0.0;
    for (const SpanOfSpeeds& one : spans) {
        products += one.difference_m_s * one.smoothed_m_s();
        squares += square(one.smoothed_m_s());
    }
    if (!(squares > 0.0)) return std::nullopt;
    SpeedScale scale{.shown = products / squares};
    for (const SpanOfSpeeds& one : spans)
        residuals += square(one.difference_m_s - scale.shown * one.smoothed_m_s());
    const double scatter =
        std::max(residuals / static_cast<double>(spans.size() - 1), square(least_slow_error_m_s));
    const double variance = spans_alike * scatter / squares;
    double weights = 0.0, values = 0.0, moments = 0.0;
    // Beside that of the wider prior, as both densities are 0 of a scale that is far off.
    const double widest = square(scale_priors[1].sigma) + variance;
    for (const auto& [probability, sigma] : scale_priors) {
        const double of_both = square(sigma) + variance;
        const double weight =
            probability * std::exp(-0.5 * square(scale.shown) * (1.0 / of_both - 1.0 / widest)) /
            std::sqrt(of_both);
        const double gain = square(sigma) / of_both;
        weights += weight;
        values += weight * gain * scale.shown;
        moments += weight * (gain * variance + square(gain * scale.shown));
    }
    scale.shown_uncertainty = std::sqrt(variance);
    scale.value = values / weights;
    scale.uncertainty = quadrature_difference(std::sqrt(moments / weights), scale.value);
    return scale;
}

std::optional<SpeedSpread> span_spread(std::span<const ComparedSpeed> compared, double span_s,
                                       double scale) {
    std::vector<double> differences;
    for (const SpanOfSpeeds& one : fast_spans(compared, span_s))
        differences.push_back(one.difference_m_s - scale * one.mean_m_s);
    if (differences.empty()) return std::nullopt;
    return SpeedSpread{.sd_m_s = root_mean_square(differences),
                       .independent = static_cast<double>(differences.size())};
}

SpeedNoise speed_noise(std::span<const ComparedSpeed> compared, const ScreenedTable& screened,
                       Dimension dimension, double start_s, double duration_s, double samples) {
    SpeedNoise noise;
    noise.white = white_noise(compared, start_s, start_s + duration_s);
    noise.scale = speed_scale(compared);
    const double scale = noise.scale ? noise.scale->value : 0.0;
    noise.over_ten = span_spread(compared, ten_s, scale);
    if (duration_s < ten_s) noise.over_window = span_spread(compared, duration_s, scale);
    const double sigma_m = position_sigma_m(screened, dimension);
    noise.positions_m_s = 2.0 * std::numbers::sqrt2 * sigma_m / ten_s;
    const auto& velocity = screened.basis.velocity;
    noise.in_common = (velocity && velocity->origin == VelocityOrigin::positions) ||
                      part_too_little(compared, sigma_m);
    const auto& both = duration_s < ten_s ? noise.over_window : noise.over_ten;
    if (noise.white && both) {
        const double averaged = samples * std::min(1.0, ten_s / duration_s);
        const double chance =
            2.0 * std::sqrt(0.5 / both->independent + 0.5 / noise.white->independent);
        if (both->sd_m_s * (1.0 + chance) < noise.white->sd_m_s / std::sqrt(averaged))
            noise.in_common = true;
    }
    if (!noise.is_shown(duration_s)) noise.scale.reset();
    return noise;
}

bool SpeedNoise::is_shown(double duration_s) const {
    return !in_common && white && over_ten && (duration_s >= ten_s || over_window);
}

double SpeedErrors::combined() const {
    return std::hypot(mean_white_m_s, brief_m_s, slow_m_s);
}

SpeedErrors speed_errors(const SpeedNoise& noise, const StatedSpeedAccuracy& stated,
                         double duration_s, double samples) {
    SpeedErrors errors;
    if (noise.white) errors.white_m_s = noise.white->sd_m_s;
    const bool contradicted = stated.claimed && errors.white_m_s > stated.sigma_m_s;
    errors.mean_white_m_s = std::hypot(errors.white_m_s / (contradicted ? 1.0 : std::sqrt(samples)),
                                       stated.of_worse_m_s);
    const bool is_short = duration_s < ten_s;
    if (!noise.is_shown(duration_s))
        return as_stated(stated.claimed ? std::max({stated.sigma_m_s, stated.scatter_m_s,
                                                    least_slow_error_m_s, errors.mean_white_m_s})
                                        : stated.sigma_m_s,
                         errors);
    const double shown_m_s = noise.over_ten->sd_m_s;
    errors.slow = shown_m_s > least_slow_error_m_s ? SlowError::shown : SlowError::floor;
    errors.slow_m_s = std::max(least_slow_error_m_s, shown_m_s);
    if (is_short)
        errors.brief_m_s = quadrature_difference(
            quadrature_difference(noise.over_window->sd_m_s, shown_m_s), errors.mean_white_m_s);
    const double stated_m_s = quadrature_difference(stated.sigma_m_s, errors.mean_white_m_s);
    if (noise.positions_m_s >= stated.sigma_m_s && stated_m_s > errors.slow_m_s) {
        errors.slow_m_s = stated_m_s;
        errors.slow = SlowError::stated;
    }
    return errors;
}

}  // namespace runcert
