#include "stages/window/velocity_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "stages/window/sample_series.h"
#include "stages/window/velocity_moment.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

constexpr double ten_s = 10.0;
constexpr std::size_t fewest_steps = 30;
constexpr std::size_t fewest_spans = 5;
constexpr double rounding_s = 1e-6;

/// Absolute differences of the samples between two times: steps of recorded minus smoothed speed,
/// and third differences of recorded speeds.
struct SpeedDifferences {
    std::vector<double> from_smoothed, third;
};

SpeedDifferences differences_between(std::span<const ComparedSpeed> compared, double from_s,
                                     double to_s) {
    SpeedDifferences differences;
    for (std::size_t k = 1; k < compared.size(); ++k) {
        const ComparedSpeed &a = compared[k - 1], &b = compared[k];
        if (a.stretch != b.stretch || a.time_s < from_s || b.time_s > to_s) continue;
        differences.from_smoothed.push_back(
            std::abs(b.recorded_m_s - b.smoothed_m_s - a.recorded_m_s + a.smoothed_m_s));
        if (k < 3 || compared[k - 3].stretch != b.stretch || compared[k - 3].time_s < from_s)
            continue;
        differences.third.push_back(
            std::abs(b.recorded_m_s - compared[k - 3].recorded_m_s -
                     3.0 * (a.recorded_m_s - compared[k - 2].recorded_m_s)));
    }
    return differences;
}

/// The mean recorded speed of a span, and how much lower the smoothed path makes it.
struct SpanOfSpeeds {
    double mean_m_s = 0.0;
    double difference_m_s = 0.0;
};

std::vector<SpanOfSpeeds> spans_of(std::span<const ComparedSpeed> compared, double span_s) {
    constexpr double longest = 1.2;
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
        spans.push_back(
            {.mean_m_s = (b.recorded_m - a.recorded_m) / length_s,
             .difference_m_s =
                 (b.recorded_m - a.recorded_m - b.smoothed_m + a.smoothed_m) / length_s});
        from = to - 1;
    }
    return spans;
}

double square(double value) {
    return value * value;
}

/// The remainder after removing a part from a whole, all as standard deviations.
double rest_of(double whole, double part) {
    return std::sqrt(std::max(0.0, square(whole) - square(part)));
}

SpeedErrors as_stated(double stated_m_s, SpeedErrors errors) {
    errors.mean_white_m_s = std::min(errors.mean_white_m_s, stated_m_s);
    errors.slow_m_s = rest_of(stated_m_s, errors.mean_white_m_s);
    errors.slow_between_m_s = std::min(errors.slow_m_s, least_slow_error_m_s);
    errors.slow = SlowError::stated;
    return errors;
}

}  // namespace

double robust_sd(std::vector<double> absolute, double gain) {
    return median(std::move(absolute)) / (normal_quantile(0.75) * std::sqrt(gain));
}

std::vector<ComparedSpeed> compared_speeds(const ScreenedTable& screened,
                                           const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs, Dimension dimension) {
    const std::vector<bool> others =
        velocities_of_other_moments(screened.rows, screened.basis.velocity);
    const double longest_s = std::max(1.0, 1.5 * trajectory.facts.nominal_interval_s) + rounding_s;
    std::vector<ComparedSpeed> compared;
    std::int64_t stretch = 0;
    for (const ArcRows& arc : arcs) {
        ++stretch;
        const auto moments = track_at_moments(screened, trajectory, arc, dimension);
        for (std::size_t k = 0; k < arc.rows.size(); ++k) {
            const TrajectoryEpoch& row = trajectory.rows[arc.rows[k]];
            const auto recorded = recorded_speed(screened.rows[arc.rows[k]], dimension);
            if (!recorded || !moments[k] || !row.usable || others[arc.rows[k]]) {
                ++stretch;
                continue;
            }
            ComparedSpeed one{.time_s = row.time.seconds(),
                              .recorded_m_s = recorded->speed_m_s,
                              .smoothed_m_s = moments[k]->speed_m_s};
            if (!compared.empty()) {
                const ComparedSpeed& before = compared.back();
                const double step_s = one.time_s - before.time_s;
                if (begins_after_step(row) || step_s > longest_s) ++stretch;
                one.recorded_m =
                    before.recorded_m + 0.5 * step_s * (before.recorded_m_s + one.recorded_m_s);
                one.smoothed_m = before.smoothed_m + moments[k]->step_m;
            }
            one.stretch = stretch;
            compared.push_back(one);
        }
    }
    return compared;
}

