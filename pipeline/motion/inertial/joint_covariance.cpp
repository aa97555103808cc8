#include "inertial/joint_covariance.h"

#include <algorithm>
#include <cassert>

namespace runcert {
namespace {

const PointMotion& motion_of(const InertialEpoch& epoch, CraftPoint point) {
    return point == CraftPoint::antenna ? epoch.antenna : epoch.reference_point;
}

const Eigen::Vector3d& arm_of(const JointCovariance& joint, CraftPoint point) {
    return point == CraftPoint::antenna ? joint.antenna_m : joint.reference_point_m;
}

/// A point's position as a function of the errors, those of an estimated antenna's arm too.
template <int N>
Eigen::Matrix<double, 3, N> position_gradient(const InertialEpoch& epoch,
                                              const JointCovariance& joint, CraftPoint point) {
    Eigen::Matrix<double, 3, N> h = point_jacobian<N>(epoch.enu_from_body, arm_of(joint, point),
                                                      motion_of(epoch, point).velocity_m_s);
    if constexpr (N == error_state::full)
        if (point == CraftPoint::antenna)
            h.template middleCols<3>(error_state::lever_arm) = epoch.enu_from_body;
    return h;
}

template <int N>
Eigen::Matrix<double, 3, N> velocity_gradient(const InertialEpoch& epoch,
                                              const JointCovariance& joint, CraftPoint point) {
    Eigen::Matrix<double, 3, N> h =
        point_velocity_jacobian<N>(epoch.enu_from_body, arm_of(joint, point), epoch.rate_rad_s);
    if constexpr (N == error_state::full)
        if (point == CraftPoint::antenna)
            h.template middleCols<3>(error_state::lever_arm) =
                epoch.enu_from_body * cross_matrix(epoch.rate_rad_s);
    return h;
}

}  // namespace

PointDisplacement InertialSolution::displacement(std::size_t s, std::size_t e,
                                                 CraftPoint point) const {
    assert(s < e && e < epochs.size());
    PointDisplacement result{.enu_m = motion_of(epochs[e], point).position_m -
                                      motion_of(epochs[s], point).position_m};
    result.covariance_m2 = std::visit(
        [&]<int N>(const JointErrors<N>& errors) {
            return errors.difference(s, position_gradient<N>(epochs[s], *joint, point), e,
                                     position_gradient<N>(epochs[e], *joint, point));
        },
        joint->errors);
    // The IMU lies where the antenna is seen, so that an error of the arm between them moves every
    // point but the antenna as the craft turns.
    if (point != CraftPoint::antenna) {
        const Eigen::Matrix3d turned = epochs[e].enu_from_body - epochs[s].enu_from_body;
        result.covariance_m2 +=
            joint->antenna_sigma_m * joint->antenna_sigma_m * turned * turned.transpose();
    }
    return result;
}

double InertialSolution::variance(std::size_t s, std::span<const PointGradient> gradients,
                                  CraftPoint point) const {
    assert(!gradients.empty() && s + gradients.size() <= epochs.size());
    double sum = std::visit(
        [&]<int N>(const JointErrors<N>& errors) {
            std::vector<Eigen::Matrix<double, 1, N>> rows(gradients.size());
            for (std::size_t i = 0; i < gradients.size(); ++i)
                rows[i] = gradients[i].position.transpose() *
                              position_gradient<N>(epochs[s + i], *joint, point) +
                          gradients[i].velocity.transpose() *
                              velocity_gradient<N>(epochs[s + i], *joint, point);
            return errors.variance(s, rows);
        },
        joint->errors);
    Eigen::RowVector3d by_arm = Eigen::RowVector3d::Zero();
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        const InertialEpoch& epoch = epochs[s + i];
        const Eigen::Matrix3d& c = epoch.enu_from_body;
        const Eigen::RowVector3d turning = gradients[i].velocity.transpose() * c;
        sum += joint->rate_variance * (turning * cross_matrix(arm_of(*joint, point))).squaredNorm();
        by_arm += gradients[i].position.transpose() * c + turning * cross_matrix(epoch.rate_rad_s);
    }
    if (point != CraftPoint::antenna)
        sum += joint->antenna_sigma_m * joint->antenna_sigma_m * by_arm.squaredNorm();
    return sum;
}

bool InertialSolution::bridged_between(std::size_t s, std::size_t e) const {
    return std::ranges::any_of(bridged, [&](const BridgedStretch& span) {
        return span.from_s < epochs[e].time_s && span.to_s > epochs[s].time_s;
    });
}

}  // namespace runcert
