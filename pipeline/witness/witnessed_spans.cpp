#include "witness/witnessed_spans.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d;

/// The displacement by positions minus that by the witness, over one span.
template <int Axes>
struct SpanDifference {
    PositionVector<Axes> difference_m = PositionVector<Axes>::Zero();
    double along_m = 0.0;    ///< its part along the way
    double speed_m_s = 0.0;  ///< mean along the path
};

template <int Axes>
std::vector<SpanDifference<Axes>> span_differences(const Witness<Axes>& witness,
                                                   std::span<const TimedPosition<Axes>> positions,
                                                   double span_s) {
    constexpr double tolerance = 1e-6;
    constexpr double spans_apart = 0.1;  // one tenth of the length; closer spans add nothing new
    std::vector<SpanDifference<Axes>> differences;
    std::size_t to = 0;
    double next_s = -std::numeric_limits<double>::infinity();
    for (const TimedPosition<Axes>& from : positions) {
        if (from.time_s < next_s) continue;
        while (to < positions.size() && positions[to].time_s < from.time_s + span_s - tolerance)
            ++to;
        if (to == positions.size()) break;
        const TimedPosition<Axes>& last = positions[to];
        if (last.stretch != from.stretch || last.time_s - from.time_s > 1.2 * span_s) continue;
        const auto witnessed = witness.between(from.time_s, last.time_s);
        const auto path_m = witness.path_between(from.time_s, last.time_s);
        if (!witnessed || !path_m) continue;
        const double length_s = last.time_s - from.time_s;
        const PositionVector<Axes> measured = last.position - from.position;
        // Scaled by the variance of the span's own length, which may be one interval longer.
        const PositionVector<Axes> difference =
            std::sqrt(span_s / length_s) * (measured - witnessed->displacement_m);
        differences.push_back({.difference_m = difference,
                               .along_m = difference.dot(measured.stableNormalized()),
                               .speed_m_s = *path_m / length_s});
        next_s = from.time_s + spans_apart * span_s;
    }
    return differences;
}

void set_core(std::span<const TimedPosition<2>> positions, const Witness<2>& witness,
              ContradictedSpan& span) {
    const Vector2d along = span.difference_m / span.difference_m.squaredNorm();
    const TimedPosition<2>& from = positions[span.first];
    span.core_first = span.first;
    span.core_last = span.last;
    for (std::size_t k = span.first + 1; k <= span.last; ++k) {
        const auto witnessed = witness.between(from.time_s, positions[k].time_s);
        if (!witnessed) continue;
        const double part =
            along.dot(positions[k].position - from.position - witnessed->displacement_m);
        if (part <= 0.1) span.core_first = k;
        if (part >= 0.9) {
            span.core_last = k;
            break;
        }
    }
}

/// Variance of a span's displacement from the positions' errors, m^2, each axis.
double variance_of_span(const TimedPosition<2>& begin, const TimedPosition<2>& end,
                        const SpanTest& test) {
    const double stated = begin.sigma_m * begin.sigma_m + end.sigma_m * end.sigma_m;
    const double spread = test.spread_m * test.spread_m;
    if (test.typical_sigma_m == 0.0) return spread + stated;
    return spread * std::max(1.0, stated / (2.0 * test.typical_sigma_m * test.typical_sigma_m));
}

}  // namespace

double half_of_fastest_tenth(std::vector<double> speeds_m_s) {
    if (speeds_m_s.empty()) return 0.0;
    const auto tenth = speeds_m_s.begin() + (std::ssize(speeds_m_s) - 1) * 9 / 10;
    std::ranges::nth_element(speeds_m_s, tenth);
    return 0.5 * *tenth;
}

template <int Axes>
std::optional<DisplacementSpread> displacement_spread(
    const Witness<Axes>& witness, std::span<const TimedPosition<Axes>> positions, double span_s) {
    constexpr double fewest = 5.0;
    const std::vector<SpanDifference<Axes>> all = span_differences(witness, positions, span_s);
    if (all.empty()) return std::nullopt;
    std::vector<double> speeds;
    for (const SpanDifference<Axes>& one : all)
        speeds.push_back(one.speed_m_s);
    const double least_m_s = half_of_fastest_tenth(std::move(speeds));
    std::vector<double> squares, along;
    for (const SpanDifference<Axes>& one : all) {
        if (one.speed_m_s < least_m_s) continue;
        squares.push_back(one.difference_m.squaredNorm());
        along.push_back(std::abs(one.along_m));
    }
    DisplacementSpread spread;
    spread.span_s = span_s;
    spread.spans = std::ssize(squares);
    spread.least_speed_m_s = least_m_s;
    // Consecutive spans are a tenth of their length apart, or one interval if that is longer.
    const double interval_s = (positions.back().time_s - positions.front().time_s) /
                              static_cast<double>(std::max<std::size_t>(positions.size(), 2) - 1);
    spread.independent =
        static_cast<double>(squares.size()) * std::min(1.0, std::max(0.1, interval_s / span_s));
    if (spread.independent < fewest) return std::nullopt;
    spread.sd_m = std::sqrt(median(std::move(squares)) / chi_squared_quantile(0.5, Axes));
    spread.along_m = median(std::move(along)) / normal_quantile(0.75);
    const int degrees = static_cast<int>(Axes * spread.independent);
    spread.sd_upper_m = spread.sd_m * std::sqrt(degrees / chi_squared_quantile(0.05, degrees));
    return spread;
}

