#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/geodetic.h"
#include "inertial/inertial_smoother.h"
#include "schemas/simulation/simulation.h"

namespace runcert {

/// Where an IMU is simulated.
enum class InertialCourse {
    /// A sailing craft on a salt lake: from a sixth of its speed to all of it along a straight
    /// line, with gusts, slow meanders and leeway.
    salt_lake,
    /// A car on a banked oval: straights of 600 m and turns of 320 m radius, 3 to 14 degrees of
    /// bank, 66 to 85 m/s, side slip and body roll.
    oval,
};

/// A run with an IMU whose truth is known.
struct InertialRunSpec {
    InertialCourse course = InertialCourse::salt_lake;
    /// Speed, bearing and start of the run, in place of those that the course has of itself, and
    /// `stand_s` 0; then a lake is flat and the way on it straight, without gusts.
    std::optional<LogisticRun> run = std::nullopt;
    Geodetic origin{.latitude = Angle::from_degrees(-31.6),
                    .longitude = Angle::from_degrees(136.0),
                    .height_m = 110.0};
    double duration_s = 100.0;
    double stand_s = 0.0;     ///< the craft stands so long before it moves
    double start_m = 0.0;     ///< where on the oval it starts; its first turn begins at 600 m
    double speed_m_s = 60.0;  ///< on the lake
    /// Of the craft's own oscillation, beside what course and bank give.
    double roll_deg = 10.0;
    double roll_hz = 0.5;
    double pitch_deg = 2.0;
    double pitch_hz = 0.65;
    double leeway_deg = 2.5;                    ///< mean on the lake; it varies by a fifth
    Eigen::Vector3d antenna_m{0.0, 0.0, -5.0};  ///< from the IMU, forward, right, down
    std::optional<Eigen::Vector3d> second_antenna_m = {};  ///< from the IMU, with its own receiver
    Eigen::Vector3d reference_point_m = Eigen::Vector3d::Zero();
    ImuNoise noise = {};      ///< no noise: an IMU without errors
    bool with_biases = true;  ///< drawn from `noise`
    /// Standard deviation of scale factors and of what one axis feels of another, constant.
    double scale_sigma = 0.0;
    int imu_hz = 100;  ///< 50, 100, 200 or 400
    int position_hz = 10;
    double white_horizontal_m = 0.012;
    double white_vertical_m = 0.020;
    PositionErrorModel position_error = {};  ///< sizes of 0: white errors only
    double time_offset_s = 0.0;              ///< a position stamped t is that at t + offset
    std::uint64_t seed = 1;
};

/// The truth at a position's epoch.
struct InertialTruth {
    double time_s = 0.0;
    NavigationState imu = {};
    Eigen::Vector3d antenna_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d antenna_velocity_m_s = Eigen::Vector3d::Zero();
    Eigen::Vector3d antenna_acceleration_m_s2 = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference_point_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d reference_velocity_m_s = Eigen::Vector3d::Zero();
    ImuBias bias = {};
    Eigen::Vector3d ground_normal = Eigen::Vector3d::UnitZ();  ///< of the surface below
};

struct InertialRun {
    std::vector<ImuSample> samples;
    std::vector<PositionFix> fixes;
    std::vector<InertialTruth> truth;       ///< of each fix
    std::vector<PositionFix> second_fixes;  ///< of the second antenna, at the same times
};

/// Simulates a run. Velocity and attitude are given as functions of time at 400 Hz, and the
/// increments between two instants are those that `strapdown_step` needs to lead from one to the
/// other. So the recording tests an estimator, not the physics. Errors: constant biases and their
/// walks, random walks, noise that grows with motion; positions with white and Gauss-Markov errors.
/// The same spec gives the same run; errors are drawn whatever their sizes.
///
/// Failure (at "simulation") where a duration, rate or standard deviation cannot be.
InertialRun simulate_inertial(const InertialRunSpec& spec);

/// The setup of a smoother that knows the spec as an attempt would declare it.
InertialSetup setup_of(const InertialRunSpec& spec);

}  // namespace runcert
