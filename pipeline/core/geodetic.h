#pragma once

#include "core/angle.h"

namespace runcert {

/// A position on or near the WGS 84 ellipsoid: geodetic latitude (north positive), longitude
/// (east positive) and height above the ellipsoid.
struct Geodetic {
    Angle latitude;
    Angle longitude;
    double height_m = 0.0;
};

/// A zone of the Universal Transverse Mercator projection. `northern` says which false northing
/// is used: 0, or 10 000 km in the south.
struct UtmZone {
    int zone = 1;  ///< 1 to 60; its central meridian is at 6 zone - 183 degrees
    bool northern = true;
};

}  // namespace runcert
