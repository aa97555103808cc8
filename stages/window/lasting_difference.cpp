#include "stages/window/lasting_difference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "core/statistics.h"
#include "witness/arcs.h"
#include "witness/velocity_witness.h"

namespace runcert {
namespace {

/// A row's recorded velocity towards east, or upwards. A speed alone is taken as it is.
OptionalReal recorded_along(const ScreenedEpoch& row, TestedAxes axes) {
    if (axes == TestedAxes::vertical) return row.recorded_velocity_up_m_s;
    return row.recorded_velocity_east_m_s ? row.recorded_velocity_east_m_s : row.recorded_speed_m_s;
}

/// The variance of the difference of displacements that is explained: by twice the positions'
/// stated errors at both ends, and by the white noise of the velocities from their third
/// differences, doubled because a short recording has few spans that do not overlap.
struct Explained {
    double positions_m2 = 0.0, white_m2_s = 0.0;

    Explained(const ScreenedTable& screened, TestedAxes axes) {
        const auto& rows = screened.rows;
        std::vector<double> sigmas, third;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto& sigma =
                axes == TestedAxes::vertical ? rows[i].sigma_up_m : rows[i].sigma_east_m;
            if (rows[i].usable && sigma) sigmas.push_back(*sigma);
            if (i < 3) continue;
            const auto a = recorded_along(rows[i - 3], axes), b = recorded_along(rows[i - 2], axes),
                       c = recorded_along(rows[i - 1], axes), d = recorded_along(rows[i], axes);
            if (a && b && c && d) third.push_back(std::abs(*d - 3.0 * *c + 3.0 * *b - *a));
        }
        if (!sigmas.empty()) positions_m2 = 2.0 * std::pow(2.0 * median(std::move(sigmas)), 2);
        constexpr double gain = 20.0;  // of the variance: 1 + 9 + 9 + 1
        if (!third.empty())
            white_m2_s = 2.0 * std::pow(robust_sd(std::move(third), gain), 2) *
                         screened.facts.nominal_interval_s;
    }
    double over_m2(double span_s) const { return positions_m2 + white_m2_s * span_s; }
};

/// Lasting error that the recordings of good receivers show, whatever they state, or what these
/// state.
double known_of_velocities_m_s(const VelocityErrors& errors) {
    const double of_good_m_s = errors.axes == TestedAxes::vertical ? 0.1 : 0.07;
    return std::max(of_good_m_s, errors.stated_m_s.value_or(0.0));
}

/// Sums over spans of products of the differences d, the speeds v, and a drift's shape x.
struct Products {
    double dd = 0.0, dv = 0.0, vv = 0.0, dx = 0.0, vx = 0.0, xx = 0.0;
};

template <class Shape>
Products products_of(std::span<const SpanComparison> spans, const Shape& shape) {
    Products sums;
    for (const SpanComparison& one : spans) {
        const double d = one.along_m_s, v = one.speed_m_s, x = shape(one);
        sums.dd += d * d, sums.dv += d * v, sums.vv += v * v;
        sums.dx += d * x, sums.vx += v * x, sums.xx += x * x;
    }
    return sums;
}

/// Logarithm of the likelihood of the differences with a scale of this prior, for independent noise
/// of this variance. Where `drift_from_m_s` is given, a drift of any size from this on, either way,
/// is added: smaller ones are among the errors of good velocities.
double log_likelihood(const Products& of, const ScalePrior& prior, double variance,
                      std::optional<double> drift_from_m_s = {}) {
    const double of_scale = prior.sigma * prior.sigma;
    const double removed = of_scale / (variance + of_scale * of.vv);
    const double log = std::log(prior.weight) - 0.5 * std::log(1.0 + of_scale * of.vv / variance) -
                       0.5 * (of.dd - removed * of.dv * of.dv) / variance;
    if (!drift_from_m_s) return log;
    const double dx = (of.dx - removed * of.dv * of.vx) / variance;
    const double xx = (of.xx - removed * of.vx * of.vx) / variance;
    const double size_m_s = dx / xx, sigma_m_s = 1.0 / std::sqrt(xx);
    const double is_larger = normal_cdf((size_m_s - *drift_from_m_s) / sigma_m_s) +
                             normal_cdf((-size_m_s - *drift_from_m_s) / sigma_m_s);
    return log + 0.5 * dx * dx / xx + 0.5 * std::log(2.0 * std::numbers::pi / xx) +
           std::log(is_larger);
}

/// The scale and the drift that fit best, and the sum of squares that they leave. No drift where it
/// does not differ from a scale in these spans.
struct BestFit {
    double scale = 0.0, drift_m_s = 0.0, left = 0.0;

