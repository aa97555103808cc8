#pragma once

namespace runcert {

/// Mean radius of the Earth (m), for corrections that need it to a percent.
inline constexpr double earth_mean_radius_m = 6.371e6;

/// By how much (m) the Earth has fallen away, at these coordinates (m), below the plane that touches
/// it at their origin. Second order: good to 0.6 %, 5 cm at 10 km.
constexpr double fall_below_plane_m(double east_m, double north_m) {
    return (east_m * east_m + north_m * north_m) / (2.0 * earth_mean_radius_m);
}

}  // namespace runcert
