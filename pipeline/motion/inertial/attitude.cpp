#include "inertial/attitude.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace runcert {
namespace {

/// sin(x) / x, (1 - cos x) / x^2: the series where the quotient would lose digits.
double sine_over(double x) {
    return x < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}
double versine_over_square(double x) {
    if (x < 1e-4) return 0.5 - x * x / 24.0;
    const double half = std::sin(0.5 * x) / x;
    return 2.0 * half * half;
}

}  // namespace

Eigen::Matrix3d vehicle_from_body() {
    Eigen::Matrix3d axes;
    axes << 0.0, 1.0, 0.0,  //
        1.0, 0.0, 0.0,      //
        0.0, 0.0, -1.0;
    return axes;
}

Eigen::Matrix3d rotation_of(const EulerAngles& angles) {
    const auto about = [](double angle, const Eigen::Vector3d& axis) {
        return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    };
    return about(-angles.heading, Eigen::Vector3d::UnitZ()) *
           about(angles.pitch, Eigen::Vector3d::UnitX()) *
           about(angles.roll, Eigen::Vector3d::UnitY()) * vehicle_from_body();
}

EulerAngles euler_angles(const Eigen::Matrix3d& enu_from_body) {
    const Eigen::Matrix3d c = enu_from_body * vehicle_from_body();
    // asin(c(2, 1)) loses half the digits near 90 degrees.
    const double cosine = std::hypot(c(0, 1), c(1, 1));
    EulerAngles angles{.pitch = std::atan2(c(2, 1), cosine)};
    if (cosine > 1e-6) {
        angles.roll = std::atan2(-c(2, 0), c(2, 2));
        angles.heading = std::atan2(c(0, 1), c(1, 1));
    } else {
        angles.heading = std::atan2(-c(1, 0), c(0, 0));
    }
    if (angles.heading < 0.0) angles.heading += 2.0 * std::numbers::pi;
    if (angles.heading >= 2.0 * std::numbers::pi) angles.heading = 0.0;
    return angles;
}

Eigen::Matrix3d euler_jacobian(const Eigen::Matrix3d& enu_from_body) {
    const double heading = euler_angles(enu_from_body).heading;
    // The axes about which roll, pitch and heading turn the body, along east, north and up.
    Eigen::Matrix3d axes;
    axes << enu_from_body.col(0), Eigen::Vector3d(std::cos(heading), -std::sin(heading), 0.0),
        -Eigen::Vector3d::UnitZ();
    return axes.inverse();
}

Eigen::Matrix3d attitude_covariance(const Eigen::Matrix3d& enu_from_body,
                                    const EulerAngles& sigma) {
    const Eigen::Matrix3d axes = euler_jacobian(enu_from_body).inverse();
    const Eigen::Vector3d variance(sigma.roll * sigma.roll, sigma.pitch * sigma.pitch,
                                   sigma.heading * sigma.heading);
    return axes * variance.asDiagonal() * axes.transpose();
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a) {
    Eigen::Matrix3d matrix;
    matrix << 0.0, -a.z(), a.y(),  //
        a.z(), 0.0, -a.x(),        //
        -a.y(), a.x(), 0.0;
    return matrix;
}

Eigen::Matrix3d rotation_about(const Eigen::Vector3d& phi) {
    const double angle = phi.norm();
    const Eigen::Matrix3d cross = cross_matrix(phi);
    return Eigen::Matrix3d::Identity() + sine_over(angle) * cross +
           versine_over_square(angle) * cross * cross;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
    const Eigen::Quaterniond q = quaternion_of(rotation);
    const double sine = q.vec().norm();
    const double angle = 2.0 * std::atan2(sine, q.w());
    return sine < 1e-12 ? Eigen::Vector3d(2.0 * q.vec()) : Eigen::Vector3d(angle / sine * q.vec());
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d& u = svd.matrixU();
    const Eigen::Matrix3d& v = svd.matrixV();
    const Eigen::Vector3d signs(1.0, 1.0, (u * v.transpose()).determinant() < 0.0 ? -1.0 : 1.0);
    return u * signs.asDiagonal() * v.transpose();
}

Eigen::Quaterniond quaternion_of(const Eigen::Matrix3d& rotation) {
    Eigen::Quaterniond q(rotation);
    q.normalize();
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    return q;
}

Eigen::Matrix3d ecef_from_body(const Geodetic& origin, const Eigen::Matrix3d& enu_from_body) {
    return rotation_enu_from_ecef(origin.latitude, origin.longitude).transpose() * enu_from_body;
}

}  // namespace runcert
