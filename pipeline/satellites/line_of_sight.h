#pragma once

#include <Eigen/Core>

#include "core/geodesy.h"

namespace runcert {

/// The position of a receiver and its local axes.
struct ReceiverPosition {
    Eigen::Vector3d position_m;     ///< WGS 84, Earth-centred
    Eigen::Matrix3d enu_from_ecef;  ///< rows: east, north, up
    double height_m = 0.0;          ///< ellipsoidal height
};

/// The place with these WGS 84 Earth-centred coordinates (m). Failure if one is not finite.
ReceiverPosition receiver_position(const Eigen::Vector3d& position_m);

/// A satellite as a receiver sees it.
struct LineOfSight {
    Eigen::Vector3d direction;  ///< unit vector from the receiver
    double range_m = 0.0;
    double sine_of_elevation = 0.0;
};

/// The line of sight to a satellite whose position is given in the Earth-fixed frame at
/// transmission. The position is rotated into the frame at reception by the Earth's rotation during
/// the signal's travel ([IS-GPS-200] 20.3.3.4.3.3.2), to better than a nanometre.
LineOfSight line_of_sight(const Eigen::Vector3d& satellite_m, const ReceiverPosition& receiver);

}  // namespace runcert
