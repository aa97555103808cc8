#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "motion/noise_fit.h"
#include "schemas/profile/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// What one method says of every row of the trajectory. Both lists have a place for each row;
/// empty where the method has no value.
struct MethodTrack {
    std::string name;
    /// How its figures make the speed of a window: displacement, or a mean of its speeds.
    SpeedDefinition window_speed = SpeedDefinition::displacement;
    std::vector<std::optional<Eigen::Vector2d>> positions;  ///< east, north, m
    std::vector<std::optional<double>> speeds_m_s;          ///< horizontal
    std::string unavailable;  ///< why the method has no value at all; else empty
};

/// One that has no value at any of so many rows yet.
MethodTrack empty_track(const std::string& name, SpeedDefinition window_speed, std::size_t rows);

/// The methods, and what is to be said of them, a sentence a line.
struct Methods {
    std::vector<MethodTrack> tracks;
    std::vector<std::string> notes;
};

/// What the comparison is made with; `parameters.smooth` and `parameters.window` of the attempt.
struct CompareConfig {
    NoiseFitOptions fit;  ///< its `motion` says what the trajectory was asked to use
    double duration_tolerance_s = 0.0;
};

/// Every estimator on the same screened epochs: raw positions, v1, v2 and the filter of [DHD22],
/// the fixed-lag smoother [YSM22] at lags of 0.5 s, 1 s, 2 s and a whole arc, the smoother with
/// persistent and with Singer acceleration (each with noise fitted for it), the trajectory's
/// smoother, its batch, its robust solution, and where the recording has velocities these and the
/// filter of [EKF]. The trajectory's own model is that of the fixed lags.
///
/// Failure where the trajectory does not say what noise it was estimated with.
Methods methods_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                   const CompareConfig& config);

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
