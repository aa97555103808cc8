#include "inertial/joint_covariance.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
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
ErrorJacobian position_gradient(const InertialEpoch& epoch, const JointCovariance& joint,
                                CraftPoint point) {
    ErrorJacobian h = point_jacobian(epoch.enu_from_body, arm_of(joint, point),
                                     motion_of(epoch, point).velocity_m_s);
    if (point == CraftPoint::antenna) h.middleCols<3>(error_state::lever_arm) = epoch.enu_from_body;
    return h;
}

ErrorJacobian velocity_gradient(const InertialEpoch& epoch, const JointCovariance& joint,
                                CraftPoint point) {
    ErrorJacobian h =
        point_velocity_jacobian(epoch.enu_from_body, arm_of(joint, point), epoch.rate_rad_s);
    if (point == CraftPoint::antenna)
        h.middleCols<3>(error_state::lever_arm) =
            epoch.enu_from_body * cross_matrix(epoch.rate_rad_s);
    return h;
}

/// The filter's errors after a position.
struct Updated {
    ErrorVector mean;
    ErrorMatrix covariance;
};
Updated updated(const ErrorVector& mean, const ErrorMatrix& covariance,
                const PositionInnovation& seen) {
    const ErrorJacobian hp = seen.h * covariance;
    const Eigen::LLT<Eigen::Matrix3d> factor(hp * seen.h.transpose() + seen.covariance_m2);
    return {mean + hp.transpose() * factor.solve(seen.residual_m - seen.h * mean),
            covariance - hp.transpose() * factor.solve(hp)};
}

}  // namespace

StretchErrors::StretchErrors(InertialPass& pass)
    : predicted(std::move(pass.predicted)),
      predicted_covariance(std::move(pass.predicted_covariance)),
      transition(std::move(pass.transition)),
      positions(std::move(pass.innovations)),
      smoothed(std::move(pass.estimated)),
      later(predicted.size()) {
    for (std::size_t k = later.size() - 1; k-- > 0;) {
        const PositionInnovation& seen = positions[k + 1];
        const ErrorColumns weighted = seen.covariance_m2.llt().solve(seen.h).transpose();
        const ErrorMatrix information = later[k + 1].information + weighted * seen.h;
        const ErrorVector vector = later[k + 1].vector + weighted * seen.residual_m;
        const Updated here = updated(predicted[k], predicted_covariance[k], positions[k]);
        const ErrorMatrix& phi = transition[k];
        const ErrorMatrix noise =
            predicted_covariance[k + 1] - phi * here.covariance * phi.transpose();
        const ErrorVector moved = predicted[k + 1] - phi * here.mean;
        const Eigen::PartialPivLU<ErrorMatrix> factor(ErrorMatrix::Identity() +
                                                      information * noise);
        const ErrorMatrix carried = phi.transpose() * factor.solve(information) * phi;
        later[k] = {0.5 * (carried + carried.transpose()),
                    phi.transpose() * factor.solve(vector - information * moved)};
    }
}

PointDisplacement StretchErrors::without(std::size_t s, const ErrorJacobian& a, std::size_t e,
                                         const ErrorJacobian& b) const {
    ErrorVector mean = predicted[s];
    ErrorMatrix covariance = predicted_covariance[s];
    const ErrorColumns begin = covariance * a.transpose();
    ErrorColumns cross = begin;
    for (std::size_t k = s; k < e; ++k) {
        const Updated with = updated(predicted[k], predicted_covariance[k], positions[k]);
        const ErrorMatrix& phi = transition[k];
        mean = (predicted[k + 1] + phi * (mean - with.mean)).eval();
        covariance =
            (predicted_covariance[k + 1] + phi * (covariance - with.covariance) * phi.transpose())
                .eval();
        cross = (phi * cross).eval();
    }
    ErrorMatrix information = later[e].information;
    ErrorVector vector = later[e].vector;
    // A displacement of all later positions takes what they say of this one with it.
    const ErrorColumns of_position = information.middleCols<3>(error_state::position);
    const Eigen::LLT<Eigen::Matrix3d> root(of_position.middleRows<3>(error_state::position));
    if (root.info() == Eigen::Success) {
        vector -= of_position * root.solve(vector.segment<3>(error_state::position));
        information -= of_position * root.solve(of_position.transpose());
    }
    const ErrorJacobian by_end = b * covariance - cross.transpose();
    const Eigen::PartialPivLU<ErrorMatrix> factor(ErrorMatrix::Identity() +
                                                  information * covariance);
    const Eigen::Matrix3d a_cross = b * cross;
    const Eigen::Matrix3d variance = b * covariance * b.transpose() + a * begin - a_cross -
                                     a_cross.transpose() -
                                     by_end * factor.solve(information * by_end.transpose());
    return {.enu_m = b * (mean - smoothed[e]) - a * (predicted[s] - smoothed[s]) +
                     by_end * factor.solve(vector - information * mean),
            .covariance_m2 = 0.5 * (variance + variance.transpose())};
}

