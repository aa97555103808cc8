#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "schemas/imu/declared.h"
#include "stages/import/imu/raw.h"
#include "stages/import/imu/sampling.h"

namespace runcert::imu {

/// The mean over an interval that ends at a sample, along the IMU's axes.
struct IntervalMean {
    Eigen::Vector3d rate_rad_s, force_m_s2;
    double interval_s = 0.0;
};

/// What a sample says of the interval that ends at it; nothing where none does (the first of
/// instants).
std::optional<IntervalMean> mean_of(const RawFile& raw, const Sampling& sampling, std::size_t i);

/// What is wrong with single samples.
struct SampleFaults {
    std::vector<bool> repeated, saturated;  ///< of each sample
    std::optional<double> gyro_range_rad_s, accelerometer_range_m_s2;
};

/// A reading that repeats at the largest size of its kind, three times in a row on one axis and
/// with one sign, is at the end of its range, where that is at least 100 deg/s or 1.9 g.
SampleFaults faults_of(const RawFile& raw, const Sampling& sampling);

/// A stretch of samples, and the means over it along the IMU's axes.
struct Stretch {
    std::size_t begin = 0, end = 0;
    Eigen::Vector3d rate_rad_s, force_m_s2;
    double scatter_m_s2 = 0.0;  ///< largest standard deviation of the axes
    double scatter_rad_s = 0.0;
};

/// Of whole seconds without a gap the one in which specific force and angular rate scatter least.
/// Nothing where there is none.
std::optional<Stretch> quietest_second(const RawFile& raw, const Sampling& sampling);

/// The whole file.
Stretch whole_file(const RawFile& raw, const Sampling& sampling);

/// Whether a stretch can be at rest: gravity alone acts.
bool may_be_at_rest(const Stretch& stretch);

/// Failure where gravity has a size that no motion explains (units, increments), where it does not
/// sit on the down axis, and where gyros read more than any gyro or turn at rest; judged in the
/// quietest second where that may be at rest, else by the mean of the file. `down` are the
/// components of the craft's down axis along the IMU's.
void require_gravity(const Imu& imu, const RawFile& raw, const Sampling& sampling,
                     const Eigen::Vector3d& down);

}  // namespace runcert::imu
