#include "stages/window/witnessed_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"
#include "stages/window/budget.h"
#include "witness/evidence.h"
#include "witness/velocity_witness.h"

namespace runcert {
namespace {

/// What positions and witnesses have in common: frame, clock, height, course, antenna, calibration.
constexpr std::initializer_list<RowScope> common{RowScope::window, RowScope::antenna,
                                                 RowScope::calibration};

/// A witness beside positions with this time-correlated error. Another receiver's bound on such
/// errors is as large as theirs, and part of its uncertainty.
WitnessEvidence evidence_of(const WitnessedSpeed& one, double slow_m_s, double bias_m_s) {
    const bool is_receiver = one.kind == WitnessKind::receiver;
    const double u_m_s = one.standard_uncertainty_m_s;
    return {.kind = one.kind,
            .receiver = one.receiver,
            .difference_m_s = one.difference_m_s - bias_m_s,
            .own_standard_uncertainty_m_s =
                is_receiver ? std::sqrt(std::max(0.0, u_m_s * u_m_s - slow_m_s * slow_m_s)) : u_m_s,
            .slow_standard_uncertainty_m_s =
                is_receiver ? slow_m_s : one.shared_standard_uncertainty_m_s,
            .calibrated_by_positions = one.calibrated_by_positions,
            .fault_probability = one.fault_probability.value_or(0.0),
            .fault_m_s = one.fault_m_s.value_or(0.0)};
}

/// What positions and the witnesses with a share say together. The speed by positions is 0.
struct Combination {
    std::vector<SpeedBySource> speeds;
    MeanSpeed mean;
    double bias_m_s = 0.0;
    double remaining_difference_m_s = 0.0;
};

Combination combination_of(const SpeedEvidence& evidence, double fault_m_s,
                           const SelectionBias& selection) {
    Combination found{.speeds = speeds_of(evidence, 0.0), .mean = {}};
    found.mean = mean_of(found.speeds, fault_m_s);
    const double share = 1.0 - found.mean.weights.front();
    const double difference_m_s = -found.mean.speed_m_s;
    if (selection.treatment == SelectionTreatment::subtracted)
        found.bias_m_s =
            share > 0.0 ? (1.0 - share) * selection.bias_m_s +
                              share * std::clamp(difference_m_s / share, selection.fitted_bias_m_s,
                                                 selection.bounded_bias_m_s)
                        : selection.bias_m_s;
    found.remaining_difference_m_s = difference_m_s - share * found.bias_m_s;
    return found;
}

/// The budget of the weighted mean, from that of the positions alone. The witnesses are those with
/// a share, in the order of the combination's speeds.
std::vector<BudgetRow> rows_of(std::vector<BudgetRow> rows, const Combination& of,
                               const std::vector<WitnessedSpeed*>& witnesses) {
    if (witnesses.empty()) return rows;
    const std::vector<double>& weights = of.mean.weights;
    const SpeedBySource& positions = of.speeds.front();
    double of_slow = 0.0, common_m_s = 0.0;
    for (std::size_t i = 0; i < of.speeds.size(); ++i)
        if (i == 0 || of.speeds[i].slow_differs)
            of_slow += of.speeds[i].slow_m_s > 0.0 ? weights[i] : 0.0;
        else if (weights[i] > 0.0)
            common_m_s = std::min(of.speeds[i].slow_m_s, positions.slow_m_s);
    const double apart =
        of_slow * std::sqrt(positions.slow_m_s * positions.slow_m_s - common_m_s * common_m_s);
    for (BudgetRow& row : rows)
        if (row.touches == RowScope::source)
            scale(row, weights.front());
        else if (row.touches == RowScope::fault)
            scale(row, of.mean.fault_share);
        else if (row.touches == RowScope::slow && positions.slow_m_s > 0.0)
            scale(row, apart / positions.slow_m_s);
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
        const WitnessedSpeed& one = *witnesses[i];
        const double own_m_s = of.speeds[i + 1].own_m_s;
        BudgetRow own = speed_row(
            "g", std::string(words_of(one.kind)), "B", own_m_s, RowScope::witness,
            fmt::format("{:.4f} m/s by them, {:.4f} m/s times {:.3f}; the rows of the positions "
                        "count by {:.3f}",
                        one.speed_m_s, own_m_s, one.share, weights.front()));
        own.estimate = one.speed_m_s;
        scale(own, one.share);
        rows.push_back(std::move(own));
    }
    rows.push_back(speed_row("e", "difference of positions and witness", "B",
                             std::abs(of.remaining_difference_m_s), RowScope::witness,
                             "the speed stated is that of the positions, and not corrected"));
    if (std::ranges::any_of(of.speeds, [](const auto& one) { return !one.slow_differs; }))
        rows.push_back(
            speed_row("s", "time-correlated errors that positions and phases share", "B",
                      std::sqrt(std::max(0.0, of.mean.slow_m_s * of.mean.slow_m_s - apart * apart)),
                      RowScope::witness,
                      fmt::format("multipath disturbs both: {:g} m at either end of the window, "
                                  "independently",
                                  shared_by_phases_m)));
    return rows;
}

/// The witnesses that count: those that confirm, if nothing contradicts.
std::vector<WitnessedSpeed*> confirming_witnesses(std::vector<WitnessedSpeed>& witnesses,
                                                  SpeedEvidence& evidence) {
    std::vector<WitnessedSpeed*> confirming;
    for (WitnessedSpeed& one : witnesses)
        if (one.confirms) {
            confirming.push_back(&one);
            evidence.witnesses.push_back(
                evidence_of(one, evidence.slow_standard_uncertainty_m_s, 0.0));
        }
    // A single witness is judged on its own.
    if (confirming.size() > 1) evidence.disagreement = disagreement(speeds_of(evidence, 0.0));
    if (evidence.disagreement > 1.0 || std::ranges::any_of(witnesses, &contradicts)) {
        evidence.witnesses.clear();
        confirming.clear();
    }
    return confirming;
}

}  // namespace

