#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "stages/window/budget.h"
#include "stages/window/certify.h"

namespace runcert {

CertifiableWindow in_space(const CertifiableWindow& horizontal, const CertifiableWindow& vertical) {
    CertifiableWindow window = horizontal;
    const double speed = std::hypot(horizontal.speed_m_s, vertical.speed_m_s);
    const double level = speed > 0.0 ? horizontal.speed_m_s / speed : 1.0;
    const double upright = speed > 0.0 ? vertical.speed_m_s / speed : 1.0;
    const double of_level = level * horizontal.standard_uncertainty_m_s;
    const double of_upright = upright * vertical.standard_uncertainty_m_s;
    for (BudgetRow& row : window.budget) {
        row.sensitivity *= level;
        row.contribution_m_s *= level;
    }
    const double added = std::sqrt(of_upright * of_upright + 2.0 * of_level * of_upright);
    BudgetRow row = speed_row("v", "vertical part of the speed", "B", added, RowScope::source,
                              fmt::format("its own standard uncertainty is {:.4f} m/s",
                                          vertical.standard_uncertainty_m_s));
    row.estimate = vertical.speed_m_s;
    row.correlation =
        "fully correlated with all other rows together; what it adds to them is given";
    window.budget.push_back(std::move(row));
    window.speed_m_s = speed;
    window.standard_uncertainty_m_s = of_level + of_upright;
    window.bias_limit_m_s = level * horizontal.bias_limit_m_s + upright * vertical.bias_limit_m_s;
    if (window.evidence && vertical.evidence) {
        SpeedEvidence& sum = *window.evidence;
        const SpeedEvidence& other = *vertical.evidence;
        const auto along = [&](double SpeedEvidence::*figure) {
            sum.*figure = level * sum.*figure + upright * other.*figure;
        };
        along(&SpeedEvidence::position_standard_uncertainty_m_s);
        along(&SpeedEvidence::slow_standard_uncertainty_m_s);
        along(&SpeedEvidence::shared_standard_uncertainty_m_s);
        along(&SpeedEvidence::fault_m_s);
        along(&SpeedEvidence::at_a_fifth_m_s);
        along(&SpeedEvidence::at_five_times_m_s);
        sum.fault_probability = std::min(1.0, sum.fault_probability + other.fault_probability);
        sum.chosen_fault_probability =
            std::min(1.0, sum.chosen_fault_probability + other.chosen_fault_probability);
    } else {
        window.evidence.reset();
    }
    window.estimates = std::nullopt;
    window.own_standard_uncertainty_m_s = std::nullopt;
    window.length_m = speed * window.span.duration.seconds();
    window.definitions.displacement_m_s =
        std::hypot(horizontal.definitions.displacement_m_s, vertical.definitions.displacement_m_s);
    window.fitted = std::nullopt;
    window.monte_carlo = std::nullopt;
    window.reliability.insert(window.reliability.end(), vertical.reliability.begin(),
                              vertical.reliability.end());
    return window;
}

}  // namespace runcert