    explicit BestFit(const Products& of) {
        const double dx = of.dx - of.dv * of.vx / of.vv, xx = of.xx - of.vx * of.vx / of.vv;
        if (xx > 1e-9 * of.xx) drift_m_s = dx / xx;
        scale = (of.dv - drift_m_s * of.vx) / of.vv;
        left = of.dd - of.dv * of.dv / of.vv - drift_m_s * dx;
    }
};

/// A drift above a fraction of the top speed, or proportional to the speed.
struct Drift {
    std::optional<double> above = {};

    /// Its part of a span's difference, from the time that the craft was so fast.
    double shape(const SpanComparison& span, double top_m_s) const {
        if (!above) return span.speed_m_s / top_m_s;
        const double over_m_s = span.speed_m_s - *above * top_m_s;
        if (2.0 * std::abs(over_m_s) >= span.change_m_s) return over_m_s >= 0.0 ? 1.0 : 0.0;
        return 0.5 + over_m_s / span.change_m_s;
    }
};
constexpr std::array drifts{Drift{}, Drift{0.0}, Drift{0.3}, Drift{0.5}, Drift{0.7}, Drift{0.85}};

/// Variance of the noise about a scale and this drift, at least that explained, enlarged by the
/// correlation between neighbours. A correlation of 0.8 enlarges it ninefold; more of it cannot be
/// told from a drift.
double noise_variance(std::span<const SpanComparison> spans, const BestFit& best,
                      const Drift& drift, double top_m_s, double explained_m_s) {
    double square = 0.0, product = 0.0, before = 0.0;
    for (const SpanComparison& one : spans) {
        const double rest =
            one.along_m_s - best.scale * one.speed_m_s - best.drift_m_s * drift.shape(one, top_m_s);
        square += rest * rest;
        product += rest * before;
        before = rest;
    }
    const double correlation = square > 0.0 ? std::clamp(product / square, 0.0, 0.8) : 0.0;
    return std::max(explained_m_s * explained_m_s,
                    square / (static_cast<double>(spans.size()) - 2.0)) *
           (1.0 + correlation) / (1.0 - correlation);
}

}  // namespace

template <int Axes>
std::vector<SpanComparison> compare_spans(const Witness<Axes>& velocities,
                                          std::span<const TimedPosition<Axes>> positions) {
    constexpr double tolerance_s = 0.02;     // of stamps that are no whole multiples
    constexpr double least_speed_m_s = 0.5;  // slower, and the direction is noise
    std::vector<SpanComparison> spans;
    for (std::size_t from = 0, to = 0; from < positions.size(); ++to) {
        while (to < positions.size() && positions[to].stretch == positions[from].stretch &&
               positions[to].time_s < positions[from].time_s + usual_window_s - tolerance_s)
            ++to;
        if (to == positions.size()) break;
        const TimedPosition<Axes>& begin = positions[from];
        const TimedPosition<Axes>& end = positions[to];
        const std::size_t first = std::exchange(from, to);
        const double duration_s = end.time_s - begin.time_s;
        if (end.stretch != begin.stretch || duration_s > 2.0 * usual_window_s) continue;
        const auto witnessed = velocities.between(begin.time_s, end.time_s);
        const PositionVector<Axes> measured = end.position - begin.position;
        const double speed_m_s = measured.norm() / duration_s;
        if (!witnessed || speed_m_s < least_speed_m_s) continue;
        const PositionVector<Axes> difference = (measured - witnessed->displacement_m) / duration_s;
        const double along_m_s = difference.dot(measured.normalized());
        const auto speed_in = [&](const TimedPosition<Axes>& a, const TimedPosition<Axes>& b) {
            return (b.position - a.position).norm() / (b.time_s - a.time_s);
        };
        spans.push_back({.speed_m_s = speed_m_s,
                         .change_m_s = std::abs(speed_in(positions[to - 1], end) -
                                                speed_in(begin, positions[first + 1])),
                         .along_m_s = along_m_s,
                         .across_m_s = std::sqrt(
                             std::max(0.0, difference.squaredNorm() - along_m_s * along_m_s))});
    }
    return spans;
}

double LastingDifference::positions_at_fault(double prior, double largest_m_s) const {
    if (!(size_m_s > 0.0)) return prior;
    if (!is_scale) return 0.5;
    const double odds = 2.0 * prior * drift_odds_m_s / (2.0 * largest_m_s);
    return std::max(prior, 0.5 * odds / (1.0 + odds));
}

