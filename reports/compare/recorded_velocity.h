#pragma once

#include "reports/compare/methods.h"

namespace runcert {

/// The horizontal speed (m/s, over east and north) that the receiver recorded, at the epochs of the
/// arcs; none at an epoch without a recorded velocity.
MethodTrack recorded_speed(const ScreenedTable& screened);

/// The filter of [EKF] over the arcs, and what was taken for the accuracy of the recorded velocity
/// where the recording does not state it. Needs velocities, and geodetic coordinates. Heights
/// that were not measured are those of the frame's plane.
struct EnhancedKalmanTrack {
    MethodTrack track;
    std::string note;  ///< empty where there is nothing to say
};
EnhancedKalmanTrack enhanced_kalman_track(const ScreenedTable& screened);

}  // namespace runcert
