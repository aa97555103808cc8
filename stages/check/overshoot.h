#pragma once

#include <cstdint>
#include <vector>

#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// Signs of a filter of the device in the smoothed motion: after a change of the acceleration along
/// the track it swings about where it settles, each swing a fraction of the one before, in the same
/// rhythm every time. A craft may do so once; a filter does it always.
struct Overshoot {
    std::int64_t changes = 0;  ///< of the acceleration, that were looked at
    std::int64_t swings = 0;   ///< of these, those after which it swings so
    double period_s = 0.0;     ///< median of the swings' periods; 0 without any
    double part = 0.0;         ///< median of the first swing's part of the change

    /// Two at least, and most of those looked at.
    bool found() const { return swings >= 2 && 2 * swings > changes; }
};

/// Looks at every change of the acceleration along the track by 1 m/s^2 or more, of which the last
/// three quarters take 4 s at most, where the craft is faster than 2 m/s. Linear.
Overshoot find_overshoot(const std::vector<TrajectoryEpoch>& rows);

}  // namespace runcert
