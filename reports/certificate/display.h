#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "core/prose.h"
#include "core/rounding.h"
#include "schemas/common/table.h"

namespace runcert {

/// A unit in which the report gives speeds.
struct SpeedUnit {
    std::string_view key;   ///< in the names of fields: "km_h"
    std::string_view name;  ///< as written: "km/h"
    double per_m_s = 1.0;   ///< so many of it are 1 m/s
    int decimals = 2;       ///< of a speed that is shown
    int decimals_kept = 4;  ///< of a speed in the report's fields
};

/// km/h, m/s, kn, mph (knot 1852 m/h, statute mile 1609.344 m, both exact).
const std::array<SpeedUnit, 4>& speed_units();

/// The one of that name ("km/h"), km/h where it is empty. Failure where it is not known.
const SpeedUnit& speed_unit(std::string_view name);

/// An uncertainty with two significant digits, "0.018".
std::string uncertainty_text(double uncertainty);

/// A figure with so many significant digits: "0.00058", "-72.0", "4100"; "0" for zero. Below 1e-6
/// as scientific_text writes it.
std::string significant_text(double value, int digits);

/// A figure in its shortest form: "202.9", "1000".
std::string plain_text(double value);

/// A quantity with its expanded uncertainty, decimals being those of two significant digits of
/// that: "0.42 ± 0.08"; without one with six significant digits at most.
std::string quantity_text(double value, std::optional<double> expanded_uncertainty);

/// A coverage factor with at most two decimals: "2", "2.07".
std::string coverage_text(double coverage_factor);

/// A speed with the decimals usual for its unit, or those of its uncertainty where these are more.
std::string speed_text(double speed_m_s, std::optional<double> uncertainty_m_s,
                       const SpeedUnit& unit);

/// "216.009 ± 0.018 km/h".
std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit);

/// "20.100 s": three decimals.
std::string seconds_text(ElapsedTime time);

/// "2022-03-18 08:51:04.300" of a GPS time, in UTC.
std::string utc_text(GpsTime time);
/// The same instant on the GPS time scale.
std::string gps_text(GpsTime time);

/// "4.1e-09": two significant digits of a small figure.
std::string scientific_text(double value);

/// A label and a text, the element of every list of facts.
nlohmann::ordered_json fact(std::string_view label, std::string value);

/// Sets `name_km_h`, `name_m_s`, `name_knots`, `name_mph` where there is a speed.
void set_speeds(nlohmann::ordered_json& json, const std::string& name,
                const std::optional<double>& speed_m_s);

}  // namespace runcert
