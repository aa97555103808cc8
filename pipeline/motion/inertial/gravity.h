#pragma once

#include <Eigen/Core>

#include "core/geodesy.h"

namespace runcert {

/// Normal gravity of WGS 84 and the rotation of the Earth, in the frame of east, north and up at an
/// origin. The frame rotates with the Earth and is not levelled again as a craft moves.
class EarthFrame {
  public:
    /// Failure as for `require_valid`.
    explicit EarthFrame(const Geodetic& origin);

    /// Acceleration (m/s^2) of free fall from rest at a place (m), centrifugal part included:
    /// GeographicLib::NormalGravity, exact to rounding. A constant vector would be wrong by 785
    /// micro-g 5 km from the origin.
    Eigen::Vector3d gravity_m_s2(const Eigen::Vector3d& enu_m) const;

    /// Gradient of gravity (1/s^2) near the origin: diag(-g/N, -g/M, 2 g/R), N and M the radii of
    /// curvature across and along the meridian, R their geometric mean. Good to 1 % of 2 g/R.
    const Eigen::Matrix3d& gravity_gradient() const { return gradient_; }

    /// Rotation of the Earth (rad/s).
    const Eigen::Vector3d& rotation_rad_s() const { return rotation_; }

    const Geodetic& origin() const { return frame_.origin(); }

  private:
    LocalFrame frame_;
    Eigen::Matrix3d enu_from_ecef_;
    Eigen::Matrix3d gradient_;
    Eigen::Vector3d rotation_;
};

}  // namespace runcert
