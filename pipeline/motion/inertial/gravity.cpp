#include "inertial/gravity.h"

#include <GeographicLib/NormalGravity.hpp>
#include <cmath>

namespace runcert {
namespace {

const GeographicLib::NormalGravity& normal_gravity() {
    return GeographicLib::NormalGravity::WGS84();
}

}  // namespace

EarthFrame::EarthFrame(const Geodetic& origin)
    : frame_(origin), enu_from_ecef_(rotation_enu_from_ecef(origin.latitude, origin.longitude)) {
    const double sine = std::sin(origin.latitude.radians());
    const double cosine = std::cos(origin.latitude.radians());
    rotation_ = normal_gravity().AngularVelocity() * Eigen::Vector3d(0.0, cosine, sine);
    const double f = normal_gravity().Flattening();
    const double e2 = f * (2.0 - f);
    const double w = std::sqrt(1.0 - e2 * sine * sine);
    const double across_m = normal_gravity().EquatorialRadius() / w;
    const double along_m = across_m * (1.0 - e2) / (w * w);
    const double g = gravity_m_s2(Eigen::Vector3d::Zero()).norm();
    gradient_ =
        Eigen::Vector3d(-g / across_m, -g / along_m, 2.0 * g / std::sqrt(across_m * along_m))
            .asDiagonal();
}

Eigen::Vector3d EarthFrame::gravity_m_s2(const Eigen::Vector3d& enu_m) const {
    const Eigen::Vector3d at = frame_.ecef_from_enu(Enu{enu_m}).m;
    Eigen::Vector3d gravity;
    normal_gravity().U(at.x(), at.y(), at.z(), gravity.x(), gravity.y(), gravity.z());
    return enu_from_ecef_ * gravity;
}

}  // namespace runcert
