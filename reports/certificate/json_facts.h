#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "reports/words/figures.h"

namespace runcert {

/// A label and a text, the element of every list of facts.
nlohmann::ordered_json fact(std::string_view label, std::string value);

/// Sets `name_km_h`, `name_m_s`, `name_knots`, `name_mph` where there is a speed.
void set_speeds(nlohmann::ordered_json& json, const std::string& name,
                const std::optional<double>& speed_m_s);

}  // namespace runcert
