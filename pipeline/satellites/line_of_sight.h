#pragma once

#include <Eigen/Core>

#include "core/geodesy.h"

namespace runcert {

/// Where a receiver is, and which way is up there.
struct ReceiverPlace {
    Eigen::Vector3d position_m;     ///< WGS 84, Earth-centred
    Eigen::Matrix3d enu_from_ecef;  ///< rows: east, north, up
    double height_m = 0.0;          ///< above the ellipsoid
};

/// The place of Earth-centred coordinates. Failure where one is not finite.
ReceiverPlace receiver_place(const Eigen::Vector3d& position_m);

/// A satellite as a receiver sees it.
struct LineOfSight {
    Eigen::Vector3d direction;  ///< from the receiver, of length 1
    double range_m = 0.0;
    double sine_of_elevation = 0.0;
};

/// The line of sight to a satellite whose position is given in the Earth's frame at transmission:
/// turned by the Earth's rotation during the travel into the frame of reception ([IS-GPS-200]
/// 20.3.3.4.3.3.2), to better than a nanometre.
LineOfSight line_of_sight(const Eigen::Vector3d& satellite_m, const ReceiverPlace& place);

}  // namespace runcert
