#pragma once

#include <string_view>

namespace runcert {

/// Exact, as are the units of speed (m/s) that follow from them.
inline constexpr double metres_per_nautical_mile = 1852.0;
inline constexpr double metres_per_statute_mile = 1609.344;
inline constexpr double km_h_in_m_s = 1000.0 / 3600.0;
inline constexpr double knot_in_m_s = metres_per_nautical_mile / 3600.0;
inline constexpr double mph_in_m_s = metres_per_statute_mile / 3600.0;

/// What a speed in m/s is multiplied by to be in km/h.
inline constexpr double km_h_per_m_s = 3.6;

/// The factor from "km/h", "m/s", "kn" or "mph" to metres per second. Failure for any other text.
double metres_per_second(std::string_view unit);

}  // namespace runcert
