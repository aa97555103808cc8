#include "stages/screen/witness_check.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/statistics.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

using Eigen::Matrix2d, Eigen::Vector2d;

/// Intervals on either side that determine a local spread, and how many of them are needed.
constexpr std::size_t neighbours = 10;
constexpr std::size_t least_neighbours = 8;
/// Consecutive intervals that show a drift: one more than a wrong sample of a witness touches.
constexpr std::size_t drifting_intervals = 3;

/// The usable rows of the arcs: their positions and their row indices.
struct UsablePositions {
    std::vector<TimedPosition<2>> positions;
    std::vector<std::size_t> rows;
};

UsablePositions usable_positions(const std::vector<ScreenedEpoch>& rows) {
    UsablePositions usable{.positions = timed_positions<2>(rows), .rows = {}};
    usable.rows.reserve(usable.positions.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].usable && rows[i].arc) usable.rows.push_back(i);
    return usable;
}

/// Writes a test's finding into the row. The size is as uncertain as its statistic implies.
void mark_row(ScreenedEpoch& row, const ScreeningTest& test, const Vector2d& difference_m,
              double statistic, double threshold) {
    row.usable = false;
    row.reason = test.reason;
    row.hypothesis = test.hypothesis;
    row.tested_axes = TestedAxes::horizontal;
    row.statistic = statistic;
    row.threshold = threshold;
    const double sigma_m = difference_m.norm() / std::sqrt(statistic);
    row.estimated = {};
    row.estimated.east_m = difference_m.x();
    row.estimated.north_m = difference_m.y();
    row.estimated.sigma_east_m = row.estimated.sigma_north_m = sigma_m;
    row.estimated.correlation_east_north = 0.0;
}

/// A displacement by the positions and its covariance, as far as it is known.
struct Displacement {
    Vector2d value_m = Vector2d::Zero();
    Matrix2d covariance_m2 = Matrix2d::Zero();
};

/// A displacement over the interval that ends at a usable position, minus that by the witness.
struct IntervalDifference {
    std::size_t last = 0;
    Vector2d value_m = Vector2d::Zero();
    Matrix2d known_m2 = Matrix2d::Zero();
    double statistic = 0.0;
};
using IntervalDifferences = std::vector<IntervalDifference>;

/// Differences of displacements (`by_positions(k)`, over the interval that ends at k; empty where
/// unknown).
template <class ByPositions>
IntervalDifferences interval_differences(const UsablePositions& usable,
                                         const DisplacementTest& test,
                                         const ByPositions& by_positions) {
    const auto& positions = usable.positions;
    const Witness<2>& witness = test.over_intervals ? *test.over_intervals : *test.witness;
    const std::vector<TimeSpan> stretches = stretches_of(positions);
    IntervalDifferences differences;
    for (std::size_t k = 1; k < positions.size(); ++k) {
        if (positions[k - 1].stretch != positions[k].stretch ||
            !holds(stretches[k], positions[k - 1].time_s, positions[k].time_s, test.lag_s))
            continue;
        const auto witnessed = witness.between(positions[k - 1].time_s, positions[k].time_s);
        const std::optional<Displacement> by = by_positions(k);
        if (witnessed && by)
            differences.push_back({.last = k,
                                   .value_m = by->value_m - witnessed->displacement_m,
                                   .known_m2 = by->covariance_m2 + witnessed->covariance_m2});
    }
    return differences;
}

bool follow(const IntervalDifference& a, const IntervalDifference& b) {
    return a.last + 1 == b.last;
}

/// The spread (m, each axis) about a difference, from the changes between neighbours: a drift of
/// the positions moves many of them alike, and so cannot hide in it. The median leaves out what
/// three outliers make of them. 0 where there are too few.
double local_spread_m(const IntervalDifferences& differences, std::size_t k) {
    std::vector<double> squares;
    const std::size_t last = std::min(differences.size() - 1, k + neighbours);
    for (std::size_t i = k - std::min(k, neighbours); i < last; ++i)
        if (follow(differences[i], differences[i + 1]))
            squares.push_back(0.5 *
                              (differences[i + 1].value_m - differences[i].value_m).squaredNorm());
    if (squares.size() < least_neighbours) return 0.0;
    return std::sqrt(median(std::move(squares)) / chi_squared_quantile(0.5, 2));
}

