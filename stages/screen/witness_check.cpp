#include "stages/screen/witness_check.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/statistics.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

/// Writes a test's finding into the row. The size is as uncertain as its statistic implies.
void mark_row(ScreenedEpoch& row, const ScreeningTest& test, const Eigen::Vector2d& difference_m,
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

/// Marks epochs between two steps that are contradicted in opposite directions.
std::int64_t mark_displaced(std::vector<ScreenedEpoch>& rows, const UsablePositions& usable,
                            const std::vector<ContradictedSpan>& steps, const ScreeningTest& test,
                            double threshold) {
    std::int64_t marked = 0;
    for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
        const ContradictedSpan &to = steps[i], &from = steps[i + 1];
        if (to.last != from.first || to.difference_m.dot(from.difference_m) >= 0.0) continue;
        mark_row(rows[usable.rows[to.last]], test, to.difference_m,
                 std::min(to.statistic, from.statistic), threshold);
        ++marked;
    }
    return marked;
}

SpanTest test_of(const DisplacementSpread& spread, const ScreeningTest& test,
                 double typical_sigma_m, double threshold) {
    return {.span_s = spread.span_s,
            .spread_m = spread.sd_upper_m,
            .typical_sigma_m = typical_sigma_m,
            .least_speed_m_s = test.only_fast ? spread.least_speed_m_s : 0.0,
            .threshold = threshold};
}

double typical_sigma_m(const std::vector<TimedPosition<2>>& positions) {
    std::vector<double> sigmas;
    for (const TimedPosition<2>& one : positions)
        sigmas.push_back(one.sigma_m);
    return sigmas.empty() ? 0.0 : median(std::move(sigmas));
}

}  // namespace

UsablePositions usable_positions(const std::vector<ScreenedEpoch>& rows) {
    UsablePositions usable{.positions = timed_positions<2>(rows), .rows = {}};
    usable.rows.reserve(usable.positions.size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].usable && rows[i].arc) usable.rows.push_back(i);
    return usable;
}

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
    const auto contradicted_by = [&](const DisplacementSpread& spread) {
        return contradicted_spans(usable.positions, *test.witness,
                                  test_of(spread, by_roster, typical_m, threshold));
    };
    if (by_roster.single_epochs)
        if (const auto spread =
                displacement_spread<2>(*test.witness, usable.positions, nominal_interval_s))
            comparison.rejected =
                mark_displaced(rows, usable, contradicted_by(*spread), by_roster, threshold);
    std::vector<ContradictedSpan> contradicted;
    for (const double span_s : spans_s) {
        const auto spread = displacement_spread<2>(*test.witness, usable.positions, span_s);
        if (!spread) continue;
        comparison.spreads.push_back({.span_s = spread->span_s,
                                      .spans = spread->spans,
                                      .sd_m = spread->sd_m,
                                      .sd_upper_m = spread->sd_upper_m});
        if (comparison.rejected > 0) continue;
        const auto spans = contradicted_by(*spread);
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
