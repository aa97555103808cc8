#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace runcert {

/// The smoothed motion at an epoch: m/s, m/s^2 and their covariances.
struct EpochMotion {
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
    Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d acceleration_covariance = Eigen::Matrix2d::Identity();
    std::optional<double> vertical_rate_m_s;  ///< where heights were measured
    double sigma_vertical_rate_m_s = 0.0;
};

/// One for each row of a table; nothing for rows outside its arcs.
using Motion = std::vector<std::optional<EpochMotion>>;

}  // namespace runcert
