#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/json_facts.h"
#include "reports/certificate/report_data.h"

namespace runcert {

/// The unit and the factor that a window's uncertainties are shown with.
struct UncertaintyScale {
    const SpeedUnit& unit;
    double coverage_factor = 2.0;
};

/// The rows of the budget, each with its figures, its share of the variance and what is shown.
nlohmann::ordered_json budget_json(const CertifiableWindow& window, const UncertaintyScale& scale);

/// What stands beneath the rows: combined and expanded uncertainty.
nlohmann::ordered_json budget_total_json(const CertifiableWindow& window,
                                         const UncertaintyScale& scale);

/// The Monte Carlo check beside what the law of propagation gives for the same interval, compared
/// as [GUM-S1] 8 asks: both within the numerical tolerance.
nlohmann::ordered_json monte_carlo_json(const CertifiableWindow& window,
                                        const UncertaintyScale& scale);

}  // namespace runcert
