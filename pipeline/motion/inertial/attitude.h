#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geodesy.h"

namespace runcert {

/// Attitude of a body whose axes point forward, right and down, in a frame of east, north and up.
///
/// A rotation `enu_from_body` takes components along the body's axes to components along east,
/// north and up, so that its columns are the body's axes. Every function here works on rotations to
/// rounding.
///
/// [FHB03] describes attitude with a vehicle whose axes point right, ahead and up:
/// C_v^n = Rz(-heading) Rx(pitch) Ry(roll), in active rotations. Its axes are the body's in another
/// order, `vehicle_from_body`.

/// Angles in radians.
struct EulerAngles {
    double roll = 0.0;     ///< right side down is positive; -pi to pi
    double pitch = 0.0;    ///< nose up is positive; -pi/2 to pi/2
    double heading = 0.0;  ///< clockwise from north; 0 to below 2 pi
};

/// The matrix between forward, right, down and right, ahead, up: both ways, since it is symmetric.
Eigen::Matrix3d vehicle_from_body();

/// The rotation of these angles.
Eigen::Matrix3d rotation_of(const EulerAngles& angles);

/// The angles of a rotation. Within 1e-6 rad of a pitch of 90 degrees roll and heading lose their
/// meaning; their combination is kept.
EulerAngles euler_angles(const Eigen::Matrix3d& enu_from_body);

/// d(roll, pitch, heading) / d(phi), where exp([phi]) enu_from_body is the turned attitude and phi
/// (rad) has components along east, north and up. Undefined at a pitch of 90 degrees.
Eigen::Matrix3d euler_jacobian(const Eigen::Matrix3d& enu_from_body);

/// Covariance (rad^2) of phi as above for independent errors of roll, pitch and heading with these
/// standard deviations (rad).
Eigen::Matrix3d attitude_covariance(const Eigen::Matrix3d& enu_from_body, const EulerAngles& sigma);

/// The matrix [a] of the vector product: [a] b = a x b.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a);

/// exp([phi]): the rotation about phi by its length (rad).
Eigen::Matrix3d rotation_about(const Eigen::Vector3d& phi);

/// The phi with exp([phi]) = rotation, of length at most pi.
Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation);

/// The rotation nearest to a matrix in the Frobenius norm: U diag(1, 1, det(U V')) V' of its
/// singular value decomposition. A sum of rotations gives their mean.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

/// The unit quaternion of a rotation, its scalar not negative.
Eigen::Quaterniond quaternion_of(const Eigen::Matrix3d& rotation);

/// The attitude against the Earth-fixed frame (`Ecef`), of one against the frame at an origin.
Eigen::Matrix3d ecef_from_body(const Geodetic& origin, const Eigen::Matrix3d& enu_from_body);

}  // namespace runcert
