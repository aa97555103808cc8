#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/report_data.h"

namespace runcert {

/// Where the uncertainty of a measured speed comes from: what the fitted noise alone and the
/// robust estimate say, the bound on time-correlated errors, the choice of the fastest window, the
/// budget and its Monte Carlo check. Speeds as shown are in the rule's unit.
nlohmann::ordered_json uncertainty_json(const ProfileVerdict& verdict,
                                        const ProfileWindows& windows, const Profile& profile);

}  // namespace runcert
