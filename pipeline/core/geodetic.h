#pragma once

#include "core/angle.h"

namespace runcert {

/// A position on or near the WGS 84 ellipsoid: geodetic latitude (north positive), longitude
/// (east positive) and height above the ellipsoid (m), not above the geoid. Holds any values: what
/// takes one checks it.
struct Geodetic {
    Angle latitude;
    Angle longitude;
    double height_m = 0.0;
};

/// A zone of the Universal Transverse Mercator projection. `northern` says which false northing
/// is used: 0, or 10 000 km in the south. The zone is checked where it is used, by
/// `geodetic_from_utm` and its like in core/geodesy.h.
struct UtmZone {
    int zone = 1;  ///< 1 to 60; its central meridian is at 6 zone - 183 degrees
    bool northern = true;
};

}  // namespace runcert