/// Fills in the statistics. The variance is what is known, larger near the ends of arcs and after
/// gaps, plus what the recording's spread (m), or the local one, has beyond what is typically
/// known.
void standardise(IntervalDifferences& differences, double spread_m) {
    std::vector<double> variances;
    for (const IntervalDifference& one : differences)
        variances.push_back(0.5 * one.known_m2.trace());
    const double typical_m2 = median(std::move(variances));
    for (std::size_t k = 0; k < differences.size(); ++k) {
        IntervalDifference& one = differences[k];
        const double largest_m = std::max(spread_m, local_spread_m(differences, k));
        const Matrix2d covariance =
            one.known_m2 + std::max(0.0, largest_m * largest_m - typical_m2) * Matrix2d::Identity();
        one.statistic = one.value_m.dot(covariance.inverse() * one.value_m);
    }
}

/// Calls `mark` with the differences on both sides of a position, each time that so many
/// consecutive ones exceed the threshold, each in the opposite direction of the one before or all
/// in the same.
template <class Mark>
void for_contradicted(const IntervalDifferences& differences, double threshold,
                      std::size_t consecutive, bool opposite, const Mark& mark) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < differences.size(); ++i) {
        const IntervalDifference& one = differences[i];
        if (!(one.statistic > threshold)) {
            length = 0;
            continue;
        }
        const bool continues = length > 0 && follow(differences[i - 1], one) &&
                               (differences[i - 1].value_m.dot(one.value_m) < 0.0) == opposite;
        length = continues ? length + 1 : 1;
        if (length < consecutive) continue;
        // All of the first run, then one more at a time.
        for (std::size_t k = length == consecutive ? i + 2 - consecutive : i; k <= i; ++k)
            mark(differences[k - 1], differences[k]);
    }
}

/// The displacement of the smoothed motion over the interval that ends at a position: the integral
/// of the cubic with these velocities and accelerations at its ends.
std::optional<Displacement> smoothed_displacement(const UsablePositions& usable,
                                                  const Motion& motion, std::size_t last) {
    const auto &a = motion[usable.rows[last - 1]], &b = motion[usable.rows[last]];
    if (!a || !b) return std::nullopt;
    const double h_s = usable.positions[last].time_s - usable.positions[last - 1].time_s;
    return Displacement{
        .value_m = 0.5 * h_s * (a->velocity + b->velocity) +
                   h_s * h_s / 12.0 * (a->acceleration - b->acceleration),
        .covariance_m2 = 0.5 * h_s * h_s * (a->velocity_covariance + b->velocity_covariance)};
}

double spread_of(const IntervalDifferences& differences) {
    std::vector<double> squares;
    for (const IntervalDifference& one : differences)
        squares.push_back(one.value_m.squaredNorm());
    return std::sqrt(median(std::move(squares)) / chi_squared_quantile(0.5, 2));
}

/// Marks the epochs in which the difference of contradicted spans arises. The arc ends after them
/// (ramp), because positions before and after do not belong together.
void mark_spans(std::vector<ScreenedEpoch>& rows, const UsablePositions& usable,
                const std::vector<ContradictedSpan>& spans, const ScreeningTest& test,
                double threshold) {
    for (const ContradictedSpan& span : spans) {
        const auto mark_at = [&](std::size_t k) {
            mark_row(rows[usable.rows[k]], test, span.difference_m, span.statistic, threshold);
        };
        for (std::size_t k = span.core_first + 1; k < span.core_last; ++k)
            mark_at(k);
        ScreenedEpoch& after = rows[usable.rows[span.core_last]];
        if (span.core_last == span.core_first + 1) mark_at(span.core_last);
        if (!after.break_before) after.break_before = ArcBreak::ramp;
    }
}

double typical_sigma_m(const std::vector<TimedPosition<2>>& positions) {
    std::vector<double> sigmas;
    for (const TimedPosition<2>& one : positions)
        sigmas.push_back(one.sigma_m);
    return sigmas.empty() ? 0.0 : median(std::move(sigmas));
}

