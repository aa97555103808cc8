#include "inertial/surface_attitude.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/angle.h"
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

void require_travel(const Eigen::Vector3d& ahead, const SurfaceGate& gate) {
    if (!gate.enu_from_body) return;
    const double cosine = ahead.dot(gate.enu_from_body->col(0));
    if (cosine >= 0.0) return;
    throw Failure(
        "surface",
        fmt::format(
            "the craft travels {}: its velocity lies {:.0f} degrees off its forward axis",
            gate.travel == Travel::forwards ? "backwards" : "forwards",
            std::acos(gate.travel == Travel::forwards ? cosine : -cosine) * degrees_per_radian),
        "Leave this stretch out, or state which way the craft travels");
}

}  // namespace

std::optional<Eigen::Matrix3d> attitude_on_surface(const SurfaceMotion& motion,
                                                   const SurfaceGate& gate) {
    const Eigen::Vector3d normal = upward_normal(motion);
    const Eigen::Vector3d along = motion.velocity_m_s - motion.velocity_m_s.dot(normal) * normal;
    const double speed_m_s = along.norm();
    if (!(speed_m_s > 0.0) || speed_m_s < gate.least_speed_m_s) return std::nullopt;
    const double sign = gate.travel == Travel::forwards ? 1.0 : -1.0;
    const Eigen::Vector3d ahead = sign / speed_m_s * along;
    require_travel(ahead, gate);
    Eigen::Matrix3d enu_from_vehicle;
    enu_from_vehicle << ahead.cross(normal), ahead, normal;
    return enu_from_vehicle * vehicle_from_body();
}

std::optional<StartAttitude> start_on_surface(const SurfaceMotion& motion, const SurfaceGate& gate,
                                              const EulerAngles& sigma, double velocity_sigma_m_s) {
    const auto attitude = attitude_on_surface(motion, gate);
    if (!attitude) return std::nullopt;
    EulerAngles with_course = sigma;
    with_course.heading =
        std::hypot(sigma.heading, std::atan2(velocity_sigma_m_s, motion.velocity_m_s.norm()));
    return StartAttitude{*attitude, attitude_covariance(*attitude, with_course)};
}

}  // namespace runcert
