#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motion/kalman.h"
#include "motion/noise_fit.h"
#include "schemas/profile/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// What is said of one row of the trajectory; empty where there is no value.
struct MethodEpoch {
    std::optional<Eigen::Vector2d> position_m = {};  ///< east, north
    std::optional<double> speed_m_s = {};            ///< horizontal
};

/// What one method says of every row of the trajectory.
struct MethodTrack {
    std::string name = {};
    /// How its figures make the speed of a window: displacement, or a mean of its speeds.
    SpeedDefinition window_speed = SpeedDefinition::displacement;
    std::vector<MethodEpoch> epochs = {};
    std::string unavailable = {};  ///< why the method has no value at all; else empty
};

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

/// A measured velocity (m/s) towards east, north and up, and its covariance.
struct MeasuredVelocity {
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2_s2 = Eigen::Matrix3d::Identity();
};

struct EnhancedKalmanState {
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity();
    /// Since the state before, over the time between; empty at the beginning.
    std::optional<Eigen::Vector3d> velocity_m_s = {};
};

/// The "enhanced Kalman filter" of [EKF] along an arc: its state is the position, its input the
/// measured velocity (one for each epoch), its measurement the position. The velocity it gives is
/// the backward difference of the filtered position, so that position and velocity agree exactly.
///
/// [EKF] has latitude, longitude and height as its state. East, north and up of the local frame
/// take their place, in which its equations are linear and positions, velocities and the speeds of
/// the other methods are given. Two slips of its printed equations fall away thereby. (18), (19)
/// have the equatorial radius in place of the meridian's, and no cosine of the latitude: at
/// latitude 35 degrees that is 0.34 % of the speed north and 18 % of the speed east. (25), (26)
/// divide by the radius where they must multiply.
///
/// Over a step the input is the mean of the velocities measured at its ends, the one there is where
/// one is missing; its error is taken to be the same over the whole step, so it adds covariance *
/// dt^2. Where neither is there the filter begins anew at the next measured position. Times must
/// increase. Empty before the first position.
std::vector<std::optional<EnhancedKalmanState>> filter_enhanced_kalman(
    std::span<const ArcEpoch<3>> arc, std::span<const std::optional<MeasuredVelocity>> velocities);

}  // namespace runcert
