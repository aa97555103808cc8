#include "core/geodesy.h"

#include <fmt/format.h>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Math.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <cmath>

#include "core/failure.h"

namespace runcert {

namespace {

const GeographicLib::Geocentric& wgs84() {
    return GeographicLib::Geocentric::WGS84();
}

void require_finite(const Eigen::Vector3d& m) {
    if (!m.allFinite())
        throw Failure("position", "a coordinate is not a finite number",
                      "Check the position's coordinates");
}

constexpr double false_easting_m = 500e3;

double false_northing_m(UtmZone zone) {
    return zone.northern ? 0.0 : 10'000e3;
}

double central_meridian_deg(UtmZone zone) {
    return 6.0 * zone.zone - 183.0;
}

void require_valid_zone(UtmZone zone) {
    if (zone.zone < 1 || zone.zone > 60)
        throw Failure("UTM position", fmt::format("the zone {} is not 1 to 60", zone.zone),
                      "Give the number of a UTM zone");
}

void require_valid_utm(UtmZone zone, double easting_m, double northing_m) {
    require_valid_zone(zone);
    // Written so that NaN fails too.
    if (!(easting_m >= 100e3 && easting_m <= 900e3))
        throw Failure("UTM position",
                      fmt::format("the easting {} m is not 100 000 to 900 000 m", easting_m),
                      "Check the easting, its unit, and that easting and northing are not swapped");
    const double from_equator_m = northing_m - false_northing_m(zone);
    const double into_hemisphere_m = zone.northern ? from_equator_m : -from_equator_m;
    if (!(into_hemisphere_m >= -100e3 && into_hemisphere_m <= 9600e3))
        throw Failure("UTM position",
                      fmt::format("the northing {} m is outside the {} hemisphere", northing_m,
                                  zone.northern ? "northern" : "southern"),
                      "Check the northing, its unit and the hemisphere");
}

struct InverseUtm {
    double latitude_deg;
    double longitude_deg;
    double convergence_deg;
    double scale;
};

InverseUtm inverse_utm(UtmZone zone, double easting_m, double northing_m) {
    require_valid_utm(zone, easting_m, northing_m);
    InverseUtm r{};
    GeographicLib::TransverseMercator::UTM().Reverse(
        central_meridian_deg(zone), easting_m - false_easting_m,
        northing_m - false_northing_m(zone), r.latitude_deg, r.longitude_deg, r.convergence_deg,
        r.scale);
    return r;
}

}  // namespace

void require_valid(const Geodetic& position) {
    const double latitude_deg = position.latitude.degrees();
    const double longitude_deg = position.longitude.degrees();
    if (!(std::abs(latitude_deg) <= 90.0))
        throw Failure("position",
                      fmt::format("the latitude {} is not -90 to 90 degrees", latitude_deg),
                      "Check that latitude and longitude are in degrees and not swapped");
    if (!(std::abs(longitude_deg) <= 360.0))
        throw Failure("position",
                      fmt::format("the longitude {} is not -360 to 360 degrees", longitude_deg),
                      "Check that latitude and longitude are in degrees");
    if (!std::isfinite(position.height_m))
        throw Failure("position", "the height is not a finite number", "Check the height");
}

Ecef ecef_from_geodetic(const Geodetic& position) {
    require_valid(position);
    Ecef ecef;
    wgs84().Forward(position.latitude.degrees(), position.longitude.degrees(), position.height_m,
                    ecef.m.x(), ecef.m.y(), ecef.m.z());
    return ecef;
}

Geodetic geodetic_from_ecef(const Ecef& position) {
    require_finite(position.m);
    double latitude_deg = 0.0;
    double longitude_deg = 0.0;
    double height_m = 0.0;
    wgs84().Reverse(position.m.x(), position.m.y(), position.m.z(), latitude_deg, longitude_deg,
                    height_m);
    return {Angle::from_degrees(latitude_deg), Angle::from_degrees(longitude_deg), height_m};
}

Eigen::Matrix3d rotation_enu_from_ecef(Angle latitude, Angle longitude) {
    require_valid({latitude, longitude, 0.0});
    double sin_lat = 0.0;
    double cos_lat = 0.0;
    double sin_lon = 0.0;
    double cos_lon = 0.0;
    GeographicLib::Math::sincosd(latitude.degrees(), sin_lat, cos_lat);
    GeographicLib::Math::sincosd(longitude.degrees(), sin_lon, cos_lon);
    Eigen::Matrix3d rotation;
    rotation << -sin_lon, cos_lon, 0.0,                   //
        -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat,  //
        cos_lat * cos_lon, cos_lat * sin_lon, sin_lat;
    return rotation;
}

LocalFrame::LocalFrame(const Geodetic& origin)
    : origin_(origin),
      origin_ecef_m_(ecef_from_geodetic(origin).m),
      rotation_enu_from_ecef_(runcert::rotation_enu_from_ecef(origin.latitude, origin.longitude)) {}

Enu LocalFrame::enu_from_geodetic(const Geodetic& position) const {
    return enu_from_ecef(ecef_from_geodetic(position));
}

Enu LocalFrame::enu_from_ecef(const Ecef& position) const {
    require_finite(position.m);
    return {rotation_enu_from_ecef_ * (position.m - origin_ecef_m_)};
}

Ecef LocalFrame::ecef_from_enu(const Enu& position) const {
    return {origin_ecef_m_ + rotation_enu_from_ecef_.transpose() * position.m};
}

Geodetic LocalFrame::geodetic_from_enu(const Enu& position) const {
    return geodetic_from_ecef(ecef_from_enu(position));
}

Eigen::Matrix3d LocalFrame::rotation_from_local(Angle latitude, Angle longitude) const {
    return rotation_enu_from_ecef_ *
           runcert::rotation_enu_from_ecef(latitude, longitude).transpose();
}

Geodetic geodetic_from_utm(UtmZone zone, double easting_m, double northing_m, double height_m) {
    const InverseUtm r = inverse_utm(zone, easting_m, northing_m);
    const Geodetic position{Angle::from_degrees(r.latitude_deg),
                            Angle::from_degrees(r.longitude_deg), height_m};
    require_valid(position);
    return position;
}

UtmCoordinates utm_from_geodetic(UtmZone zone, const Geodetic& position) {
    require_valid_zone(zone);
    require_valid(position);
    UtmCoordinates utm;
    GeographicLib::TransverseMercator::UTM().Forward(
        central_meridian_deg(zone), position.latitude.degrees(), position.longitude.degrees(),
        utm.easting_m, utm.northing_m);
    utm.easting_m += false_easting_m;
    utm.northing_m += false_northing_m(zone);
    require_valid_utm(zone, utm.easting_m, utm.northing_m);
    return utm;
}

UtmGeometry utm_geometry(UtmZone zone, double easting_m, double northing_m) {
    const InverseUtm r = inverse_utm(zone, easting_m, northing_m);
    return {r.scale, Angle::from_degrees(r.convergence_deg)};
}

}  // namespace runcert
