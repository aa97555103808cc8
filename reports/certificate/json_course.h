#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "reports/certificate/report_data.h"

namespace runcert {

/// Quantities with their uncertainties, each with its text as shown.
nlohmann::ordered_json quantities_json(const std::vector<Figure>& figures);

/// Sets course and craft, and the runs of the craft. Nothing where the verdict says nothing.
void set_course(nlohmann::ordered_json& json, const ProfileVerdict& verdict,
                const Profile& profile);

}  // namespace runcert
