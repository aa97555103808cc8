#pragma once

#include <optional>
#include <span>

#include "inertial/inertial_filter.h"

namespace runcert {

/// What a standing IMU says of its attitude and its gyros over a stretch of time.
struct StandingAlignment {
    /// Level by gravity: the specific force is opposite to it. The heading is that by the Earth's
    /// rotation, the mean angular rate's part across gravity pointing north.
    Eigen::Matrix3d enu_from_body = Eigen::Matrix3d::Identity();
    double tilt_sigma_rad =
        0.0;  ///< of roll and pitch: accelerometers' bias and noise over gravity
    /// Of the heading: gyros' bias and noise over the Earth's rotation across gravity. Above 1 the
    /// heading means nothing. For 1 degree/h at middle latitudes 5 to 6 degrees.
    double heading_sigma_rad = 0.0;
    /// The mean angular rate: gyro bias, and the Earth's rotation if the heading is unknown.
    Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();
    double rate_sigma_rad_s = 0.0;  ///< of the noise alone
};

/// Alignment of an IMU that stands from one time to another: by two vectors known in both frames,
/// gravity and gravity x rotation of the Earth (`rotation_of_two_vectors`). Failure (at "IMU")
/// where samples do not cover the stretch, or the mean specific force differs from gravity by more
/// than 5
/// %: wrong units, or not standing.
StandingAlignment align_standing(std::span<const ImuSample> samples, double from_s, double to_s,
                                 const EarthFrame& earth, const ImuNoise& noise);

/// Velocity (m/s) at an epoch by a straight line through the positions within a second of it.
Eigen::Vector3d velocity_of_positions(std::span<const PositionFix> fixes, std::size_t epoch);

/// A craft that moves at all.
inline constexpr double moving_speed_m_s = 0.5;

/// The first epoch at which the horizontal speed by positions is this or more.
std::optional<std::size_t> first_faster(std::span<const PositionFix> fixes, double speed_m_s);

/// Rotation of the body from one time to another by the gyros: body axes at `to_s` into those at
/// `from_s`, the Earth's rotation neglected.
Eigen::Matrix3d body_rotation(std::span<const ImuSample> samples, double from_s, double to_s,
                              const Eigen::Vector3d& gyro_bias_rad_s);

/// A start of the filter at the first position.
struct FoundStart {
    InertialPrior prior;
    StartMethod kind = StartMethod::given;
};

/// The start that the setup gives, or else two antennas, the course or the Earth's rotation. With
/// the course the craft is taken to be level. Specific force and the positions' acceleration, with
/// velocity and forward axis as the second vector, would level it better: on an oval to 1 degree in
/// place of 7, but under a mast of 5 m to 9 in place of 4. The smoothed attitude is the same (0.012
/// degrees on the oval, 0.17 under the mast), so the simpler start is kept. None
/// where only a search can find one.
std::optional<FoundStart> find_start(const InertialData& data, const InertialSetup& setup);

/// The start at the first position that is 5 m/s or faster and has a surface below: the attitude on
/// that (`attitude_on_surface`), carried back by the gyros. The craft's own roll, pitch and leeway
/// are not in it: standard deviations of 10, 4 and 5 degrees, which hold for a sailing craft that
/// heels, where [FHB03] has 1, 1 and 1.5 for a car. None without such a position, and where the
/// craft stands at first: gravity levels it better.
std::optional<FoundStart> surface_start(const InertialData& data, const InertialSetup& setup);

/// The likeliest of twelve headings, 30 degrees apart, over the first 60 s of motion, level by the
/// mean specific force there.
FoundStart search_start(const InertialData& data, const InertialSetup& setup);

}  // namespace runcert
