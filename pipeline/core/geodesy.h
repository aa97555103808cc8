#pragma once

#include <Eigen/Core>

#include "core/geodetic.h"

namespace runcert {

/// Earth-centred, Earth-fixed WGS 84 coordinates, metres.
struct Ecef {
    Eigen::Vector3d m;
};

/// East, north, up of a local frame, metres.
struct Enu {
    Eigen::Vector3d m;
};

/// Failure (at "position") where the latitude is outside +-90 degrees, the longitude outside
/// +-360 degrees, or any of the three is not a finite number.
void require_valid(const Geodetic& position);

/// Earth-centred coordinates of a position. Failure as `require_valid`. Rounding only, about 1 nm.
Ecef ecef_from_geodetic(const Geodetic& position);

/// The position of Earth-centred coordinates, longitude in [-180, 180] degrees. Failure where a
/// coordinate is not finite. Accurate to about 5 nm (GeographicLib::Geocentric, [Karney11]
/// app. B).
Geodetic geodetic_from_ecef(const Ecef& position);

/// The matrix that turns an Earth-centred vector into east, north, up of a place.
Eigen::Matrix3d rotation_enu_from_ecef(Angle latitude, Angle longitude);

/// The local Cartesian frame at an origin: x east, y north, z up along the ellipsoid's normal
/// there. A plane: at 20 km from the origin the ellipsoid lies about 31 m below it.
class LocalFrame {
  public:
    /// Failure as `require_valid`.
    explicit LocalFrame(const Geodetic& origin);

    /// Coordinates of a position in this frame. Failure as `require_valid`. Agrees with PROJ's
    /// `topocentric` to 0.00001 mm within 20 km.
    Enu enu_from_geodetic(const Geodetic& position) const;

    /// Coordinates of an Earth-centred position in this frame.
    Enu enu_from_ecef(const Ecef& position) const;

    /// Earth-centred coordinates of those of this frame.
    Ecef ecef_from_enu(const Enu& position) const;

    /// The position of coordinates in this frame. Failure where one is not finite.
    Geodetic geodetic_from_enu(const Enu& position) const;

    /// The matrix R that turns a vector given in east, north, up of the place (latitude,
    /// longitude) into this frame's own; a covariance turns by R C R'.
    Eigen::Matrix3d rotation_from_local(Angle latitude, Angle longitude) const;

    const Geodetic& origin() const { return origin_; }

  private:
    Geodetic origin_;
    Eigen::Vector3d origin_ecef_m_;
    Eigen::Matrix3d rotation_enu_from_ecef_;
};

struct UtmCoordinates {
    double easting_m = 0.0;
    double northing_m = 0.0;
};

/// What the projection does at a point: a short length on the ellipsoid times `scale` is the
/// length on the map; `convergence` is the bearing of grid north, clockwise from true north.
struct UtmGeometry {
    double scale = 1.0;
    Angle convergence;
};

/// The position of UTM coordinates (WGS 84). Failure where the zone is outside 1 to 60, the
/// easting outside 100 to 900 km, or the northing more than 9600 km from the equator or more than
/// 100 km on the other side of it. Accurate to 5 nm (GeographicLib, 6th order Krueger series).
Geodetic geodetic_from_utm(UtmZone zone, double easting_m, double northing_m, double height_m);

/// UTM coordinates of a position in the zone asked for, which need not be its own. Failure as
/// `geodetic_from_utm` and `require_valid`.
UtmCoordinates utm_from_geodetic(UtmZone zone, const Geodetic& position);

/// Point scale factor and meridian convergence at UTM coordinates. Failure as `geodetic_from_utm`.
UtmGeometry utm_geometry(UtmZone zone, double easting_m, double northing_m);

/// Mean radius of the Earth (m), for corrections that need it to a percent.
inline constexpr double earth_mean_radius_m = 6.371e6;

/// By how much (m) the Earth has fallen away, at these coordinates (m), below the plane that
/// touches it at their origin. Second order: good to 0.6 %, 5 cm at 10 km.
constexpr double fall_below_plane_m(double east_m, double north_m) {
    return (east_m * east_m + north_m * north_m) / (2.0 * earth_mean_radius_m);
}

}  // namespace runcert
