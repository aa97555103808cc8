#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion/epoch_motion.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// Position (m), velocity (m/s) and acceleration (m/s^2) of a receiver at an epoch inside an arc,
/// as east, north and up. Up is 0 where heights were not measured.
struct TrackEpoch {
    double time_s = 0.0;
    std::int64_t stretch = 0;  ///< number of its arc
    bool usable = false;
    bool has_height = false;
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration_m_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d variance_m2 = Eigen::Vector3d::Zero();  ///< of the position
};

/// A receiver's motion with its frame and time, for comparison with a witness or to make one.
struct Track {
    std::optional<GpsTime> first_epoch;
    std::optional<FrameOrigin> origin;
    double nominal_interval_s = 0.0;
    std::vector<TrackEpoch> epochs;  ///< in order of time
};

/// The epoch of the track nearest to a time. Null if none is within 0.6 nominal intervals.
const TrackEpoch* epoch_near(const Track& track, double time_s);

/// The track of the smoothed trajectory.
Track track_of(const TrajectoryTable& trajectory);

/// The track as screening sees it: usable positions as measured, with the motion estimated from
/// them. `motion` has one entry for each row.
Track track_of(const ScreenedTable& screened, const Motion& motion);

}  // namespace runcert
