#include "core/course_angle.h"

#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/Rhumb.hpp>

#include "core/geodesy.h"

namespace runcert {
namespace {

/// GeographicLib's -180 to 180 degrees as 0 to below 360.
Angle from_north(double degrees) {
    const double positive = degrees < 0.0 ? degrees + 360.0 : degrees + 0.0;
    return Angle::from_degrees(positive >= 360.0 ? 0.0 : positive);
}

}  // namespace

std::optional<CourseAngles> course_angles(const Geodetic& from, const Geodetic& to) {
    require_valid(from);
    require_valid(to);
    constexpr double least_m = 1e-3;
    const double begin[]{from.latitude.degrees(), from.longitude.degrees()};
    const double end[]{to.latitude.degrees(), to.longitude.degrees()};
    CourseAngles angles;
    double loxodrome_deg = 0.0, geodesic_deg = 0.0, geodesic_end_deg = 0.0;
    GeographicLib::Geodesic::WGS84().Inverse(begin[0], begin[1], end[0], end[1], angles.geodesic_m,
                                             geodesic_deg, geodesic_end_deg);
    if (angles.geodesic_m < least_m) return std::nullopt;
    GeographicLib::Rhumb::WGS84().Inverse(begin[0], begin[1], end[0], end[1], angles.loxodrome_m,
                                          loxodrome_deg);
    angles.loxodrome = from_north(loxodrome_deg);
    angles.geodesic = from_north(geodesic_deg);
    angles.geodesic_end = from_north(geodesic_end_deg);
    return angles;
}

}  // namespace runcert