SpeedBySource positions_of(const std::vector<BudgetRow>& rows, const FaultPrior& fault) {
    return {.own_m_s = uncertainty_of(rows, {RowScope::source}),
            .slow_m_s = uncertainty_of(rows, {RowScope::slow}),
            .fault = fault};
}

WitnessedBudget combine_with_witnesses(const std::vector<BudgetRow>& alone,
                                       const WindowFault& fault, const SelectionBias& selection,
                                       std::vector<WitnessedSpeed> witnesses) {
    const SpeedBySource positions = positions_of(alone);
    WitnessedBudget found{.witnesses = std::move(witnesses), .rows = {}, .evidence = {}};
    SpeedEvidence& evidence = found.evidence;
    evidence.position_standard_uncertainty_m_s = positions.alone_m_s();
    evidence.slow_standard_uncertainty_m_s = positions.slow_m_s;
    evidence.shared_standard_uncertainty_m_s = uncertainty_of(alone, common);
    evidence.fault_probability = fault.prior.probability;
    evidence.chosen_fault_probability = fault.chosen_probability;
    evidence.fault_m_s = fault.prior.largest_m_s;
    evidence.fault_upwards_alone = fault.prior.upwards_alone;
    const std::vector<WitnessedSpeed*> confirming = confirming_witnesses(found.witnesses, evidence);
    const auto with_fault = [&](double times) {
        const double fault_m_s = fault.standard_uncertainty_m_s(times);
        std::vector<BudgetRow> rows = alone;
        for (BudgetRow& row : rows)
            if (row.touches == RowScope::fault)
                row.contribution_m_s = row.standard_uncertainty = fault_m_s;
        return combine(rows_of(std::move(rows), combination_of(evidence, fault_m_s, selection),
                               confirming))
            .standard_uncertainty;
    };
    evidence.at_a_fifth_m_s = with_fault(0.2);
    evidence.at_five_times_m_s = with_fault(5.0);
    const Combination combination =
        combination_of(evidence, uncertainty_of(alone, {RowScope::fault}), selection);
    for (std::size_t i = 0; i < confirming.size(); ++i)
        confirming[i]->share = combination.mean.weights[i + 1];
    found.rows = rows_of(alone, combination, confirming);
    found.position_share = combination.mean.weights.front();
    found.bias_m_s = combination.bias_m_s;
    evidence.difference_m_s = combination.remaining_difference_m_s;
    for (WitnessEvidence& one : evidence.witnesses)
        one.difference_m_s -= found.bias_m_s;
    return found;
}