PointDisplacement InertialSolution::displacement(std::size_t s, std::size_t e,
                                                 CraftPoint point) const {
    assert(s < e && e < epochs.size());
    PointDisplacement result{.enu_m = motion_of(epochs[e], point).position_m -
                                      motion_of(epochs[s], point).position_m};
    result.covariance_m2 = joint->errors.difference(s, position_gradient(epochs[s], *joint, point),
                                                    e, position_gradient(epochs[e], *joint, point));
    // The IMU lies where the antenna is seen, so that an error of the arm between them moves every
    // point but the antenna as the craft turns.
    if (point != CraftPoint::antenna) {
        const Eigen::Matrix3d turned = epochs[e].enu_from_body - epochs[s].enu_from_body;
        result.covariance_m2 +=
            joint->antenna_sigma_m * joint->antenna_sigma_m * turned * turned.transpose();
    }
    return result;
}

PointDisplacement InertialSolution::swing(std::size_t s, std::size_t e) const {
    assert(s < e && e < epochs.size());
    const auto swings = [](const InertialEpoch& epoch) -> Eigen::Vector3d {
        return epoch.antenna.velocity_m_s - epoch.reference_point.velocity_m_s;
    };
    const auto arm = [](const InertialEpoch& epoch) -> Eigen::Vector3d {
        return epoch.antenna.position_m - epoch.reference_point.position_m;
    };
    PointDisplacement result{.enu_m = arm(epochs[e]) - arm(epochs[s])};
    const auto gradient = [&](std::size_t k) -> ErrorJacobian {
        return position_gradient(epochs[k], *joint, CraftPoint::antenna) -
               position_gradient(epochs[k], *joint, CraftPoint::reference_point);
    };
    result.covariance_m2 = joint->errors.difference(s, gradient(s), e, gradient(e));
    const Eigen::Matrix3d turned = epochs[e].enu_from_body - epochs[s].enu_from_body;
    result.covariance_m2 +=
        2.0 * joint->antenna_sigma_m * joint->antenna_sigma_m * turned * turned.transpose();
    if (time_offset_s.sigma > 0.0) return result;
    const Eigen::Vector3d later_m = unseen_lag_s * (swings(epochs[e]) - swings(epochs[s]));
    result.covariance_m2 += later_m * later_m.transpose();
    return result;
}

PointDisplacement InertialSolution::displacement_by_imu(std::size_t s, std::size_t e) const {
    assert(s < e && e < epochs.size());
    PointDisplacement found =
        joint->stretch.without(s, position_gradient(epochs[s], *joint, CraftPoint::antenna), e,
                               position_gradient(epochs[e], *joint, CraftPoint::antenna));
    found.enu_m += epochs[e].antenna.position_m - epochs[s].antenna.position_m;
    // Without a position there, the antenna is as far from the IMU as the declared arm says.
    const Eigen::Matrix3d turned = epochs[e].enu_from_body - epochs[s].enu_from_body;
    found.covariance_m2 +=
        joint->antenna_sigma_m * joint->antenna_sigma_m * turned * turned.transpose();
    return found;
}