std::optional<SpeedSpread> white_noise(std::span<const ComparedSpeed> compared, double from_s,
                                       double to_s) {
    constexpr double around_s = 30.0;
    constexpr double efficiency_of_median = 0.37;
    constexpr double ever = std::numeric_limits<double>::infinity();
    SpeedDifferences differences =
        differences_between(compared, from_s - around_s, to_s + around_s);
    if (differences.third.size() < fewest_steps)
        differences = differences_between(compared, -ever, ever);
    if (differences.third.size() < fewest_steps) return std::nullopt;
    const double independent = efficiency_of_median * static_cast<double>(differences.third.size());
    return SpeedSpread{.sd_m_s = std::min(robust_sd(std::move(differences.from_smoothed), 2.0),
                                          robust_sd(std::move(differences.third), 20.0)),
                       .independent = independent};
}

std::optional<SpeedSpread> span_spread(std::span<const ComparedSpeed> compared, double span_s) {
    std::vector<SpanOfSpeeds> spans = spans_of(compared, span_s);
    if (spans.size() < fewest_spans) return std::nullopt;
    const auto tenth = spans.begin() + std::ssize(spans) * 9 / 10;
    std::ranges::nth_element(spans, tenth, {}, &SpanOfSpeeds::mean_m_s);
    const double least_m_s = 0.5 * tenth->mean_m_s;
    std::vector<double> differences;
    for (const SpanOfSpeeds& one : spans)
        if (one.mean_m_s >= least_m_s) differences.push_back(one.difference_m_s);
    if (differences.size() < fewest_spans) return std::nullopt;
    return SpeedSpread{.sd_m_s = root_mean_square(differences),
                       .independent = static_cast<double>(differences.size())};
}

SpeedNoise speed_noise(std::span<const ComparedSpeed> compared, const ScreenedTable& screened,
                       double start_s, double duration_s, double samples) {
    SpeedNoise noise;
    noise.white = white_noise(compared, start_s, start_s + duration_s);
    noise.over_ten = span_spread(compared, ten_s);
    if (duration_s < ten_s) noise.over_window = span_spread(compared, duration_s);
    const auto& velocity = screened.basis.velocity;
    noise.in_common = velocity && velocity->origin == VelocityOrigin::positions;
    const auto& both = duration_s < ten_s ? noise.over_window : noise.over_ten;
    if (noise.white && both) {
        const double averaged = samples * std::min(1.0, ten_s / duration_s);
        const double chance =
            2.0 * std::sqrt(0.5 / both->independent + 0.5 / noise.white->independent);
        if (both->sd_m_s * (1.0 + chance) < noise.white->sd_m_s / std::sqrt(averaged))
            noise.in_common = true;
    }
    return noise;
}

double SpeedErrors::combined() const {
    return std::hypot(mean_white_m_s, brief_m_s, slow_m_s);
}

SpeedErrors speed_errors(const SpeedNoise& noise, const StatedSpeedAccuracy& stated,
                         double duration_s, double samples) {
    SpeedErrors errors;
    if (noise.white) errors.white_m_s = noise.white->sd_m_s;
    const bool contradicted = stated.claimed && errors.white_m_s > stated.sigma_m_s;
    errors.mean_white_m_s = errors.white_m_s / (contradicted ? 1.0 : std::sqrt(samples));
    const bool is_short = duration_s < ten_s;
    if (noise.in_common || !noise.white || !noise.over_ten || (is_short && !noise.over_window))
        return as_stated(stated.claimed ? std::max({stated.sigma_m_s, stated.scatter_m_s,
                                                    least_slow_error_m_s, errors.mean_white_m_s})
                                        : stated.sigma_m_s,
                         errors);
    const double shown_m_s = noise.over_ten->sd_m_s;
    errors.slow = shown_m_s > least_slow_error_m_s ? SlowError::shown : SlowError::floor;
    errors.slow_m_s = std::max(least_slow_error_m_s, shown_m_s);
    if (is_short)
        errors.brief_m_s =
            rest_of(rest_of(noise.over_window->sd_m_s, shown_m_s), errors.mean_white_m_s);
    const double at_most_m_s = rest_of(stated.sigma_m_s, errors.mean_white_m_s);
    if (!stated.claimed && errors.slow_m_s > at_most_m_s) {
        errors.slow_m_s = at_most_m_s;
        errors.slow = SlowError::stated;
    }
    if (!stated.claimed)
        errors.brief_m_s = std::min(errors.brief_m_s, rest_of(at_most_m_s, errors.slow_m_s));
    errors.slow_between_m_s = errors.slow_m_s;
    return errors;
}

}  // namespace runcert
