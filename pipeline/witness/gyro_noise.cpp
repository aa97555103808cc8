#include "witness/gyro_noise.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/angle.h"
#include "witness/inertial_input.h"

namespace runcert {
namespace {

Eigen::Vector3d rate_of(const ImuRow& row) {
    return {row.rate_forward_rad_s, row.rate_right_rad_s, row.rate_down_rad_s};
}

/// What the grade makes of the noise of a sample. That of an interval between two instants is their
/// mean, and successive ones share one of them: their differences are half as large.
double expected_noise(const ImuTable& imu) {
    const double white =
        imu_noise(imu.grade).angle_walk_rad_sqrt_s / std::sqrt(imu.clock.interval_s);
    return imu.clock.samples == "instant" ? 0.5 * white : white;
}

}  // namespace

std::optional<double> least_gyro_noise(const ImuTable& imu) {
    constexpr std::size_t fewest = 10;
    const auto length =
        static_cast<std::size_t>(std::max<long long>(std::llround(1.0 / imu.clock.interval_s), 1));
    if (length < fewest) return std::nullopt;
    std::optional<double> least;
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    Eigen::Vector3d step = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    std::size_t count = 0;
    for (std::size_t i = 1; i < imu.rows.size(); ++i) {
        const Eigen::Vector3d change = rate_of(imu.rows[i]) - rate_of(imu.rows[i - 1]);
        const bool gap = imu.rows[i].gap_before.value_or(false);
        if (!gap) {
            squares += change.cwiseAbs2();
            ++count;
            for (Eigen::Index axis = 0; axis < 3; ++axis)
                if (const double size = std::abs(change[axis]); size > 0.0)
                    step[axis] = std::min(step[axis], size);
        }
        if (count == length) {
            const double noise = std::sqrt(squares.maxCoeff() / (2.0 * static_cast<double>(count)));
            least = std::min(least.value_or(noise), noise);
        }
        if (!gap && count < length) continue;
        count = 0;
        squares.setZero();
    }
    // A gyro that is read more coarsely than its noise stays at one value.
    if (least && step.minCoeff() < std::numeric_limits<double>::infinity())
        least = std::hypot(*least, step.minCoeff() / std::sqrt(12.0));
    return least;
}

std::string quiet_gyros_text(const ImuTable& imu, const Imu& stated) {
    constexpr double too_quiet = 0.1;
    const auto noise_rad_s = least_gyro_noise(imu);
    const double expected_rad_s = expected_noise(imu);
    if (!noise_rad_s || *noise_rad_s >= too_quiet * expected_rad_s) return {};
    constexpr double dead = 1e-3;
    return fmt::format(
        "{}: in their quietest second the gyros scatter by {:.2g} deg/s from sample to sample, "
        "where the IMU's grade makes {:.2g} deg/s. {}",
        std::filesystem::path(stated.file).filename().string(),
        Angle::from_radians(*noise_rad_s).degrees(), Angle::from_radians(expected_rad_s).degrees(),
        *noise_rad_s < dead * expected_rad_s
            ? "They do not measure, or hold one value. Check the columns of the gyros."
            : "Check gyro_unit (rad/s or deg/s), gyro_scale and the columns of the gyros. If they "
              "were filtered or are better than their grade, state their figures as grade.");
}

}  // namespace runcert