namespace {

/// A sum over a point's motion at successive epochs.
struct PointSum {
    std::span<const PointGradient> gradients;
    CraftPoint point;
    double sign = 1.0;
};

/// Variance of the sum of all these sums.
PointVariance variance_of(const InertialSolution& solution, std::size_t s,
                          std::span<const PointSum> sums) {
    const JointCovariance& joint = *solution.joint;
    const std::size_t count = sums.front().gradients.size();
    PointVariance variance;
    std::vector<ErrorRow> rows(count, ErrorRow::Zero());
    for (const PointSum& sum : sums)
        for (std::size_t i = 0; i < count; ++i) {
            const InertialEpoch& epoch = solution.epochs[s + i];
            rows[i] += sum.sign * (sum.gradients[i].position.transpose() *
                                       position_gradient(epoch, joint, sum.point) +
                                   sum.gradients[i].velocity.transpose() *
                                       velocity_gradient(epoch, joint, sum.point));
        }
    variance.by_errors = joint.errors.variance(s, rows);
    Eigen::RowVector3d by_arm = Eigen::RowVector3d::Zero();
    for (std::size_t i = 0; i < count; ++i) {
        const InertialEpoch& epoch = solution.epochs[s + i];
        const Eigen::Matrix3d& c = epoch.enu_from_body;
        Eigen::RowVector3d by_rate = Eigen::RowVector3d::Zero();
        for (const PointSum& sum : sums) {
            const Eigen::RowVector3d turning = sum.sign * sum.gradients[i].velocity.transpose() * c;
            by_rate += turning * cross_matrix(arm_of(joint, sum.point));
            // The antenna is where the positions are, however long the arm.
            if (sum.point != CraftPoint::antenna)
                by_arm += sum.sign * sum.gradients[i].position.transpose() * c +
                          turning * cross_matrix(epoch.rate_rad_s);
        }
        variance.by_errors += joint.rate_variance * by_rate.squaredNorm();
    }
    variance.by_arm = joint.antenna_sigma_m * joint.antenna_sigma_m * by_arm.squaredNorm();
    return variance;
}

}  // namespace

double InertialSolution::variance(std::size_t s, std::span<const PointGradient> gradients,
                                  CraftPoint point) const {
    assert(!gradients.empty() && s + gradients.size() <= epochs.size());
    const PointVariance found = variance_of(*this, s, std::array{PointSum{gradients, point}});
    return found.by_errors + found.by_arm;
}

PointVariance InertialSolution::difference_variance(
    std::size_t s, std::span<const PointGradient> of_reference,
    std::span<const PointGradient> of_antenna) const {
    assert(!of_reference.empty() && s + of_reference.size() <= epochs.size() &&
           of_antenna.size() == of_reference.size());
    return variance_of(*this, s,
                       std::array{PointSum{of_reference, CraftPoint::reference_point},
                                  PointSum{of_antenna, CraftPoint::antenna, -1.0}});
}

std::optional<std::pair<std::size_t, std::size_t>> InertialSolution::enclosing(double from_s,
                                                                               double to_s) const {
    constexpr double same_instant_s = 1e-7;
    const auto after =
        std::ranges::upper_bound(epochs, from_s + same_instant_s, {}, &InertialEpoch::time_s);
    const auto last =
        std::ranges::lower_bound(epochs, to_s - same_instant_s, {}, &InertialEpoch::time_s);
    if (after == epochs.begin() || last == epochs.end() || last < after) return std::nullopt;
    return std::pair{static_cast<std::size_t>(after - epochs.begin()) - 1,
                     static_cast<std::size_t>(last - epochs.begin())};
}

Eigen::Vector3d position_between(const InertialEpoch& before, const InertialEpoch& after,
                                 double time_s, CraftPoint point) {
    const PointMotion& from = motion_of(before, point);
    const PointMotion& to = motion_of(after, point);
    const double step_s = after.time_s - before.time_s;
    const double u = std::clamp((time_s - before.time_s) / step_s, 0.0, 1.0);
    const double v = 1.0 - u;
    return v * v * (1.0 + 2.0 * u) * from.position_m + u * u * (1.0 + 2.0 * v) * to.position_m +
           u * v * step_s * (v * from.velocity_m_s - u * to.velocity_m_s);
}

bool InertialSolution::bridged_between(std::size_t s, std::size_t e) const {
    return std::ranges::any_of(bridged, [&](const BridgedStretch& span) {
        return span.from_s < epochs[e].time_s && span.to_s > epochs[s].time_s;
    });
}

}  // namespace runcert
