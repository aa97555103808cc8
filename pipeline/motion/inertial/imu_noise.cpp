#include "inertial/imu_noise.h"

#include <cmath>

#include "core/angle.h"

namespace runcert {
namespace {

constexpr double standard_gravity_m_s2 = 9.80665;

/// Figures in the units of data sheets: deg/h, deg/sqrt(h), deg/h/sqrt(h); mg, m/s/sqrt(h),
/// mg/sqrt(h).
struct DataSheet {
    double gyro_bias, angle_walk, gyro_bias_walk;
    double accelerometer_bias, velocity_walk, accelerometer_bias_walk;
};

ImuNoise noise_of(const DataSheet& sheet) {
    constexpr double deg_h = radians_per_degree / 3600.0;
    constexpr double mg = 1e-3 * standard_gravity_m_s2;
    constexpr double sqrt_h = 60.0;  // in sqrt(s)
    return {.gyro_bias_rad_s = sheet.gyro_bias * deg_h,
            .angle_walk_rad_sqrt_s = sheet.angle_walk * radians_per_degree / sqrt_h,
            .gyro_bias_walk_rad_s_sqrt_s = sheet.gyro_bias_walk * deg_h / sqrt_h,
            .accelerometer_bias_m_s2 = sheet.accelerometer_bias * mg,
            .velocity_walk_m_s_sqrt_s = sheet.velocity_walk / sqrt_h,
            .accelerometer_bias_walk_m_s2_sqrt_s = sheet.accelerometer_bias_walk * mg / sqrt_h};
}

}  // namespace

ImuNoise imu_noise(ImuClass grade) {
    switch (grade) {
        case ImuClass::tactical:
            return noise_of({1.0, 0.125, 0.5, 1.0, 0.06, 0.1});
        case ImuClass::mems:
            return noise_of({50.0, 0.3, 10.0, 5.0, 0.20, 0.5});
        case ImuClass::consumer:
            return noise_of({600.0, 0.23, 60.0, 20.0, 0.09, 2.0});
    }
    return {};
}

double axes_error(ImuClass grade) {
    switch (grade) {
        case ImuClass::tactical:
            return 0.0005;
        case ImuClass::mems:
            return 0.005;
        case ImuClass::consumer:
            return 0.01;
    }
    return 0.0;
}

double least_motion(ImuClass grade) {
    return 0.2 * axes_error(grade);
}

ImuNoise on_a_craft(ImuNoise noise) {
    noise.velocity_walk_m_s_sqrt_s *= 10.0;
    noise.angle_walk_rad_sqrt_s *= 2.0;
    noise.motion_sqrt_s = std::hypot(noise.motion_sqrt_s, 0.006);
    return noise;
}

}  // namespace runcert
