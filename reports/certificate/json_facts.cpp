#include "reports/certificate/json_facts.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/rounding.h"

namespace runcert {

nlohmann::ordered_json fact(std::string_view label, std::string value) {
    return {{"label", label}, {"value", std::move(value)}};
}

void set_speeds(nlohmann::ordered_json& json, const std::string& name,
                const std::optional<double>& speed_m_s) {
    if (!speed_m_s) return;
    for (const SpeedUnit& unit : speed_units())
        json[fmt::format("{}_{}", name, unit.key)] =
            rounded(*speed_m_s * unit.per_m_s, unit.decimals_kept);
}

}  // namespace runcert
