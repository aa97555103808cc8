#include "schemas/windows/windows.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/uncertainty.h"

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

std::optional<RuleFigure> figure_of(const ProfileWindows& windows) {
    const std::size_t wanted =
        windows.rule.opposite_runs ? 2 : static_cast<std::size_t>(windows.rule.count);
    if (!windows.best || windows.further.size() + 1 < wanted) return std::nullopt;
    RuleFigure figure{.speed_m_s = windows.best->speed_m_s,
                      .standard_uncertainty_m_s = windows.best->standard_uncertainty_m_s,
                      .effective_degrees_of_freedom = windows.best->effective_degrees_of_freedom,
                      .bias_limit_m_s = windows.best->bias_limit_m_s};
    for (const FurtherWindow& one : windows.further) {
        figure.speed_m_s += one.speed_m_s;
        figure.standard_uncertainty_m_s += one.standard_uncertainty_m_s;
        figure.bias_limit_m_s += one.bias_limit_m_s;
    }
    const auto count = static_cast<double>(windows.further.size() + 1);
    figure.speed_m_s /= count;
    figure.standard_uncertainty_m_s /= count;
    figure.bias_limit_m_s /= count;
    return figure;
}

const ProfileWindows* windows_of(const Windows& windows, std::string_view profile) {
    const auto found = std::ranges::find(windows.profiles, profile, &ProfileWindows::profile);
    return found == windows.profiles.end() ? nullptr : &*found;
}

}  // namespace runcert