std::vector<TimeSpan> stretches_of(std::span<const TimedPosition<2>> positions) {
    std::vector<TimeSpan> stretches(positions.size());
    for (std::size_t first = 0, end = 0; first < positions.size(); first = end) {
        while (end < positions.size() && positions[end].stretch == positions[first].stretch)
            ++end;
        const TimeSpan one{positions[first].time_s, positions[end - 1].time_s};
        for (std::size_t k = first; k < end; ++k)
            stretches[k] = one;
    }
    return stretches;
}

bool holds(const TimeSpan& stretch, double from_s, double to_s, double lag_s) {
    return from_s + std::min(0.0, lag_s) >= stretch.first_s &&
           to_s + std::max(0.0, lag_s) <= stretch.last_s;
}

std::vector<ContradictedSpan> contradicted_spans(std::span<const TimedPosition<2>> positions,
                                                 const Witness<2>& witness, const SpanTest& test) {
    constexpr double tolerance_s = 1e-6;
    const std::vector<TimeSpan> stretches = stretches_of(positions);
    std::vector<ContradictedSpan> spans;
    std::size_t to = 0;
    for (std::size_t from = 0; from < positions.size(); ++from) {
        const TimedPosition<2>& begin = positions[from];
        while (to < positions.size() &&
               positions[to].time_s < begin.time_s + test.span_s - tolerance_s)
            ++to;
        if (to == positions.size()) break;
        const TimedPosition<2>& end = positions[to];
        if (end.stretch != begin.stretch ||
            !holds(stretches[to], begin.time_s, end.time_s, test.lag_s))
            continue;
        const auto witnessed = witness.between(begin.time_s, end.time_s);
        if (!witnessed) continue;
        const Vector2d measured = end.position - begin.position;
        if (measured.norm() < test.least_speed_m_s * (end.time_s - begin.time_s)) continue;
        const Vector2d difference = measured - witnessed->displacement_m;
        const Matrix2d covariance =
            witnessed->covariance_m2 + variance_of_span(begin, end, test) * Matrix2d::Identity();
        const double statistic = difference.dot(covariance.inverse() * difference);
        if (!(statistic > test.threshold)) continue;
        ContradictedSpan& span = spans.emplace_back();
        span.first = from;
        span.last = to;
        span.difference_m = difference;
        span.statistic = statistic;
        set_core(positions, witness, span);
    }
    return spans;
}

namespace {

constexpr std::size_t spans_compared = 500;
constexpr std::int64_t least_spans = 10;

WitnessedMotionComparison compare_shifted(std::span<const TimedPosition<2>> positions,
                                          const Witness<2>& witness, double span_s, double shift_s,
                                          std::size_t at_most) {
    std::vector<double> differences_m, displacements_m, sigmas_m;
    const std::size_t stride = std::max<std::size_t>(1, positions.size() / at_most);
    std::size_t to = 0;
    for (std::size_t from = 0; from < positions.size(); from += stride) {
        constexpr double tolerance_s = 0.02;
        while (to < positions.size() &&
               positions[to].time_s < positions[from].time_s + span_s - tolerance_s)
            ++to;
        if (to == positions.size()) break;
        const TimedPosition<2>&begin = positions[from], &end = positions[to];
        if (end.time_s > begin.time_s + span_s + tolerance_s) continue;
        const auto witnessed = witness.between(begin.time_s - shift_s, end.time_s - shift_s);
        if (!witnessed) continue;
        const Vector2d measured = end.position - begin.position;
        differences_m.push_back((measured - witnessed->displacement_m).norm());
        displacements_m.push_back(measured.norm());
        sigmas_m.push_back(std::hypot(begin.sigma_m, end.sigma_m));
    }
    WitnessedMotionComparison comparison;
    comparison.spans = std::ssize(differences_m);
    if (differences_m.empty()) return comparison;
    comparison.median_difference_m = median(std::move(differences_m));
    comparison.median_displacement_m = median(std::move(displacements_m));
    constexpr double other_m = 0.5, other_share = 0.1, other_sigmas = 4.0;
    comparison.contradicts = comparison.spans >= least_spans &&
                             comparison.median_difference_m >
                                 std::max({other_m, other_share * comparison.median_displacement_m,
                                           other_sigmas * median(std::move(sigmas_m))});
    return comparison;
}

}  // namespace

WitnessedMotionComparison compare_motion(std::span<const TimedPosition<2>> positions,
                                         const Witness<2>& witness, double span_s) {
    WitnessedMotionComparison result =
        compare_shifted(positions, witness, span_s, 0.0, spans_compared);
    if (!result.contradicts) return result;
    constexpr double farthest_s = 60.0;
    constexpr std::size_t of_a_shift = 60;
    constexpr double much_better = 0.2;
    const auto shifted = [&](double shift_s) {
        return compare_shifted(positions, witness, span_s, shift_s, of_a_shift);
    };
    const auto typical_m2 = [&](double shift_s) {
        const WitnessedMotionComparison one = shifted(shift_s);
        return one.spans < least_spans ? std::numeric_limits<double>::infinity()
                                       : one.median_difference_m * one.median_difference_m;
    };
    const auto ahead_s = velocities::delay_of(typical_m2, 0.0, farthest_s + 1.0, 1.0, 1.0).delay_s;
    if (!ahead_s) return result;
    const WitnessedMotionComparison best = shifted(std::round(*ahead_s));
    if (!best.contradicts && best.median_difference_m < much_better * result.median_difference_m)
        result.positions_ahead_s = std::llround(*ahead_s);
    return result;
}

#define RUNCERT_INSTANTIATE(AXES)                                         \
    template std::optional<DisplacementSpread> displacement_spread<AXES>( \
        const Witness<AXES>&, std::span<const TimedPosition<AXES>>, double);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
