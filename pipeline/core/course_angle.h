#pragma once

#include <optional>

#include "core/geodetic.h"

namespace runcert {

/// Angles from north, clockwise, 0 to below 360 degrees, at which a way leads from one place to
/// another on the ellipsoid of WGS 84 ([NAV]). Heights do not count.
struct CourseAngles {
    Angle loxodrome;     ///< the same all along the line that crosses every meridian alike
    Angle geodesic;      ///< of the shortest line, where it begins
    Angle geodesic_end;  ///< and where it ends
    double loxodrome_m = 0.0;
    double geodesic_m = 0.0;
};

/// The shorter of the loxodromes and the geodesic between two places. Accurate to some 10 nm in
/// length (GeographicLib::Rhumb and Geodesic, [Karney11]). Nothing where they coincide to 1 mm.
/// Failure (at "position") as for `require_valid`.
std::optional<CourseAngles> course_angles(const Geodetic& from, const Geodetic& to);

}  // namespace runcert
