#include "schemas/windows/windows.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/uncertainty.h"
#include "schemas/common/header.h"
#include "schemas/profile/profile.h"

namespace runcert {

double speed_by(const SpeedDefinitions& definitions, SpeedDefinition definition) {
    switch (definition) {
        case SpeedDefinition::displacement:
            return definitions.displacement_m_s;
        case SpeedDefinition::path_length:
            return definitions.path_length_m_s;
        case SpeedDefinition::mean_n_plus_1:
            return definitions.mean_n_plus_1_m_s;
        case SpeedDefinition::mean_n:
            return definitions.mean_n_m_s;
        case SpeedDefinition::elapsed_time:
            break;
    }
    throw Failure("definition of speed", "elapsed_time is not one of those of every window",
                  "This is a fault of the program; please report it");
}

WindowRule rule_of(const Profile& profile) {
    const auto as_written = [](const YamlValue& part) {
        return part.exists() ? json_from_yaml(part).dump() : std::string();
    };
    return {.kind = profile.window_kind,
            .duration_s = profile.duration_s,
            .distance_m = profile.distance_m,
            .definition = profile.definition,
            .dimension = profile.dimension,
            .source = profile.speed_source,
            .ends = profile.ends,
            .exact = profile.exact_duration,
            .count = profile.windows,
            .speed_of = profile.speed_of,
            .opposite_runs = profile.opposite_runs_within_s.has_value(),
            .opposite_runs_within_s = profile.opposite_runs_within_s,
            .runs = as_written(profile.written["runs"]),
            .alpha = profile.alpha,
            .proximity_m = profile.proximity_m,
            .turn_deg = profile.turn_deg,
            .within = as_written(profile.written["window"]["within"])};
}

LinearisationJudgement judge_linearisation(const CertifiableWindow& window) {
    constexpr double probability = 0.95;
    const MonteCarloCheck& check = window.monte_carlo.value();
    const double half_width_m_s =
        coverage_factor(probability, window.effective_degrees_of_freedom) *
        window.standard_uncertainty_m_s;
    const auto agree = [&](double drawn, double propagated) {
        return std::abs(drawn - propagated) <= check.tolerance_m_s;
    };
    LinearisationJudgement judged{.lower_m_s = window.speed_m_s - half_width_m_s,
                                  .upper_m_s = window.speed_m_s + half_width_m_s};
    judged.uncertainty_agrees =
        agree(check.standard_uncertainty_m_s, window.standard_uncertainty_m_s);
    judged.interval_agrees =
        agree(check.lower_m_s, judged.lower_m_s) && agree(check.upper_m_s, judged.upper_m_s);
    judged.interval_holds =
        judged.lower_m_s <= check.lower_m_s && judged.upper_m_s >= check.upper_m_s;
    return judged;
}

double expanded_uncertainty_by_rule_m_s(const CertifiableWindow& window, double rule_factor) {
    return expanded_uncertainty_m_s(
        window, equivalent_coverage_factor(rule_factor, window.effective_degrees_of_freedom));
}

double expanded_uncertainty_by_rule_m_s(const RuleFigure& figure, double rule_factor) {
    return expanded_uncertainty_m_s(
        figure, equivalent_coverage_factor(rule_factor, figure.effective_degrees_of_freedom));
}

bool contradicts(const WitnessedSpeed& one) {
    if (!one.fault_posterior) return one.normalised_error > 1.0;
    return *one.fault_posterior > 0.5 || one.chance_error.value_or(0.0) > 1.0;
}

namespace {

/// The witnesses of both windows: of their mean speed, an error of either window moves its part.
void add_to(std::vector<WitnessEvidence>& sum, const std::vector<WitnessEvidence>& others) {
    std::erase_if(sum, [&](WitnessEvidence& one) {
        const auto other = std::ranges::find_if(others, [&](const WitnessEvidence& each) {
            return each.kind == one.kind && each.receiver == one.receiver;
        });
        if (other == others.end()) return true;
        one.difference_m_s += other->difference_m_s;
        one.own_standard_uncertainty_m_s += other->own_standard_uncertainty_m_s;
        one.slow_standard_uncertainty_m_s += other->slow_standard_uncertainty_m_s;
        one.fault_probability = std::min(1.0, one.fault_probability + other->fault_probability);
        one.fault_m_s = std::max(one.fault_m_s, other->fault_m_s);
        return false;
    });
}

void add_to(SpeedEvidence& sum, const SpeedEvidence& one) {
    sum.position_standard_uncertainty_m_s += one.position_standard_uncertainty_m_s;
    sum.slow_standard_uncertainty_m_s += one.slow_standard_uncertainty_m_s;
    sum.shared_standard_uncertainty_m_s += one.shared_standard_uncertainty_m_s;
    sum.fault_probability = std::min(1.0, sum.fault_probability + one.fault_probability);
    sum.chosen_fault_probability =
        std::min(1.0, sum.chosen_fault_probability + one.chosen_fault_probability);
    sum.fault_m_s = std::max(sum.fault_m_s, one.fault_m_s);
    sum.fault_upwards_alone = sum.fault_upwards_alone && one.fault_upwards_alone;
    sum.difference_m_s = 0.0;  // the mean's uncertainty holds it, and in no row of its own
    add_to(sum.witnesses, one.witnesses);
}

void divide(SpeedEvidence& sum, double count) {
    sum.position_standard_uncertainty_m_s /= count;
    sum.slow_standard_uncertainty_m_s /= count;
    sum.shared_standard_uncertainty_m_s /= count;
    sum.fault_m_s /= count;
    for (WitnessEvidence& one : sum.witnesses) {
        one.difference_m_s /= count;
        one.own_standard_uncertainty_m_s /= count;
        one.slow_standard_uncertainty_m_s /= count;
        one.fault_m_s /= count;
    }
}

}  // namespace

std::optional<RuleFigure> figure_of(const ProfileWindows& windows) {
    const std::size_t wanted =
        windows.rule.opposite_runs ? 2 : static_cast<std::size_t>(windows.rule.count);
    if (!windows.best || windows.further.size() + 1 < wanted) return std::nullopt;
    RuleFigure figure{.speed_m_s = windows.best->speed_m_s,
                      .standard_uncertainty_m_s = windows.best->standard_uncertainty_m_s,
                      .effective_degrees_of_freedom = windows.best->effective_degrees_of_freedom,
                      .bias_limit_m_s = windows.best->bias_limit_m_s,
                      .evidence = windows.best->evidence};
    for (const FurtherWindow& one : windows.further) {
        figure.speed_m_s += one.speed_m_s;
        figure.standard_uncertainty_m_s += one.standard_uncertainty_m_s;
        figure.bias_limit_m_s += one.bias_limit_m_s;
        if (figure.evidence && one.evidence)
            add_to(*figure.evidence, *one.evidence);
        else
            figure.evidence.reset();
    }
    const auto count = static_cast<double>(windows.further.size() + 1);
    figure.speed_m_s /= count;
    figure.standard_uncertainty_m_s /= count;
    figure.bias_limit_m_s /= count;
    if (figure.evidence) divide(*figure.evidence, count);
    return figure;
}

const ProfileWindows* windows_of(const Windows& windows, std::string_view profile) {
    const auto found = std::ranges::find(windows.profiles, profile, &ProfileWindows::profile);
    return found == windows.profiles.end() ? nullptr : &*found;
}

}  // namespace runcert