LastingDifference weigh_scale_and_drift(double size_m_s, std::span<const SpanComparison> spans,
                                        double explained_m_s, double known_m_s) {
    LastingDifference found{.size_m_s = size_m_s};
    constexpr std::size_t fewest = 5;  // two are fitted, and the noise to a factor of two
    if (!(size_m_s > 0.0) || spans.size() < fewest) return found;
    const auto count = static_cast<double>(spans.size());
    const double top_m_s =
        std::ranges::max_element(spans, {}, &SpanComparison::speed_m_s)->speed_m_s;
    std::array<Products, drifts.size()> sums;
    for (std::size_t i = 0; i < drifts.size(); ++i)
        sums[i] = products_of(
            spans, [&](const SpanComparison& span) { return drifts[i].shape(span, top_m_s); });
    const Products& of_scale = sums.front();
    found.scale = -of_scale.dv / of_scale.vv;
    double across = 0.0;
    for (const SpanComparison& one : spans)
        across += one.across_m_s * one.across_m_s;
    // Of heights there is nothing across.
    const double axes = across > 0.0 ? 2.0 : 1.0;
    const double beyond =
        (of_scale.dd - of_scale.dv * of_scale.dv / of_scale.vv + across) / (axes * count) -
        explained_m_s * explained_m_s;
    found.is_scale = beyond <= 0.25 * known_m_s * known_m_s;
    const auto best =
        std::ranges::min_element(sums, {}, [](const Products& one) { return BestFit(one).left; });
    const double variance =
        noise_variance(spans, BestFit(*best), drifts[static_cast<std::size_t>(best - sums.begin())],
                       top_m_s, std::max(explained_m_s, 0.5 * least_velocity_sigma_m_s));
    double highest = -std::numeric_limits<double>::infinity();
    for (const ScalePrior& prior : scale_priors)
        highest = std::max(highest, log_likelihood(of_scale, prior, variance));
    double by_scale = 0.0, by_drift = 0.0;
    for (const ScalePrior& prior : scale_priors) {
        by_scale += std::exp(log_likelihood(of_scale, prior, variance) - highest);
        for (const Products& drift : sums)
            by_drift += std::exp(log_likelihood(drift, prior, variance, known_m_s) - highest) /
                        static_cast<double>(sums.size());
    }
    found.drift_odds_m_s = std::min(by_drift / by_scale, 1e12);
    return found;
}

double unexplained_by_velocities_m_s(const ScreenedTable& screened, TestedAxes axes) {
    constexpr double longest_span_s = 10.0;
    const auto& all = screened.basis.velocity_errors;
    const auto errors = std::ranges::find(all, axes, &VelocityErrors::axes);
    if (errors == all.end()) return 0.0;
    const Explained explained(screened, axes);
    double lasting_m_s = errors->shown_m_s;
    for (const VelocitySpread& spread : errors->spreads) {
        if (spread.span_s > longest_span_s)
            continue;  // a longer span may not fill part of the recording
        const double beyond_m2 = spread.sd_m * spread.sd_m - explained.over_m2(spread.span_s);
        lasting_m_s = std::min(lasting_m_s, std::sqrt(std::max(0.0, beyond_m2)) / spread.span_s);
    }
    return lasting_m_s > known_of_velocities_m_s(*errors) ? lasting_m_s : 0.0;
}

template <int Axes>
LastingDifference lasting_difference(const ScreenedTable& screened,
                                     const Witness<Axes>* velocities) {
    constexpr TestedAxes axes = tested_axes<Axes>;
    const double size_m_s = unexplained_by_velocities_m_s(screened, axes);
    if (!(size_m_s > 0.0) || velocities == nullptr) return {.size_m_s = size_m_s};
    const auto& all = screened.basis.velocity_errors;
    return weigh_scale_and_drift(
        size_m_s, compare_spans<Axes>(*velocities, timed_positions<Axes>(screened.rows)),
        std::sqrt(Explained(screened, axes).over_m2(usual_window_s)) / usual_window_s,
        known_of_velocities_m_s(*std::ranges::find(all, axes, &VelocityErrors::axes)));
}
template LastingDifference lasting_difference(const ScreenedTable&, const Witness<1>*);
template LastingDifference lasting_difference(const ScreenedTable&, const Witness<2>*);

template std::vector<SpanComparison> compare_spans(const Witness<1>&,
                                                   std::span<const TimedPosition<1>>);
template std::vector<SpanComparison> compare_spans(const Witness<2>&,
                                                   std::span<const TimedPosition<2>>);

}  // namespace runcert
