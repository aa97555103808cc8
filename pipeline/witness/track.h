#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/epoch_motion.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// Where a receiver was, and how it moved, at an epoch inside an arc: m, m/s, m/s^2, towards east,
/// north and up. Where heights were not measured, up is 0.
struct TrackEpoch {
    double time_s = 0.0;
    std::int64_t stretch = 0;  ///< ends with an arc and at a step
    bool usable = false;
    bool has_height = false;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_m_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d variance_m2 = Eigen::Vector3d::Zero();  ///< of the position
};

/// A receiver's way with the frame and the time that it is given in: what a witness is related to,
/// or made of.
struct Track {
    std::optional<GpsTime> first_epoch;
    std::optional<FrameOrigin> origin;
    double nominal_interval_s = 0.0;
    std::vector<TrackEpoch> epochs;  ///< in order of time
};

/// The epoch of the track nearest to a time; null where none is near.
const TrackEpoch* epoch_near(const Track& track, double time_s);

/// The smoothed track.
Track track_of(const TrajectoryTable& trajectory);

/// The track as screening has it: usable positions as measured, with the motion that is estimated
/// beside them. `motion` has one entry for each row.
Track track_of(const ScreenedTable& screened, const Motion& motion);

}  // namespace runcert
