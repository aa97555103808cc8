#pragma once

#include <Eigen/Core>
#include <optional>

#include "inertial/inertial_smoother.h"

namespace runcert {

/// Which way a craft travels over the ground.
enum class Travel { forwards, backwards };

/// A surface under a craft that moves over it.
struct SurfaceMotion {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< east, north, up; up is above 0
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
};

/// When a velocity is taken for the craft's forward axis.
struct SurfaceGate {
    double least_speed_m_s = 5.0;  ///< along the surface
    Travel travel = Travel::forwards;
    /// A rough attitude, good to tens of degrees. With it a craft that travels the other way than
    /// stated is noticed.
    std::optional<Eigen::Matrix3d> enu_from_body = {};
};

/// Attitude of a craft that stands upright on a surface and moves along its forward axis [FHB03]:
///
///     y = v - (v.n) n, made 1 long;  x = y cross n;  C_v^n = [x y n]
///
/// x is right, y ahead, n the unit normal. The result is exact, and is the attitude of the ground:
/// lean and side slip of the craft are not in it. Nothing below the gate's speed.
///
/// Failure (at "surface") where a number is not finite, the normal does not point upwards, or the
/// rough attitude shows that the craft travels the other way.
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
                                                   const SurfaceGate& gate);

/// The same as a start of the filter. `sigma` (rad) is what roll, pitch and heading of the craft
/// differ by from those of the ground: some 1, 1 and 1.5 degrees on a car; on a sailing craft its
/// own roll and leeway, 8, 2 and 3 degrees. The velocity's standard deviation (m/s) across the
/// course adds atan(sigma / speed) to the heading's.
std::optional<StartAttitude> start_on_surface(const SurfaceMotion& motion, const SurfaceGate& gate,
                                              const EulerAngles& sigma, double velocity_sigma_m_s);

}  // namespace runcert
