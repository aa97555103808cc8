#include "satellites/line_of_sight.h"

#include <cmath>

#include "core/satellite.h"
#include "satellites/ephemeris.h"

namespace runcert {

ReceiverPosition receiver_position(const Eigen::Vector3d& position_m) {
    const Geodetic geodetic = geodetic_from_ecef({position_m});
    return {.position_m = position_m,
            .enu_from_ecef = rotation_enu_from_ecef(geodetic.latitude, geodetic.longitude),
            .height_m = geodetic.height_m};
}

LineOfSight line_of_sight(const Eigen::Vector3d& satellite_m, const ReceiverPosition& receiver) {
    LineOfSight sight;
    Eigen::Vector3d apart_m = satellite_m - receiver.position_m;
    double range_m = apart_m.norm();
    // The angle is below 1e-5: its square matters, its cube does not.
    for (int step = 0; step < 3; ++step) {
        const double angle = earth_rotation_rad_s * range_m / speed_of_light_m_s;
        const double cosine = 1.0 - 0.5 * angle * angle;
        apart_m.x() = satellite_m.x() * cosine + satellite_m.y() * angle - receiver.position_m.x();
        apart_m.y() = satellite_m.y() * cosine - satellite_m.x() * angle - receiver.position_m.y();
        range_m = apart_m.norm();
    }
    sight.range_m = range_m;
    sight.direction = apart_m / range_m;
    sight.sine_of_elevation = receiver.enu_from_ecef.row(2).dot(sight.direction);
    return sight;
}

}  // namespace runcert