/// Marks outliers, or where there are none, epochs about which the smoothed motion drifts. Returns
/// the number of outliers.
std::int64_t mark_intervals(std::vector<ScreenedEpoch>& rows, const UsablePositions& usable,
                            const DisplacementTest& test, const DisplacementSpread& spread,
                            const ScreeningTest& by_roster, double typical_m, double threshold) {
    const auto mark = [&](const IntervalDifference& to, double statistic) {
        mark_row(rows[usable.rows[to.last]], by_roster, to.value_m, statistic, threshold);
    };
    const double least_m_s = by_roster.only_fast ? spread.least_speed_m_s : 0.0;
    const auto& positions = usable.positions;
    IntervalDifferences measured =
        interval_differences(usable, test, [&](std::size_t k) -> std::optional<Displacement> {
            const TimedPosition<2>&begin = positions[k - 1], &end = positions[k];
            const Vector2d by_positions = end.position - begin.position;
            if (by_positions.norm() < least_m_s * (end.time_s - begin.time_s)) return std::nullopt;
            const double stated_m2 = begin.sigma_m * begin.sigma_m + end.sigma_m * end.sigma_m;
            const double typical_m2 = 2.0 * typical_m * typical_m;
            // In the measure in which typical positions show what they state.
            const double known_m2 =
                test.adds_stated || typical_m2 == 0.0
                    ? stated_m2
                    : spread.sd_upper_m * spread.sd_upper_m * std::max(1.0, stated_m2 / typical_m2);
            return Displacement{.value_m = by_positions,
                                .covariance_m2 = known_m2 * Matrix2d::Identity()};
        });
    if (measured.empty()) return 0;
    standardise(measured, spread.sd_upper_m);
    std::int64_t outliers = 0;
    for_contradicted(measured, threshold, 2, true, [&](const auto& to, const auto& from) {
        mark(to, std::min(to.statistic, from.statistic));
        ++outliers;
    });
    if (outliers > 0 || test.motion == nullptr) return outliers;
    IntervalDifferences smoothed = interval_differences(usable, test, [&](std::size_t k) {
        return smoothed_displacement(usable, *test.motion, k);
    });
    if (smoothed.empty()) return 0;
    standardise(smoothed, spread_of(smoothed));
    for_contradicted(smoothed, threshold, drifting_intervals, false,
                     [&](const auto& to, const auto& from) {
                         mark(to, std::min(to.statistic, from.statistic));
                     });
    return 0;
}

}  // namespace

DisplacementComparison check_displacements(std::vector<ScreenedEpoch>& rows,
                                           const DisplacementTest& test, double nominal_interval_s,
                                           double test_size) {
    constexpr std::array spans_s{3.0, 10.0};
    const ScreeningTest& by_roster = witness_entry(test.kind).screening.value();
    const double threshold = chi_squared_upper_quantile(test_size, 2);
    const UsablePositions usable = usable_positions(rows);
    DisplacementComparison comparison;
    comparison.kind = test.kind;
    comparison.receiver = test.receiver;
    const double typical_m = typical_sigma_m(usable.positions);
    if (by_roster.single_epochs)
        if (const auto spread =
                displacement_spread<2>(*test.witness, usable.positions, nominal_interval_s))
            comparison.rejected =
                mark_intervals(rows, usable, test, *spread, by_roster, typical_m, threshold);
    std::vector<ContradictedSpan> contradicted;
    for (const double span_s : spans_s) {
        const auto spread = displacement_spread<2>(*test.witness, usable.positions, span_s);
        if (!spread) continue;
        comparison.spreads.push_back(*spread);
        if (comparison.rejected > 0) continue;
        const auto spans = contradicted_spans(
            usable.positions, *test.witness,
            {.span_s = spread->span_s,
             .spread_m = spread->sd_upper_m,
             .typical_sigma_m = test.adds_stated ? 0.0 : typical_m,
             .lag_s = test.lag_s,
             .least_speed_m_s = by_roster.only_fast ? spread->least_speed_m_s : 0.0,
             .threshold = threshold});
        contradicted.insert(contradicted.end(), spans.begin(), spans.end());
    }
    if (comparison.rejected > 0) return comparison;
    mark_spans(rows, usable, contradicted, by_roster, threshold);
    comparison.rejected =
        std::ranges::count_if(usable.rows, [&](std::size_t row) { return !rows[row].usable; });
    return comparison;
}

void note(DisplacementComparison found, std::vector<DisplacementComparison>& all) {
    const auto same = std::ranges::find_if(all, [&](const DisplacementComparison& one) {
        return one.kind == found.kind && one.receiver == found.receiver;
    });
    if (same == all.end()) {
        all.push_back(std::move(found));
        return;
    }
    found.rejected += same->rejected;
    *same = std::move(found);
}

}  // namespace runcert