double least_expanded_m_s(const SpeedEvidence& evidence, double speed_m_s, double alone_m_s) {
    constexpr double coverage = 0.9545;  // of k = 2
    const bool is_alone = evidence.witnesses.empty();
    SpeedEvidence stated = evidence;
    if (is_alone) stated.chosen_fault_probability = evidence.fault_probability;
    const double half_width_m_s =
        mixture_of(stated, speed_m_s, WitnessSet::all).half_width(speed_m_s, coverage);
    const double at_fault = fault_posteriors(speeds_of(stated, speed_m_s)).front();
    constexpr double rounding = 1e-9;
    const bool is_likelier =
        at_fault > (1.0 + rounding) *
                       (is_alone ? largest_rare_probability : evidence.chosen_fault_probability);
    return is_likelier ? half_width_m_s : std::min(half_width_m_s, alone_m_s);
}

void cover_fault_mixture(double coverage_factor, const std::vector<BudgetRow>& alone,
                         CertifiableWindow& window) {
    if (window.witnesses.empty()) return;
    const double bias_m_s = window.bias_limit_m_s;
    const double alone_m_s = coverage_factor * combine(alone).standard_uncertainty + bias_m_s;
    const double least_m_s = least_expanded_m_s(*window.evidence, window.speed_m_s, alone_m_s);
    const double lacking = std::pow((least_m_s - bias_m_s) / coverage_factor, 2) -
                           std::pow(combine(window.budget).standard_uncertainty, 2);
    if (least_m_s <= bias_m_s || lacking <= 0.0) return;
    window.budget.push_back(speed_row(
        "x", "fault that positions or witnesses may have beside their difference", "B",
        std::sqrt(lacking), RowScope::window,
        fmt::format("raises the expanded uncertainty to {:.4f} m/s: within this the mixture of "
                    "faults holds the true speed with a probability of 95.45 %",
                    least_m_s)));
    for (double* const other :
         {&window.evidence->at_a_fifth_m_s, &window.evidence->at_five_times_m_s})
        *other = std::hypot(*other, window.budget.back().contribution_m_s);
}

double expected_with_velocities(const std::vector<BudgetRow>& rows, double own_uncertainty_m_s,
                                double bias_limit_m_s, double duration_s, double interval_s) {
    constexpr double sigma_at_epoch_m_s = 0.1;  // data sheets: 0.05 to 0.1 m/s
    constexpr double median_of_normal = 0.6745;
    WitnessedSpeed velocities;
    velocities.kind = WitnessKind::velocities;
    velocities.standard_uncertainty_m_s = std::hypot(
        least_velocity_sigma_m_s, sigma_at_epoch_m_s * std::sqrt(interval_s / duration_s));
    velocities.difference_m_s =
        median_of_normal * std::hypot(own_uncertainty_m_s, velocities.standard_uncertainty_m_s);
    WindowFault fault;
    const WitnessedBudget combined = combine_with_witnesses(rows, fault, {}, {velocities});
    return 2.0 * combine(combined.rows).standard_uncertainty +
           combined.position_share * bias_limit_m_s;
}

}  // namespace runcert
