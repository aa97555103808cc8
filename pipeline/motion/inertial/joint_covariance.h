#pragma once

#include <variant>

#include "inertial/inertial_filter.h"

namespace runcert {

/// The smoothed covariances and gains of a solution with N error states.
template <int N>
struct JointErrors {
    std::vector<ErrorMatrix<N>> covariance;
    std::vector<ErrorMatrix<N>> gain;

    /// Variance of the sum of gradients[i] x_{s+i}. The cost is linear in their number.
    double variance(std::size_t s,
                    const std::vector<Eigen::Matrix<double, 1, N>>& gradients) const {
        double sum = 0.0;
        Eigen::Matrix<double, 1, N> carried = gradients[0];
        for (std::size_t i = 0; i < gradients.size(); ++i) {
            sum += carried.dot(carried * covariance[s + i]);
            if (i + 1 == gradients.size()) break;
            const Eigen::Matrix<double, 1, N> next = carried * gain[s + i];
            sum -= next.dot(next * covariance[s + i + 1]);
            carried = gradients[i + 1] + next;
        }
        return sum;
    }

    /// Covariance of b' x_e - a' x_s, with columns of gradients a and b: the errors are a Markov
    /// chain backwards, cov(x_s, x_e) = G_s ... G_{e-1} P_e.
    Eigen::Matrix3d difference(std::size_t s, const Eigen::Matrix<double, 3, N>& a, std::size_t e,
                               const Eigen::Matrix<double, 3, N>& b) const {
        Eigen::Matrix<double, 3, N> carried = a;
        for (std::size_t k = s; k < e; ++k)
            carried = (carried * gain[k]).eval();
        const Eigen::Matrix3d cross = carried * covariance[e] * b.transpose();
        const Eigen::Matrix3d sum = a * covariance[s] * a.transpose() +
                                    b * covariance[e] * b.transpose() - cross - cross.transpose();
        return 0.5 * (sum + sum.transpose());
    }
};

class JointCovariance {
  public:
    std::variant<JointErrors<error_state::plain>, JointErrors<error_state::full>> errors;
    Eigen::Vector3d reference_point_m;  ///< from the IMU
    Eigen::Vector3d antenna_m;          ///< as estimated
    double antenna_sigma_m = 0.0;       ///< 0 if it is estimated
    double rate_variance = 0.0;         ///< of a sample's angular rate, rad^2/s^2
};

}  // namespace runcert
