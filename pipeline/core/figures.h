#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/gps_time.h"
#include "core/prose.h"
#include "core/rounding.h"

// Figures and units as people read them: the one place that writes them. A measured speed is
// rounded down, an expanded uncertainty, a required speed and an acceptance limit up, so that what
// is shown never claims more than what was computed (`SpeedKind`).

namespace runcert {

/// A unit in which speeds are given.
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

/// A standard uncertainty or another small size, rounded to two significant digits: "0.018".
std::string uncertainty_text(double uncertainty);

/// So many significant digits: "0.00058", "-72.0", "4100"; "0"; below 1e-6 as scientific_text;
/// "not determined" of what is no finite number.
std::string significant_text(double value, int digits);

/// A figure in its shortest form, with its unit where it has one: "202.9", "1000 m".
std::string number_text(double value, std::string_view unit = {});

/// A quantity with its expanded uncertainty, rounded up to two significant digits, and the unit
/// with both: "0.42 m ± 0.08 m"; without an uncertainty with six significant digits at most.
std::string quantity_text(double value, std::optional<double> expanded_uncertainty = std::nullopt,
                          std::string_view unit = {});

/// A coverage factor with at most two decimals: "2", "2.07".
std::string coverage_text(double coverage_factor);

/// A speed that is not the measured one, rounded to the nearest, with the decimals usual for its
/// unit or, where these are more, those of its uncertainty: "216.009".
std::string speed_text(double speed_m_s, std::optional<double> uncertainty_m_s,
                       const SpeedUnit& unit);

/// What a speed that is shown is. It decides to which side it is rounded.
enum class SpeedKind {
    measured,     ///< down
    uncertainty,  ///< up: an expanded uncertainty, a guard band
    required,     ///< up
    limit,        ///< up: an acceptance limit
    plain         ///< to the nearest: a record, a current
};

/// Files keep speeds to 0.000001 m/s. A speed is shown as it is kept, so that it is the same
/// wherever it is shown; and one this near to a decimal figure of any unit counts as that figure:
/// 124.666667 m/s is 448.8000012 km/h, and 448.8 km/h was meant.
inline constexpr int speed_decimals_kept = 6;
inline constexpr double speed_guard_m_s = 0.6e-6;

/// A speed (m/s) as files keep it; one that is not finite as it is.
double speed_as_kept_m_s(double speed_m_s);

/// A speed in a unit, with so many decimals. The one table by which speeds are rounded. Failure (at
/// "rounding") for one that is not finite.
std::string shown_speed(SpeedKind kind, double speed_m_s, int decimals, const SpeedUnit& unit);

/// How many decimals a figure is written with.
int decimals_in(std::string_view figure);

/// One shown figure less another, with the decimals of the finer one: "0.05". A difference that is
/// shown is that of what is shown.
std::string shown_difference(std::string_view figure, std::string_view less);

/// What one shown figure is more than another, with its sign: "+0.02", "0.00".
std::string signed_difference(std::string_view figure, std::string_view less,
                              std::optional<int> decimals = std::nullopt);

/// "2022-03-18 08:51:04.300" of a GPS time, in UTC.
std::string utc_text(GpsTime time);

/// The same instant on the GPS time scale.
std::string gps_text(GpsTime time);

/// A time as people say it, without an exponent however long: "3 s", "1.9 s", "1210 s".
std::string time_span_text(double duration_s);

/// "4.1e-09": two significant digits of a small figure.
std::string scientific_text(double value);

/// "at 14:03:22.1 UTC".
std::string time_of_day_text(GpsTime time);

/// Whether a day, "2026-03-14", begins after an instant wherever on the Earth it is.
bool begins_after(const std::string& day, GpsTime instant);

}  // namespace runcert
