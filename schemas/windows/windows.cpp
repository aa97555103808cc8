#include "schemas/windows/windows.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/uncertainty.h"

namespace runcert {

double speed_by(const SpeedDefinitions& definitions, SpeedDefinition definition) {
    switch (definition) {
        case SpeedDefinition::displacement:
            return definitions.displacement_mps;
        case SpeedDefinition::path_length:
            return definitions.path_length_mps;
        case SpeedDefinition::mean_n_plus_1:
            return definitions.mean_n_plus_1_mps;
        case SpeedDefinition::mean_n:
            return definitions.mean_n_mps;
        case SpeedDefinition::elapsed_time:
            break;
    }
    throw Failure("definition of speed", "elapsed_time is not one of those of every window",
                  "This is a fault of the program; please report it");
}

LinearisationJudgement judge_linearisation(const CertifiableWindow& window) {
    constexpr double probability = 0.95;
    const MonteCarloCheck& check = window.monte_carlo.value();
    const double half_width_mps =
        coverage_factor(probability, window.effective_degrees_of_freedom) *
        window.standard_uncertainty_mps;
    const auto agree = [&](double drawn, double propagated) {
        return std::abs(drawn - propagated) <= check.tolerance_mps;
    };
    LinearisationJudgement judged{.lower_mps = window.speed_mps - half_width_mps,
                                  .upper_mps = window.speed_mps + half_width_mps};
    judged.uncertainty_agrees =
        agree(check.standard_uncertainty_mps, window.standard_uncertainty_mps);
    judged.interval_agrees =
        agree(check.lower_mps, judged.lower_mps) && agree(check.upper_mps, judged.upper_mps);
    judged.interval_holds =
        judged.lower_mps <= check.lower_mps && judged.upper_mps >= check.upper_mps;
    return judged;
}

double expanded_uncertainty_by_rule_mps(const CertifiableWindow& window, double rule_factor) {
    return expanded_uncertainty_mps(
        window, equivalent_coverage_factor(rule_factor, window.effective_degrees_of_freedom));
}

double expanded_uncertainty_by_rule_mps(const RuleFigure& figure, double rule_factor) {
    return expanded_uncertainty_mps(
        figure, equivalent_coverage_factor(rule_factor, figure.effective_degrees_of_freedom));
}

std::optional<RuleFigure> figure_of(const ProfileWindows& windows) {
    const std::size_t wanted =
        windows.rule.opposite_runs ? 2 : static_cast<std::size_t>(windows.rule.count);
    if (!windows.best || windows.further.size() + 1 < wanted) return std::nullopt;
    RuleFigure figure{.speed_mps = windows.best->speed_mps,
                      .standard_uncertainty_mps = windows.best->standard_uncertainty_mps,
                      .effective_degrees_of_freedom = windows.best->effective_degrees_of_freedom,
                      .bias_limit_mps = windows.best->bias_limit_mps};
    for (const FurtherWindow& one : windows.further) {
        figure.speed_mps += one.speed_mps;
        figure.standard_uncertainty_mps += one.standard_uncertainty_mps;
        figure.bias_limit_mps += one.bias_limit_mps;
    }
    const auto count = static_cast<double>(windows.further.size() + 1);
    figure.speed_mps /= count;
    figure.standard_uncertainty_mps /= count;
    figure.bias_limit_mps /= count;
    return figure;
}

const ProfileWindows* windows_of(const Windows& windows, std::string_view profile) {
    const auto found = std::ranges::find(windows.profiles, profile, &ProfileWindows::profile);
    return found == windows.profiles.end() ? nullptr : &*found;
}

}  // namespace runcert
