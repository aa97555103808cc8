#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/angle.h"
#include "core/geodesy.h"

namespace runcert {

/// Radii of curvature of the WGS 84 ellipsoid, m.
struct RadiiOfCurvature {
    double meridian_m = 0.0;        ///< M, along the meridian
    double prime_vertical_m = 0.0;  ///< N, along the prime vertical
};
RadiiOfCurvature radii_of_curvature(Angle latitude);

/// The position a short way off: `enu_m` east, north and up along the ellipsoid. M and N are those
/// halfway. Not within the step's length of a pole.
Geodetic moved_by(const Geodetic& from, const Eigen::Vector3d& enu_m);

/// East, north, up (m) from one position to another nearby: the inverse of `moved_by`, to 1e-11 of
/// steps up to 100 m and the rounding of degrees (1 nm).
Eigen::Vector3d step_between(const Geodetic& from, const Geodetic& to);

/// A measured position and the covariance (m^2) of its error towards east, north, up there.
struct MeasuredGeodetic {
    Geodetic position;
    Eigen::Matrix3d covariance_enu_m2 = Eigen::Matrix3d::Identity();
};

/// A measured velocity (m/s) towards east, north, up of the place, and its covariance.
struct MeasuredVelocity {
    Eigen::Vector3d enu_m_s = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_m2_s2 = Eigen::Matrix3d::Identity();
};

struct EnhancedKalmanEpoch {
    double time_s = 0.0;
    std::optional<MeasuredGeodetic> position;
    std::optional<MeasuredVelocity> velocity;
};

struct EnhancedKalmanState {
    Geodetic position;
    Eigen::Matrix3d covariance_enu_m2 = Eigen::Matrix3d::Identity();
    /// East, north, up since the state before, over the time between; empty at the beginning.
    std::optional<Eigen::Vector3d> velocity_enu_m_s;
};

/// The "enhanced Kalman filter" of [EKF]: its state is latitude, longitude and height, its input
/// the measured velocity, its measurement the position. The velocity it gives is the backward
/// difference of the filtered position, so that position and velocity agree exactly.
///
///     d latitude / dt = vN / (M + h)          vN = (M + h) d latitude / dt
///     d longitude / dt = vE / ((N + h) cos latitude)    vE = (N + h) cos latitude d longitude / dt
///
/// Two slips of the printed equations are put right. (18), (19) have the equatorial radius in place
/// of M, and no cos latitude: at latitude 35 degrees that is 0.34 % of the speed north and 18 % of
/// the speed east. (25), (26) divide by the radius where they must multiply.
///
/// Over a step the input is the mean of the velocities measured at its ends, the one there is where
/// one is missing; its error is taken as the same all the step, so it adds covariance * dt^2. Where
/// neither is there the filter begins anew at the next measured position. Covariances are kept in
/// metres: what the radii change by within a step is less than 2e-5 of the error. Times must
/// increase. Empty before the first position.
std::vector<std::optional<EnhancedKalmanState>> filter_enhanced_kalman(
    std::span<const EnhancedKalmanEpoch> epochs);

}  // namespace runcert
