#include "inertial/error_model.h"

#include <cmath>

#include "inertial/attitude.h"

namespace runcert {

ErrorTransition error_transition(const ErrorStep& step, const PositionErrorModel& error,
                                 const EarthFrame& earth) {
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    const Eigen::Matrix3d w = -cross_matrix(earth.rotation_rad_s());
    const Eigen::Matrix3d s = -cross_matrix(step.specific_force_m_s2);
    const Eigen::Matrix3d& gradient = earth.gravity_gradient();
    const Eigen::Matrix3d& c = step.enu_from_body;
    const double dt = step.dt_s;
    const double half = 0.5 * dt * dt;
    return {.attitude_of_attitude = one + dt * w + half * w * w,
            .attitude_of_gyro = -dt * c - half * w * c,
            .velocity_of_attitude = dt * s + half * (s * w + 2.0 * w * s),
            .velocity_of_velocity = one + 2.0 * dt * w + half * (4.0 * w * w + gradient),
            .velocity_of_position = dt * gradient + 2.0 * half * w * gradient,
            .velocity_of_gyro = -half * s * c,
            .velocity_of_accelerometer = -dt * c - 2.0 * half * w * c,
            .position_of_attitude = half * s,
            .position_of_velocity = dt * one + 2.0 * half * w,
            .position_of_position = one + half * gradient,
            .position_of_accelerometer = -half * c,
            .error = std::exp(-dt / error.time_s)};
}

ErrorNoise error_noise(const ErrorStep& step, const ImuNoise& noise,
                       const PositionErrorModel& error) {
    const auto square = [](double x) { return x * x; };
    const double attitude = square(noise.angle_walk_rad_sqrt_s) +
                            square(noise.motion_sqrt_s * step.rate_rad_s) +
                            square(step.extra_attitude_rad_sqrt_s);
    const double velocity = square(noise.velocity_walk_m_s_sqrt_s) +
                            square(noise.motion_sqrt_s * step.acceleration_m_s2) +
                            square(step.extra_velocity_m_s_sqrt_s);
    ErrorNoise added;
    added.white << Eigen::Vector3d::Constant(attitude), Eigen::Vector3d::Constant(velocity),
        Eigen::Vector3d::Zero(),
        Eigen::Vector3d::Constant(square(noise.gyro_bias_walk_rad_s_sqrt_s)),
        Eigen::Vector3d::Constant(square(noise.accelerometer_bias_walk_m_s2_sqrt_s));
    added.white *= step.dt_s;
    const double lost = -std::expm1(-2.0 * step.dt_s / error.time_s);
    added.error << square(error.horizontal_m), square(error.horizontal_m), square(error.vertical_m);
    added.error *= lost;
    return added;
}

void ErrorTransition::apply(ErrorMatrix& m) const {
    using namespace error_state;
    const auto phi = m.middleRows<3>(attitude).eval();
    const auto v = m.middleRows<3>(velocity).eval();
    const auto r = m.middleRows<3>(position).eval();
    const auto bg = m.middleRows<3>(gyro_bias);
    const auto ba = m.middleRows<3>(accelerometer_bias);
    m.middleRows<3>(attitude).noalias() = attitude_of_attitude * phi;
    m.middleRows<3>(attitude).noalias() += attitude_of_gyro * bg;
    m.middleRows<3>(velocity).noalias() = velocity_of_attitude * phi;
    m.middleRows<3>(velocity).noalias() += velocity_of_velocity * v;
    m.middleRows<3>(velocity).noalias() += velocity_of_position * r;
    m.middleRows<3>(velocity).noalias() += velocity_of_gyro * bg;
    m.middleRows<3>(velocity).noalias() += velocity_of_accelerometer * ba;
    m.middleRows<3>(position).noalias() = position_of_attitude * phi;
    m.middleRows<3>(position).noalias() += position_of_velocity * v;
    m.middleRows<3>(position).noalias() += position_of_position * r;
    m.middleRows<3>(position).noalias() += position_of_accelerometer * ba;
    m.middleRows<3>(position_error) *= error;
}

void propagate(ErrorMatrix& covariance, const ErrorTransition& transition,
               const ErrorNoise& noise) {
    covariance.diagonal().head<error_state::inertial>() += 0.5 * noise.white;
    transition.apply(covariance);
    ErrorMatrix turned = covariance.transpose();
    transition.apply(turned);
    turned.diagonal().head<error_state::inertial>() += 0.5 * noise.white;
    turned.diagonal().segment<3>(error_state::position_error) += noise.error;
    covariance = 0.5 * (turned + turned.transpose());
}

ErrorJacobian point_jacobian(const Eigen::Matrix3d& enu_from_body, const Eigen::Vector3d& arm_m,
                             const Eigen::Vector3d& point_velocity_m_s) {
    using namespace error_state;
    ErrorJacobian h = ErrorJacobian::Zero();
    h.middleCols<3>(attitude) = -cross_matrix(enu_from_body * arm_m);
    h.middleCols<3>(position).setIdentity();
    h.col(time_offset) = point_velocity_m_s;
    return h;
}

ErrorJacobian position_jacobian(const Eigen::Matrix3d& enu_from_body, const Eigen::Vector3d& arm_m,
                                const Eigen::Vector3d& antenna_velocity_m_s) {
    ErrorJacobian h = point_jacobian(enu_from_body, arm_m, antenna_velocity_m_s);
    h.middleCols<3>(error_state::position_error).setIdentity();
    h.middleCols<3>(error_state::lever_arm) = enu_from_body;
    return h;
}

ErrorJacobian point_velocity_jacobian(const Eigen::Matrix3d& enu_from_body,
                                      const Eigen::Vector3d& arm_m,
                                      const Eigen::Vector3d& rate_rad_s) {
    using namespace error_state;
    ErrorJacobian h = ErrorJacobian::Zero();
    h.middleCols<3>(attitude) = -cross_matrix(enu_from_body * rate_rad_s.cross(arm_m));
    h.middleCols<3>(velocity).setIdentity();
    h.middleCols<3>(gyro_bias) = enu_from_body * cross_matrix(arm_m);
    return h;
}

}  // namespace runcert
