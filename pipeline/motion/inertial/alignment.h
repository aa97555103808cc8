#pragma once

#include <optional>
#include <span>

#include "inertial/inertial_filter.h"

namespace runcert {

/// A direction known along the body's axes and along east, north and up at the same instant, of any
/// length. `information` (rad^-2) is that on the rotation which takes one to the other, along east,
/// north and up: the inverse of a covariance, nothing about the direction itself.
struct DirectionPair {
    Eigen::Vector3d body = Eigen::Vector3d::UnitX();
    Eigen::Vector3d enu = Eigen::Vector3d::UnitX();
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

/// Information about one axis (any length), to a standard deviation (rad).
Eigen::Matrix3d information_about(const Eigen::Vector3d& axis, double sigma_rad);

/// Wahba's problem with weights: the attitude C that makes the sum of r' information r least, where
/// r = (C body) x enu is the rotation that takes one direction to the other. It starts from the
/// rotation nearest to the sum of weight enu body' and goes on by the steps of Gauss and Newton.
/// The covariance is the inverse of the summed information. None where that leaves an axis open to
/// 100 degrees or more, as one direction does.
std::optional<StartAttitude> attitude_by_directions(std::span<const DirectionPair> pairs);

/// Mean rates of an IMU that stands, and what attitude they tell.
struct StandingMeans {
    Eigen::Vector3d rate_rad_s = Eigen::Vector3d::Zero();  ///< bias and the Earth's rotation
    Eigen::Vector3d force_m_s2 = Eigen::Vector3d::Zero();  ///< opposite to gravity
    double rate_sigma_rad_s = 0.0;                         ///< of the noise alone
    double tilt_sigma_rad = 0.0;  ///< accelerometers' bias and noise over gravity
    /// Of the heading that the mean rate shows as the Earth's: gyros' bias and noise over the
    /// Earth's rotation across gravity. For 1 degree/h at middle latitudes 5 to 6 degrees.
    double heading_sigma_rad = 0.0;

    DirectionPair gravity(const EarthFrame& earth, double sigma_rad) const;
    DirectionPair rotation(const EarthFrame& earth, double sigma_rad) const;
};

/// The means from one time to another. Failure (at "IMU") where samples do not cover it, or the
/// mean specific force differs from gravity by more than 5 %: wrong units, or not standing.
StandingMeans standing_means(std::span<const ImuSample> samples, double from_s, double to_s,
                             const EarthFrame& earth, const ImuNoise& noise);

/// Velocity (m/s) at an epoch by a straight line through the positions within a second of it.
Eigen::Vector3d velocity_of_positions(std::span<const PositionFix> fixes, std::size_t epoch);

/// A start of the filter at the first position.
struct FoundStart {
    InertialPrior prior;
    StartMethod kind = StartMethod::given;
};

/// The start that the setup gives, or that of the directions known at the first position
/// (`attitude_by_directions`): gravity and the Earth's rotation of a craft that stands; at the
/// first position that is 5 m/s or faster the course, and the ground as level or as its surface
/// lies, carried back by the gyros; two antennas. One that disagrees with those before it is left
/// out.
///
/// Specific force and the positions' acceleration would level a craft that moves better: on an oval
/// to 1 degree in place of 7, but under a mast of 5 m to 9 in place of 4. The smoothed attitude is
/// the same (0.012 degrees on the oval, 0.17 under the mast).
///
/// Where there is none, or `search`: the likeliest of twelve headings, 30 degrees apart, over the
/// first 60 s of motion, level by the mean specific force there.
FoundStart find_start(const InertialData& data, const InertialSetup& setup, bool search = false);

}  // namespace runcert
