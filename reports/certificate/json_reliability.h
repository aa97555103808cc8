#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/json_budget.h"
#include "reports/certificate/report_data.h"

namespace runcert {

/// Sets what errors that screening finds with less than its stated power could have changed the
/// speed by: `repaired_steps`, `detection_power`, `reliability`, and `reliability_shown`, the same
/// in words. Nothing where the window's file does not say it.
void set_reliability(nlohmann::ordered_json& json, const CertifiableWindow& window,
                     const UncertaintyScale& scale);

}  // namespace runcert
