#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace runcert {

/// A measured horizontal position: time (s), east and north (m), and the standard deviation (m) of
/// each coordinate.
struct PlanePosition {
    double time_s = 0.0;
    Eigen::Vector2d position = Eigen::Vector2d::Zero();
    double sigma_m = 0.0;
};

/// Method v1 of [DHD22] (7), (8): v[k] = |p[k+1] - p[k-1]| / (t[k+1] - t[k-1]), m/s. Empty at the
/// first and the last position.
std::vector<std::optional<double>> speed_v1(std::span<const PlanePosition> positions);

/// Method v2 of [DHD22] (18), with the cumulative path length s:
/// v[k] = (s[k+2] - s[k-2]) / (t[k+2] - t[k-2]), m/s. Empty at the first two and the last two
/// positions.
std::vector<std::optional<double>> speed_v2(std::span<const PlanePosition> positions);

/// State of the filter of [DHD22], with its covariance: east, north (m) and their velocities (m/s).
struct FilteredState {
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
    double speed_m_s() const { return mean.tail<2>().norm(); }
};

/// The filter of [DHD22] (31) to (41): constant velocity, driven by acceleration noise of standard
/// deviation `acceleration_sigma_m_s2` held over each step, H = [dt^2/2, dt]. ((31) as printed has
/// 1 in place of dt, which does not reproduce the printed figures.) The paper gives neither its
/// noise nor its initial state; 0.1 m/s^2 reproduces its figures. It starts at the first position,
/// at rest, with standard deviations of sigma and 100 m/s.
std::vector<FilteredState> filter_dhd22(std::span<const PlanePosition> positions,
                                        double acceleration_sigma_m_s2);

}  // namespace runcert
