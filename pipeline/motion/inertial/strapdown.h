#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "inertial/gravity.h"

namespace runcert {

/// What an IMU measured over an interval: increments along its axes, forward, right and down.
struct ImuSample {
    double time_s = 0.0;  ///< end of the interval
    double interval_s = 0.0;
    Eigen::Vector3d angle_rad = Eigen::Vector3d::Zero();     ///< integral of the angular rate
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();  ///< integral of the specific force
};

/// Constant errors of an IMU: measured = true + bias.
struct ImuBias {
    Eigen::Vector3d gyro_rad_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d accelerometer_m_s2 = Eigen::Vector3d::Zero();
};

/// Attitude, velocity and position of an IMU in east, north and up.
struct NavigationState {
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    Eigen::Vector3d velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
};

/// Carries a state over one sample, biases removed. Attitude, velocity and position follow the
/// equations of motion in the rotating frame:
///
///     f^n dt = exp(-[w_ie] dt/2) C (dv + dth x dv / 2)
///     v+ = v + f^n dt + (g - 2 w_ie x v_mid) dt,  r+ = r + (v + v+) dt / 2
///     C+ = exp(-[w_ie] dt) C exp([dth])
///
/// Gravity g is that half way, v_mid the mean of v and v+. Over 60 s of a car on a banked oval (1.8
/// g, roll and pitch to 1.7 Hz), the position errs by 14, 3.8, 1.1 and 0.4 mm at 50, 100, 200 and
/// 400 Hz.
struct StrapdownStep {
    NavigationState state;                  ///< at the end
    Eigen::Vector3d specific_velocity_m_s;  ///< f^n dt
};
StrapdownStep strapdown_step(const NavigationState& state, const ImuSample& sample,
                             const ImuBias& bias, const EarthFrame& earth);

/// Reads samples in order of time and splits them wherever a state is wanted: increments in
/// proportion to time. Where samples are missing, the mean of the rates before and after stands in.
class SampleReader {
  public:
    /// Times must increase strictly, intervals be positive and no longer than the step between
    /// samples (to 1 %): Failure (at "IMU") otherwise, and where a number is not finite.
    explicit SampleReader(std::span<const ImuSample> samples);

    /// Starts reading at a time. Failure where the samples do not reach it.
    void seek(double time_s);

    /// The next piece, ending at `until_s` at the latest; none at `until_s`.
    struct Piece {
        ImuSample sample;
        double gap_s = 0.0;  ///< length of the gap between samples that it lies in; 0 if in none
    };
    std::optional<Piece> next(double until_s);

    double begin_s() const;
    double end_s() const;

  private:
    std::span<const ImuSample> samples_;
    std::size_t at_ = 0;
    double time_s_ = 0.0;
};

/// The measured angular rate (rad/s, biases included) at a time: between the middles of samples by
/// linear interpolation, which holds noise as low as it can without delay.
Eigen::Vector3d measured_rate_rad_s(std::span<const ImuSample> samples, double time_s);

}  // namespace runcert
