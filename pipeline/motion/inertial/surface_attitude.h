#pragma once

#include <Eigen/Core>
#include <optional>

#include "inertial/inertial_smoother.h"

namespace runcert {

/// A surface under a craft that moves over it.
struct SurfaceMotion {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< east, north, up; up is above 0
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
};

/// Attitude of a craft that stands upright on a surface and moves along its forward axis [FHB03]:
///
///     y = v - (v.n) n, made 1 long;  x = y cross n;  C_v^n = [x y n]
///
/// x is right, y ahead, n the unit normal. The result is exact, and is the attitude of the ground:
/// lean and side slip of the craft are not in it. Nothing where the speed along the surface is less
/// than `least_speed_m_s`, or none.
///
/// Failure (at "surface") where a number is not finite or the normal does not point upwards.
///
/// What is printed in [FHB03] differs from this in places:
/// 1. The pitch vector is turned by R_l^p. R_p^l is meant, as for the roll vector.
/// 2. R_3[-pi/2] turns the vector: (x, y) to (y, -x). As a turn of the axes, the usual sense in
///    geodesy, it would give the left axis.
/// 3. arcsin(v_z) of the right axis is positive with the right side up: roll with the other sign.
/// 4. ArcTan2(v_x, v_y) of the right axis is the heading plus 90 degrees, or, with the arguments in
///    the order of a spreadsheet, minus the heading. Either holds for a level craft alone: with
///    roll and pitch it errs by atan(tan(roll) sin(pitch)), 0.25 degrees at 14 and 1, 2.18 at 36
///    and 3. The pitch vector gives the heading exactly.
/// 5. The arcsine of the right axis is not the roll of its order of angles, either:
///    sin(beta) = -cos(pitch) sin(roll), 0.06 degrees at 36 and 3.
/// 6. Some indices are misprinted (t and 1 for l), and a trace of variances "below 1 degree" must
///    be its root.
/// 7. 33.2 to 17.5 s is 47 % less (printed 48), 113.1 to 23.4 s 79 % (80), and of one count it says
///    14 of 140 and 16 of 154.
std::optional<Eigen::Matrix3d> attitude_on_surface(const SurfaceMotion& motion,
                                                   double least_speed_m_s = 5.0);

/// The normal of ground that holds a velocity and is level across it.
Eigen::Vector3d level_normal(const Eigen::Vector3d& velocity_m_s);

}  // namespace runcert
