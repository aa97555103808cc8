#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace runcert {

/// The smoothed motion at an epoch: velocity (m/s) and acceleration (m/s^2), east and north, with
/// their covariances.
struct EpochMotion {
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
    Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d acceleration_covariance = Eigen::Matrix2d::Identity();
    std::optional<double> vertical_rate_m_s;  ///< empty if no heights were measured
    double sigma_vertical_rate_m_s = 0.0;
};

/// One motion for each row of a table. Empty for rows outside its arcs.
using Motion = std::vector<std::optional<EpochMotion>>;

}  // namespace runcert
