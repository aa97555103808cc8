#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <optional>
#include <vector>

#include "inertial/inertial_filter.h"

namespace runcert {

/// The smoothed covariances and gains of a solution.
struct JointErrors {
    std::vector<ErrorMatrix> covariance;
    std::vector<ErrorMatrix> gain;
    std::vector<LaterPosition> later;

    /// Variance of the sum of gradients[i] x_{s+i}. The cost is linear in their number.
    double variance(std::size_t s, const std::vector<ErrorRow>& gradients) const {
        double sum = 0.0;
        ErrorRow carried = gradients[0];
        for (std::size_t i = 0; i < gradients.size(); ++i) {
            sum += carried.dot(carried * covariance[s + i]);
            if (i + 1 == gradients.size()) break;
            const ErrorRow next = carried * gain[s + i];
            sum -= next.dot(next * covariance[s + i + 1]);
            carried = gradients[i + 1] + next;
        }
        return sum;
    }

    /// Covariance of b' x_e - a' x_s, with columns of gradients a and b: the errors are a Markov
    /// chain backwards, cov(x_s, x_e) = G_s ... G_{e-1} P_e.
    Eigen::Matrix3d difference(std::size_t s, const ErrorJacobian& a, std::size_t e,
                               const ErrorJacobian& b) const {
        ErrorJacobian carried = a;
        for (std::size_t k = s; k < e; ++k)
            carried = (carried * gain[k]).eval();
        const Eigen::Matrix3d cross = carried * covariance[e] * b.transpose();
        const Eigen::Matrix3d sum = a * covariance[s] * a.transpose() +
                                    b * covariance[e] * b.transpose() - cross - cross.transpose();
        return 0.5 * (sum + sum.transpose());
    }

    /// Deviation and covariance of b' x_e - a' x_s if the measurements of the epochs from s to e
    /// had not been taken, and all later ones were displaced by one unknown vector. `seen(k)` gives
    /// that of epoch k as the function of the errors that it measures, its covariance and its
    /// residual.
    template <class Seen>
    std::optional<PointDisplacement> without(std::size_t s, const ErrorJacobian& a, std::size_t e,
                                             const ErrorJacobian& b, const Seen& seen) const {
        ErrorVector mean = ErrorVector::Zero();
        ErrorMatrix own = covariance[e];
        Eigen::Vector3d end_mean = Eigen::Vector3d::Zero();
        Eigen::Matrix3d end = b * own * b.transpose();
        ErrorColumns cross = own * b.transpose();
        const auto take_out = [&](const ErrorJacobian& h, const Eigen::Matrix3d& measured,
                                  const Eigen::Vector3d& residual) {
            const ErrorJacobian hp = h * own;
            const Eigen::LLT<Eigen::Matrix3d> factor(measured - hp * h.transpose());
            if (factor.info() != Eigen::Success) return false;
            const Eigen::Vector3d innovation = residual - h * mean;
            const Eigen::Matrix3d h_cross = h * cross;
            mean -= hp.transpose() * factor.solve(innovation);
            end_mean -= h_cross.transpose() * factor.solve(innovation);
            end += h_cross.transpose() * factor.solve(h_cross);
            cross += hp.transpose() * factor.solve(h_cross);
            own += hp.transpose() * factor.solve(hp);
            return true;
        };
        // A displacement of all later positions takes what they say of this one with it.
        const LaterPosition& after = later[e];
        const Eigen::Matrix3d of_position = after.information.middleRows<3>(error_state::position);
        const Eigen::LLT<Eigen::Matrix3d> root(0.5 * (of_position + of_position.transpose()));
        if (root.info() == Eigen::Success) {
            const Eigen::Matrix3d whitened = Eigen::Matrix3d(root.matrixL()).inverse();
            if (!take_out(whitened * after.information.transpose(), Eigen::Matrix3d::Identity(),
                          whitened * after.vector))
                return std::nullopt;
        }
        for (std::size_t k = e;; --k) {
            const auto [h, measured_m2, residual_m] = seen(k);
            if (!take_out(h, measured_m2, residual_m)) return std::nullopt;
            if (k == s) break;
            const ErrorMatrix& back = gain[k - 1];
            own = (back * (own - covariance[k]) * back.transpose() + covariance[k - 1]).eval();
            mean = (back * mean).eval();
            cross = (back * cross).eval();
        }
        const Eigen::Matrix3d a_cross = a * cross;
        const Eigen::Matrix3d sum = end + a * own * a.transpose() - a_cross - a_cross.transpose();
        return PointDisplacement{.enu_m = end_mean - a * mean,
                                 .covariance_m2 = 0.5 * (sum + sum.transpose())};
    }
};

class JointCovariance {
  public:
    std::vector<PositionFix> fixes;  ///< that took part, an epoch each
    JointErrors errors;
    Eigen::Vector3d reference_point_m;  ///< from the IMU
    Eigen::Vector3d antenna_m;          ///< as estimated
    double antenna_sigma_m = 0.0;       ///< 0 if it is estimated
    double rate_variance = 0.0;         ///< of a sample's angular rate, rad^2/s^2
};

}  // namespace runcert
