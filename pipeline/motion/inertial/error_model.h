#pragma once

#include <Eigen/Core>

#include "inertial/imu_noise.h"
#include "inertial/strapdown.h"

namespace runcert {

/// Errors of an inertial solution as one vector: truth = estimate + error, and for the attitude
/// C = exp([phi]) C_estimate, phi along east, north and up.
///
/// 22 states: attitude (rad), velocity (m/s), position (m), gyro bias (rad/s), accelerometer bias
/// (m/s^2), the first-order Gauss-Markov error of the measured positions (m), the antenna's lever
/// arm along the body's axes (m), and the time offset (s). Of the last two, one that is not
/// estimated has next to no variance.
namespace error_state {
inline constexpr int attitude = 0, velocity = 3, position = 6, gyro_bias = 9;
inline constexpr int accelerometer_bias = 12, position_error = 15, lever_arm = 18;
inline constexpr int time_offset = 21;
inline constexpr int inertial = 15, size = 22;
}  // namespace error_state

using ErrorVector = Eigen::Matrix<double, error_state::size, 1>;
using ErrorMatrix = Eigen::Matrix<double, error_state::size, error_state::size>;
/// What a vector changes by per error, and what each error covaries with a vector by.
using ErrorJacobian = Eigen::Matrix<double, 3, error_state::size>;
using ErrorColumns = Eigen::Matrix<double, error_state::size, 3>;
using ErrorRow = Eigen::Matrix<double, 1, error_state::size>;

/// The time-correlated error of measured positions: a first-order Gauss-Markov process on each
/// axis.
struct PositionErrorModel {
    double horizontal_m = 0.008;  ///< standard deviation, steady
    double vertical_m = 0.012;
    double time_s = 3.0;  ///< correlation time
};

/// One step of the errors, with what the true motion was half way.
struct ErrorStep {
    double dt_s = 0.0;
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    Eigen::Vector3d specific_force_m_s2 = Eigen::Vector3d::Zero();  ///< along east, north, up
    double rate_rad_s = 0.0;                                        ///< size of the angular rate
    double acceleration_m_s2 = 0.0;          ///< size of specific force plus gravity
    double extra_attitude_rad_sqrt_s = 0.0;  ///< noise where samples are missing
    double extra_velocity_m_s_sqrt_s = 0.0;
};

/// Transition of the errors over a step, in the blocks that are neither zero nor one:
/// I + F dt + F^2 dt^2 / 2 of
///
///     phi' = -w_ie x phi - C dbg,   dv' = -[f^n] phi - 2 w_ie x dv + Gamma dr - C dba,   dr' = dv
///
/// and constant biases. Leaves out terms of dt^3.
struct ErrorTransition {
    Eigen::Matrix3d attitude_of_attitude, attitude_of_gyro;
    Eigen::Matrix3d velocity_of_attitude, velocity_of_velocity, velocity_of_position;
    Eigen::Matrix3d velocity_of_gyro, velocity_of_accelerometer;
    Eigen::Matrix3d position_of_attitude, position_of_velocity, position_of_position;
    Eigen::Matrix3d position_of_accelerometer;
    double error = 1.0;  ///< of the positions' Gauss-Markov error

    /// The transition times a matrix.
    void apply(ErrorMatrix& matrix) const;

    /// All of it.
    ErrorMatrix matrix() const {
        ErrorMatrix all = ErrorMatrix::Identity();
        apply(all);
        return all;
    }
};
ErrorTransition error_transition(const ErrorStep& step, const PositionErrorModel& error,
                                 const EarthFrame& earth);

/// Variance that the noise of the IMU adds in a step, on the diagonal, before transition
/// (`white`, half of it before and half of it after), and that of the Gauss-Markov error.
struct ErrorNoise {
    Eigen::Matrix<double, error_state::inertial, 1> white;
    Eigen::Vector3d error;
};
ErrorNoise error_noise(const ErrorStep& step, const ImuNoise& noise,
                       const PositionErrorModel& error);

/// P = Phi (P + Q/2) Phi' + Q/2: the trapezoidal rule.
void propagate(ErrorMatrix& covariance, const ErrorTransition& transition, const ErrorNoise& noise);

/// The measured position less its prediction r + C l + g (+ v_antenna tau) as a function of the
/// errors: H = [-[C l], 0, I, 0, 0, I, C, v_antenna].
ErrorJacobian position_jacobian(const Eigen::Matrix3d& enu_from_body, const Eigen::Vector3d& arm_m,
                                const Eigen::Vector3d& antenna_velocity_m_s);

/// A point fixed to the body, `arm_m` from the IMU, as a function of the errors; its velocity
/// v + C (w_eb x l), w_eb the body's rate against the Earth.
ErrorJacobian point_jacobian(const Eigen::Matrix3d& enu_from_body, const Eigen::Vector3d& arm_m,
                             const Eigen::Vector3d& point_velocity_m_s);
ErrorJacobian point_velocity_jacobian(const Eigen::Matrix3d& enu_from_body,
                                      const Eigen::Vector3d& arm_m,
                                      const Eigen::Vector3d& rate_rad_s);

}  // namespace runcert
