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
    /// Scatter (rad) of single epochs about the mean, along the craft's axes, of those retained.
    Eigen::Vector3d scatter_rad = Eigen::Vector3d::Zero();
    std::size_t epochs = 0;  ///< that the gate lets through
    std::size_t retained = 0;
};

/// The mount by velocity and ground: at each epoch of the gate the craft's attitude is that of
/// `attitude_on_surface`. Without normals its right axis is taken to be level. `normals` has one of
/// the surface for each epoch, or none where the surface ends. The mean of the rotations leaves
/// out, axis by axis, what lies beyond 3 x 1.4826 median absolute deviations, until the set stays
/// (ten times at most).
///
/// Yaw and pitch of the mount so include the craft's mean side slip and, without a surface, the
/// mean slope; roll without one is that against the level, which is the mount's only if the ground
/// has no bank. In turns the craft leans and slips, which no editing takes out: on an oval of 14
/// degrees roll and yaw err by 0.5 degrees without the gate, by 0.1 with it [FHB03]. So they are
/// good to a few tenths of a degree, whatever the standard error. Nothing where fewer than ten
/// epochs are retained.
///
/// Failure (at "surface") where there are normals, but not one for each epoch.
std::optional<MountEstimate> estimate_mount(
    const InertialSolution& solution, const MountGate& gate,
    std::span<const std::optional<Eigen::Vector3d>> normals = {});

}  // namespace runcert
