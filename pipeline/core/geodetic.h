#pragma once

#include "core/angle.h"

namespace runcert {

/// A position on or near the WGS 84 ellipsoid: geodetic latitude (north positive), longitude (east
/// positive) and ellipsoidal height (m), not above the geoid. Holds any values; functions that take
/// one check it.
struct Geodetic {
    Angle latitude;
    Angle longitude;
    double height_m = 0.0;
};

/// A zone of the Universal Transverse Mercator projection. `northern` selects the false northing:
/// 0, or 10 000 km in the south. The functions of core/geodesy.h that use a zone, such as
/// `geodetic_from_utm`, check it.
struct UtmZone {
    int zone = 1;  ///< 1 to 60; its central meridian is at 6 zone - 183 degrees
    bool northern = true;
};

}  // namespace runcert
