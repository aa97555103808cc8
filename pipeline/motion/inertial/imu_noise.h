#pragma once

namespace runcert {

/// The quality of an IMU by its class.
enum class ImuClass {
    tactical,  ///< HG1700 class
    mems,
    consumer,  ///< of a phone
};

/// Noise of an IMU's gyros and accelerometers, each the same on its three axes. The walks are
/// densities: a standard deviation that grows with the root of time.
struct ImuNoise {
    double gyro_bias_rad_s = 0.0;        ///< unknown at the start
    double angle_walk_rad_sqrt_s = 0.0;  ///< angular random walk
    double gyro_bias_walk_rad_s_sqrt_s = 0.0;
    double accelerometer_bias_m_s2 = 0.0;   ///< unknown at the start
    double velocity_walk_m_s_sqrt_s = 0.0;  ///< velocity random walk
    double accelerometer_bias_walk_m_s2_sqrt_s = 0.0;
    /// Noise that grows with motion, of scale factors, axes and timing: `motion` times the angular
    /// rate adds to the angular random walk, and times the acceleration to the velocity's, as
    /// independent densities.
    double motion_sqrt_s = 0.0;
};

/// The figures of a class, as data sheets state them. None has noise that grows with motion.
ImuNoise imu_noise(ImuClass grade);

/// Standard deviation of the scale factors of such a sensor, and of the directions of its axes
/// (rad). They are constant, and so hardly differ from a box that is turned by as much: the arm to
/// the antenna errs by this share of its length.
double axes_error(ImuClass grade);

/// The noise with motion (`ImuNoise::motion_sqrt_s`) that such scale factors and axes need at
/// least, a fifth of their errors. A run's likelihood shows less of it than its speeds err by: of a
/// phone on a lake, without it, 90 % of the intervals held the truth, with it 93 %, with twice as
/// much 94 %.
double least_motion(ImuClass grade);

/// Noise with the random walks, and the noise that grows with motion, that real MEMS sensors on a
/// craft need: velocity random walk ten times, angular random walk twice, 0.006 of the motion. On a
/// car drive with a MEMS IMU data sheet figures gave innovations whose mean square was 20 times
/// that stated; these gave 0.6 to 1.1 times.
ImuNoise on_a_craft(ImuNoise noise);

}  // namespace runcert
