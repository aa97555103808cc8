#include "stages/smooth/dhd22.h"

#include <Eigen/LU>

namespace runcert {

std::vector<std::optional<double>> speed_v1(std::span<const PlanePosition> positions) {
    std::vector<std::optional<double>> speeds(positions.size());
    for (std::size_t k = 1; k + 1 < positions.size(); ++k)
        speeds[k] = (positions[k + 1].position - positions[k - 1].position).norm() /
                    (positions[k + 1].time_s - positions[k - 1].time_s);
    return speeds;
}

std::vector<std::optional<double>> speed_v2(std::span<const PlanePosition> positions) {
    std::vector<std::optional<double>> speeds(positions.size());
    std::vector<double> path_m(positions.size(), 0.0);
    for (std::size_t k = 1; k < positions.size(); ++k)
        path_m[k] = path_m[k - 1] + (positions[k].position - positions[k - 1].position).norm();
    for (std::size_t k = 2; k + 2 < positions.size(); ++k)
        speeds[k] =
            (path_m[k + 2] - path_m[k - 2]) / (positions[k + 2].time_s - positions[k - 2].time_s);
    return speeds;
}

std::vector<FilteredState> filter_dhd22(std::span<const PlanePosition> positions,
                                        double acceleration_sigma_m_s2) {
    constexpr double start_velocity_sigma_m_s = 100.0;
    std::vector<FilteredState> states;
    states.reserve(positions.size());
    for (const PlanePosition& measured : positions) {
        const double variance = measured.sigma_m * measured.sigma_m;
        FilteredState state;
        if (states.empty()) {
            state.mean.head<2>() = measured.position;
            state.covariance.diagonal() << variance, variance,
                start_velocity_sigma_m_s * start_velocity_sigma_m_s,
                start_velocity_sigma_m_s * start_velocity_sigma_m_s;
            states.push_back(state);
            continue;
        }
        const double dt = measured.time_s - positions[states.size() - 1].time_s;
        Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
        transition.topRightCorner<2, 2>().diagonal().setConstant(dt);
        Eigen::Matrix<double, 4, 2> noise_input = Eigen::Matrix<double, 4, 2>::Zero();
        noise_input.topRows<2>().diagonal().setConstant(dt * dt / 2.0);
        noise_input.bottomRows<2>().diagonal().setConstant(dt);
        noise_input *= acceleration_sigma_m_s2;
        const Eigen::Vector4d predicted = transition * states.back().mean;
        const Eigen::Matrix4d covariance =
            transition * states.back().covariance * transition.transpose() +
            noise_input * noise_input.transpose();
        const Eigen::Matrix2d innovation =
            covariance.topLeftCorner<2, 2>() + variance * Eigen::Matrix2d::Identity();
        const Eigen::Matrix<double, 4, 2> gain = covariance.leftCols<2>() * innovation.inverse();
        Eigen::Matrix4d keep = Eigen::Matrix4d::Identity();
        keep.leftCols<2>() -= gain;
        state.mean = predicted + gain * (measured.position - predicted.head<2>());
        state.covariance =
            keep * covariance * keep.transpose() + variance * gain * gain.transpose();
        states.push_back(state);
    }
    return states;
}

}  // namespace runcert
