#pragma once

#include <Eigen/Core>

#include "core/geodetic.h"

namespace runcert {

/// Earth-centred, Earth-fixed WGS 84 coordinates, metres.
struct Ecef {
    Eigen::Vector3d m;
};

/// East, north and up components in a local frame, metres.
struct Enu {
    Eigen::Vector3d m;
};

/// Checks geodetic coordinates. Failure (at "position") where the latitude is outside +-90 degrees,
/// the longitude is outside +-360 degrees, or one of the three coordinates is not finite.
void require_valid(const Geodetic& position);

/// Earth-centred coordinates of a position. Accurate to rounding, about 1 nm. Failure as for
/// `require_valid`.
Ecef ecef_from_geodetic(const Geodetic& position);

/// Geodetic coordinates of an Earth-centred position, with longitude in [-180, 180] degrees.
/// Accurate to about 5 nm (GeographicLib::Geocentric, [Karney11] app. B). Failure if a
/// coordinate is not finite.
Geodetic geodetic_from_ecef(const Ecef& position);

/// The matrix that rotates an Earth-centred vector into east, north and up at a place.
Eigen::Matrix3d rotation_enu_from_ecef(Angle latitude, Angle longitude);

/// The local Cartesian frame at an origin: x east, y north, z up along the ellipsoid's normal
/// there. Its horizontal plane does not follow the Earth: 20 km from the origin the ellipsoid lies
/// about 31 m below it.
class LocalFrame {
  public:
    /// Failure as for `require_valid`.
    explicit LocalFrame(const Geodetic& origin);

    /// Coordinates of a position in this frame. Agrees with PROJ's `topocentric` to 0.00001 mm
    /// within 20 km. Failure as for `require_valid`.
    Enu enu_from_geodetic(const Geodetic& position) const;

    /// Coordinates of an Earth-centred position in this frame.
    Enu enu_from_ecef(const Ecef& position) const;

    /// Earth-centred coordinates of a position in this frame.
    Ecef ecef_from_enu(const Enu& position) const;

    /// Geodetic coordinates of a position in this frame. Failure if a coordinate is not finite.
    Geodetic geodetic_from_enu(const Enu& position) const;

    /// The matrix R that rotates a vector from east, north and up at (latitude, longitude) into
    /// this frame. A covariance C becomes R C R'.
    Eigen::Matrix3d rotation_from_local(Angle latitude, Angle longitude) const;

    const Geodetic& origin() const { return origin_; }

  private:
    Geodetic origin_;
    Eigen::Vector3d origin_ecef_m_;
    Eigen::Matrix3d rotation_enu_from_ecef_;
};

/// Easting and northing (m) in a UTM zone, false origin included.
struct UtmCoordinates {
    double easting_m = 0.0;
    double northing_m = 0.0;
};

/// Distortion of the projection at a point. A short length on the ellipsoid times `scale` is the
/// length on the map. `convergence` is the bearing of grid north, clockwise from true north.
struct UtmGeometry {
    double scale = 1.0;
    Angle convergence;
};

/// Geodetic coordinates of a UTM position (WGS 84), to 5 nm (GeographicLib, 6th order Krueger
/// series). Failure if the zone is outside 1 to 60 or the easting outside 100 to 900 km. The
/// northing must lie within 9600 km of the equator, or within 100 km on the other side of it.
Geodetic geodetic_from_utm(UtmZone zone, double easting_m, double northing_m, double height_m);

/// UTM coordinates of a position in the given zone, which need not be the zone it lies in. Failure
/// as for `geodetic_from_utm` and `require_valid`.
UtmCoordinates utm_from_geodetic(UtmZone zone, const Geodetic& position);

/// Point scale factor and meridian convergence at UTM coordinates. Failure as for
/// `geodetic_from_utm`.
UtmGeometry utm_geometry(UtmZone zone, double easting_m, double northing_m);

/// Mean radius of the Earth (m), for corrections that need it to 1 %.
inline constexpr double earth_mean_radius_m = 6.371e6;

/// Distance (m) from a tangent plane down to the Earth's surface, at coordinates (m) from the point
/// of contact. Second order: good to 0.6 %, 5 cm at 10 km.
constexpr double fall_below_plane_m(double east_m, double north_m) {
    return (east_m * east_m + north_m * north_m) / (2.0 * earth_mean_radius_m);
}

}  // namespace runcert
