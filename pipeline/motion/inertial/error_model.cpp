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

template <int N>
void propagate(ErrorMatrix<N>& covariance, const ErrorTransition& transition,
               const ErrorNoise& noise) {
    covariance.diagonal().template head<error_state::inertial>() += 0.5 * noise.white;
    transition.apply(covariance);
    ErrorMatrix<N> turned = covariance.transpose();
    transition.apply(turned);
    turned.diagonal().template head<error_state::inertial>() += 0.5 * noise.white;
    turned.diagonal().template segment<3>(error_state::position_error) += noise.error;
    covariance = 0.5 * (turned + turned.transpose());
}

template <int N>
Eigen::Matrix<double, 3, N> point_jacobian(const Eigen::Matrix3d& enu_from_body,
                                           const Eigen::Vector3d& arm_m,
                                           const Eigen::Vector3d& point_velocity_m_s) {
    using namespace error_state;
    Eigen::Matrix<double, 3, N> h = Eigen::Matrix<double, 3, N>::Zero();
    h.template middleCols<3>(attitude) = -cross_matrix(enu_from_body * arm_m);
    h.template middleCols<3>(position).setIdentity();
    if constexpr (N == full) h.col(time_offset) = point_velocity_m_s;
    return h;
}

template <int N>
Eigen::Matrix<double, 3, N> position_jacobian(const Eigen::Matrix3d& enu_from_body,
                                              const Eigen::Vector3d& arm_m,
                                              const Eigen::Vector3d& antenna_velocity_m_s) {
    Eigen::Matrix<double, 3, N> h = point_jacobian<N>(enu_from_body, arm_m, antenna_velocity_m_s);
    h.template middleCols<3>(error_state::position_error).setIdentity();
    if constexpr (N == error_state::full)
        h.template middleCols<3>(error_state::lever_arm) = enu_from_body;
    return h;
}

template <int N>
Eigen::Matrix<double, 3, N> point_velocity_jacobian(const Eigen::Matrix3d& enu_from_body,
                                                    const Eigen::Vector3d& arm_m,
                                                    const Eigen::Vector3d& rate_rad_s) {
    using namespace error_state;
    Eigen::Matrix<double, 3, N> h = Eigen::Matrix<double, 3, N>::Zero();
    h.template middleCols<3>(attitude) = -cross_matrix(enu_from_body * rate_rad_s.cross(arm_m));
    h.template middleCols<3>(velocity).setIdentity();
    h.template middleCols<3>(gyro_bias) = enu_from_body * cross_matrix(arm_m);
    return h;
}

#define RUNCERT_ERROR_STATES(N)                                                             \
    template void propagate<N>(ErrorMatrix<N>&, const ErrorTransition&, const ErrorNoise&); \
    template Eigen::Matrix<double, 3, N> point_jacobian<N>(                                 \
        const Eigen::Matrix3d&, const Eigen::Vector3d&, const Eigen::Vector3d&);            \
    template Eigen::Matrix<double, 3, N> position_jacobian<N>(                              \
        const Eigen::Matrix3d&, const Eigen::Vector3d&, const Eigen::Vector3d&);            \
    template Eigen::Matrix<double, 3, N> point_velocity_jacobian<N>(                        \
        const Eigen::Matrix3d&, const Eigen::Vector3d&, const Eigen::Vector3d&)
RUNCERT_ERROR_STATES(error_state::plain);
RUNCERT_ERROR_STATES(error_state::full);
#undef RUNCERT_ERROR_STATES

}  // namespace runcert
