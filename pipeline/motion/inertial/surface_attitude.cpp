#include "inertial/surface_attitude.h"

#include <Eigen/Geometry>

#include "core/failure.h"

namespace runcert {
namespace {

/// The unit normal of a motion that can be one.
Eigen::Vector3d upward_normal(const SurfaceMotion& motion) {
    if (!motion.normal.allFinite() || !motion.velocity_m_s.allFinite())
        throw Failure("surface", "a component of normal or velocity is not a finite number",
                      "Check surface and positions");
    if (!(motion.normal.z() > 0.0))
        throw Failure("surface", "the normal of the surface does not point upwards",
                      "Turn the triangle over");
    return motion.normal.normalized();
}

}  // namespace

std::optional<Eigen::Matrix3d> attitude_on_surface(const SurfaceMotion& motion,
                                                   double least_speed_m_s) {
    const Eigen::Vector3d normal = upward_normal(motion);
    const Eigen::Vector3d along = motion.velocity_m_s - motion.velocity_m_s.dot(normal) * normal;
    const double speed_m_s = along.norm();
    if (!(speed_m_s > 0.0) || speed_m_s < least_speed_m_s) return std::nullopt;
    const Eigen::Vector3d ahead = along / speed_m_s;
    Eigen::Matrix3d enu_from_vehicle;
    enu_from_vehicle << ahead.cross(normal), ahead, normal;
    return enu_from_vehicle * vehicle_from_body();
}

Eigen::Vector3d level_normal(const Eigen::Vector3d& velocity_m_s) {
    const Eigen::Vector3d right(velocity_m_s.y(), -velocity_m_s.x(), 0.0);
    return right.cross(velocity_m_s).normalized();
}

}  // namespace runcert
