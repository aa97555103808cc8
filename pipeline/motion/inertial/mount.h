#pragma once

#include <Eigen/Core>

#include "inertial/inertial_smoother.h"

namespace runcert {

/// Epochs from which the mount is taken.
struct MountGate {
    double least_speed_m_s = 5.0;
    double most_lateral_m_s2 = 0.5;  ///< on a banked course 4.9: there the body leans
};

/// How an IMU sits in its craft.
struct MountEstimate {
    Eigen::Matrix3d craft_from_body = Eigen::Matrix3d::Identity();  ///< forward, right, down both
    EulerAngles angles = {};  ///< rad, of `craft_from_body`, as an attitude's
    /// Scatter (rad) of single epochs about the mean, along the craft's axes, of those kept.
    Eigen::Vector3d scatter_rad = Eigen::Vector3d::Zero();
    std::size_t epochs = 0;  ///< that the gate lets through
    std::size_t kept = 0;
};

/// The mount by the course: at each epoch of the gate, the craft's forward axis is taken to lie
/// along the velocity and its right axis to be level. The mean of the rotations leaves out, axis by
/// axis, what lies beyond 3 x 1.4826 median absolute deviations, until the set stays (ten times at
/// most).
///
/// Yaw and pitch of the mount so include the craft's mean side slip and the mean slope; roll is
/// that against the level, which is the mount's only if the craft does not lean. They are good to a
/// few tenths of a degree, whatever the standard error. Nothing where fewer than ten epochs are
/// kept.
std::optional<MountEstimate> estimate_mount(const InertialSolution& solution,
                                            const MountGate& gate);

}  // namespace runcert
