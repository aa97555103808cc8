#include "stages/window/shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/uncertainty.h"
#include "schemas/verdict/declared.h"
#include "stages/window/budget.h"
#include "witness/velocity_witness.h"

namespace runcert {
namespace {

/// A witness's terms, as `weigh` takes them.
WitnessTerm term_of(const WitnessedSpeed& one, double correlated_m_s) {
    const bool receiver = one.kind == WitnessKind::receiver;
    // Another receiver's own bound is as large as that of the positions, and is part of its
    // uncertainty.
    const double own_square = one.standard_uncertainty_m_s * one.standard_uncertainty_m_s -
                              (receiver ? correlated_m_s * correlated_m_s : 0.0);
    return {.difference_m_s = one.difference_m_s,
            .own_m_s = std::sqrt(std::max(0.0, own_square)),
            .shared_m_s = one.shared_standard_uncertainty_m_s,
            .shares_slow = receiver,
            .fault = {.probability = one.fault_probability.value_or(0.0),
                      .largest_m_s = one.fault_m_s.value_or(0.0)}};
}

/// The joint evidence of these terms. The shared uncertainty in `evidence` is raised to the further
/// part that their mean may share with the positions.
WitnessEvidence evidence_of(const PositionTerms& positions, const std::vector<WitnessTerm>& terms,
                            SpeedEvidence& evidence) {
    const WitnessMean mean = mean_of_witnesses(positions, terms);
    evidence.shared_standard_uncertainty_m_s =
        std::max(evidence.shared_standard_uncertainty_m_s, mean.besides_m_s);
    return {.difference_m_s = mean.difference_m_s,
            .standard_uncertainty_m_s = mean.standard_uncertainty_m_s,
            .common_standard_uncertainty_m_s = mean.common_m_s,
            .fault_probability = std::min(1.0, mean.fault.probability),
            .fault_m_s = mean.fault.largest_m_s};
}

}  // namespace

HeardTogether hear_together(const PositionTerms& positions, double correlated_m_s,
                            std::vector<WitnessedSpeed>& witnesses, SpeedEvidence& evidence) {
    std::vector<WitnessedSpeed*> heard;
    std::vector<WitnessTerm> terms, observed;
    for (WitnessedSpeed& one : witnesses)
        if (one.confirms) {
            heard.push_back(&one);
            terms.push_back(term_of(one, correlated_m_s));
            if (origin_of(one.kind).front() == to_text(InputOrigin::observed))
                observed.push_back(terms.back());
        }
    // A single witness is judged on its own.
    if (terms.size() > 1) evidence.disagreement = disagreement(positions, terms);
    if (terms.empty() || evidence.disagreement > 1.0 ||
        std::ranges::any_of(witnesses, &contradicts))
        return {};
    const WeightedSpeed mean = weigh(positions, terms);
    for (std::size_t k = 0; k < heard.size(); ++k)
        heard[k]->share = mean.witnesses[k];
    evidence.witnesses = evidence_of(positions, terms, evidence);
    if (!observed.empty()) evidence.observed = evidence_of(positions, observed, evidence);
    return {.position_share = mean.positions, .difference_m_s = mean.difference_m_s};
}

void condition_on(const std::vector<WitnessedSpeed>& witnesses, double correlated_m_s,
                  double remaining_difference_m_s, std::vector<BudgetRow>& rows) {
    double rest = 1.0, of_slow = 0.0, of_phases = 0.0, shared_m_s = 0.0;
    for (const WitnessedSpeed& one : witnesses) {
        rest -= one.share;
        if (one.kind == WitnessKind::receiver) of_slow += one.share;
        if (one.shared_standard_uncertainty_m_s == 0.0) continue;
        of_phases += one.share;
        shared_m_s = one.shared_standard_uncertainty_m_s;
    }
    if (rest == 1.0) return;
    rest = std::max(0.0, rest);
    of_slow += rest;
    // What positions and phases share is part of the positions' own time-correlated error.
    const auto slow = std::ranges::find(rows, RowScope::slow, &BudgetRow::touches);
    const double slow_m_s = slow == rows.end() ? 0.0 : slow->contribution_m_s;
    const double common_m_s = of_phases > 0.0 ? std::min(shared_m_s, slow_m_s) : 0.0;
    const auto scale = [](BudgetRow& row, double factor) {
        row.sensitivity *= factor;
        row.contribution_m_s *= factor;
    };
    for (BudgetRow& row : rows)
        if (row.touches == RowScope::source || row.touches == RowScope::fault)
            scale(row, rest);
        else if (row.touches == RowScope::slow && slow_m_s > 0.0)
            scale(row, of_slow * std::sqrt(1.0 - std::pow(common_m_s / slow_m_s, 2)));
    for (const WitnessedSpeed& one : witnesses) {
        if (one.share == 0.0) continue;
        const double own_m_s = term_of(one, correlated_m_s).own_m_s;
        BudgetRow own = speed_row(
            "g", std::string(words_of(one.kind)), "B", one.share * own_m_s, RowScope::witness,
            fmt::format("{:.4f} m/s by them, {:.4f} m/s times {:.3f}; the rows of the positions "
                        "count by {:.3f}",
                        one.speed_m_s, own_m_s, one.share, rest));
        own.estimate = one.speed_m_s;
        own.standard_uncertainty = own_m_s;
        own.sensitivity = one.share;
        rows.push_back(std::move(own));
    }
    rows.push_back(speed_row("e", "difference of positions and witness", "B",
                             std::abs(remaining_difference_m_s), RowScope::witness,
                             "the speed stated is that of the positions, and not corrected"));
    if (of_phases == 0.0) return;
    rows.push_back(speed_row(
        "s", "time-correlated errors that positions and phases share", "B",
        std::hypot((of_slow + of_phases) * common_m_s,
                   of_phases * std::sqrt(shared_m_s * shared_m_s - common_m_s * common_m_s)),
        RowScope::witness,
        fmt::format("multipath disturbs both: {:g} m at either end of the window, independently",
                    shared_by_phases_m)));
}

double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s) {
    constexpr double sigma_at_epoch_m_s = 0.1;
    constexpr double median_of_normal = 0.6745;
    WitnessedSpeed velocities;
    velocities.kind = WitnessKind::velocities;
    velocities.standard_uncertainty_m_s = std::hypot(
        least_velocity_sigma_m_s, sigma_at_epoch_m_s * std::sqrt(interval_s / duration_s));
    velocities.difference_m_s =
        median_of_normal * std::hypot(own_uncertainty_m_s, velocities.standard_uncertainty_m_s);
    const WeightedSpeed mean = weigh(position_terms(rows), std::array{term_of(velocities, 0.0)});
    velocities.share = mean.witnesses.front();
    condition_on({velocities}, 0.0, mean.difference_m_s, rows);
    return 2.0 * combine(rows).standard_uncertainty + mean.positions * bias_limit_m_s;
}

PositionTerms position_terms(const std::vector<BudgetRow>& rows) {
    return {.own_m_s = uncertainty_of(rows, {RowScope::source}),
            .slow_m_s = uncertainty_of(rows, {RowScope::slow}),
            .fault_m_s = uncertainty_of(rows, {RowScope::fault})};
}

}  // namespace runcert
