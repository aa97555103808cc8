#include <fmt/format.h>

#include <cmath>

#include "stages/window/certify.h"

namespace runcert {

CertifiableWindow in_space(const CertifiableWindow& horizontal, const CertifiableWindow& vertical) {
    CertifiableWindow window = horizontal;
    const double speed = std::hypot(horizontal.speed_mps, vertical.speed_mps);
    const double level = speed > 0.0 ? horizontal.speed_mps / speed : 1.0;
    const double upright = speed > 0.0 ? vertical.speed_mps / speed : 1.0;
    const double of_level = level * horizontal.standard_uncertainty_mps;
    const double of_upright = upright * vertical.standard_uncertainty_mps;
    for (BudgetRow& row : window.budget) {
        row.sensitivity *= level;
        row.contribution_mps *= level;
    }
    const double added = std::sqrt(of_upright * of_upright + 2.0 * of_level * of_upright);
    window.budget.push_back({.symbol = "v",
                             .source = "vertical part of the speed",
                             .estimate = vertical.speed_mps,
                             .unit = "m / s",
                             .standard_uncertainty = added,
                             .type = "B",
                             .distribution = "normal",
                             .degrees_of_freedom = std::nullopt,
                             .sensitivity = 1.0,
                             .contribution_mps = added,
                             .correlation = "fully correlated with all other rows together; what "
                                            "it adds to them is given",
                             .note = fmt::format("its own standard uncertainty is {:.4f} m/s",
                                                 vertical.standard_uncertainty_mps)});
    window.speed_mps = speed;
    window.standard_uncertainty_mps = of_level + of_upright;
    window.bias_limit_mps = level * horizontal.bias_limit_mps + upright * vertical.bias_limit_mps;
    window.estimates = std::nullopt;
    window.own_standard_uncertainty_mps = std::nullopt;
    window.length_m = speed * window.span.duration.seconds();
    window.definitions.displacement_mps =
        std::hypot(horizontal.definitions.displacement_mps, vertical.definitions.displacement_mps);
    window.fitted = std::nullopt;
    window.monte_carlo = std::nullopt;
    window.reliability.insert(window.reliability.end(), vertical.reliability.begin(),
                              vertical.reliability.end());
    return window;
}

}  // namespace runcert
