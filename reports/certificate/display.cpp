#include "reports/certificate/display.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/text.h"
#include "files/yaml_output.h"

namespace runcert {
namespace {

std::string without_letters(std::string iso) {
    if (iso.ends_with('Z')) iso.pop_back();
    if (const std::size_t letter = iso.find('T'); letter != std::string::npos) iso[letter] = ' ';
    return iso;
}

}  // namespace

const std::array<SpeedUnit, 4>& speed_units() {
    static constexpr std::array<SpeedUnit, 4> units{{{"km_h", "km/h", 3.6, 2, 4},
                                                     {"m_s", "m/s", 1.0, 3, 6},
                                                     {"knots", "kn", 3600.0 / 1852.0, 2, 4},
                                                     {"mph", "mph", 3600.0 / 1609.344, 2, 4}}};
    return units;
}

const SpeedUnit& speed_unit(std::string_view name) {
    if (name.empty()) return speed_units()[0];
    for (const SpeedUnit& unit : speed_units())
        if (unit.name == name) return unit;
    throw Failure("unit of speed", fmt::format("\"{}\" is not known", name),
                  "Use km/h, m/s, kn or mph");
}

std::string uncertainty_text(double uncertainty) {
    return format_fixed(uncertainty, uncertainty_decimals(uncertainty));
}

std::string significant_text(double value, int digits) {
    if (value == 0.0) return "0";
    if (std::abs(value) < 1e-6) return scientific_text(value);
    // The exponent after rounding: 9.96 with two digits is 10.
    const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
    const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
    return format_fixed(value, std::max(0, digits - 1 - exponent));
}

std::string plain_text(double value) {
    return fmt::format("{:.9g}", value);
}

std::string quantity_text(double value, std::optional<double> expanded_uncertainty) {
    if (!expanded_uncertainty || !(*expanded_uncertainty > 0.0))
        return value != 0.0 && std::abs(value) < 1e-4 ? significant_text(value, 4)
                                                      : fmt::format("{:.6g}", value);
    return fmt::format("{} ± {}", format_fixed(value, uncertainty_decimals(*expanded_uncertainty)),
                       uncertainty_text(*expanded_uncertainty));
}

std::string coverage_text(double coverage_factor) {
    return fmt::format("{}", rounded(coverage_factor, 2));
}

std::string speed_text(double speed_m_s, std::optional<double> uncertainty_m_s,
                       const SpeedUnit& unit) {
    int decimals = unit.decimals;
    if (uncertainty_m_s)
        decimals = std::max(decimals, uncertainty_decimals(*uncertainty_m_s * unit.per_m_s));
    return format_fixed(speed_m_s * unit.per_m_s, decimals);
}

std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit) {
    return fmt::format("{} ± {} {}", speed_text(speed_m_s, expanded_uncertainty_m_s, unit),
                       uncertainty_text(expanded_uncertainty_m_s * unit.per_m_s), unit.name);
}

std::string seconds_text(ElapsedTime time) {
    return format_fixed(time.seconds(), 3) + " s";
}

std::string utc_text(GpsTime time) {
    return without_letters(to_utc_iso(time, 3));
}

std::string gps_text(GpsTime time) {
    return without_letters(to_iso(time, 3));
}

std::string scientific_text(double value) {
    return fmt::format("{:.1e}", value);
}

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
