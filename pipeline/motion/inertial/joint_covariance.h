#pragma once

#include <vector>

#include "inertial/inertial_filter.h"

namespace runcert {

/// The smoothed covariances and gains of a solution.
struct JointErrors {
    std::vector<ErrorMatrix> covariance;
    std::vector<ErrorMatrix> gain;

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
};

/// What the positions after an epoch say of its errors: information, and information times
/// deviation.
struct LaterPositions {
    ErrorMatrix information = ErrorMatrix::Zero();
    ErrorVector vector = ErrorVector::Zero();
};

/// What solves a stretch again without its positions: the filter's errors before each, and the
/// information of those after it.
struct StretchErrors {
    std::vector<ErrorVector> predicted;
    std::vector<ErrorMatrix> predicted_covariance;
    std::vector<ErrorMatrix> transition;
    std::vector<PositionInnovation> positions;
    std::vector<ErrorVector> smoothed;  ///< deviation of the solution
    std::vector<LaterPositions> later;

    /// Takes all that a smoothed pass has and finds `later`, backwards [YSM22]: with a position
    /// L+ = L + H' R^-1 H, and over a step Phi' (L+^-1 + Q)^-1 Phi.
    explicit StretchErrors(InertialPass& pass);
    StretchErrors() = default;

    /// Deviation from the solution, and covariance, of b' x_e - a' x_s by the positions before s
    /// and those after e, which may all be displaced by one unknown vector.
    PointDisplacement without(std::size_t s, const ErrorJacobian& a, std::size_t e,
                              const ErrorJacobian& b) const;
};

class JointCovariance {
  public:
    JointErrors errors;
    StretchErrors stretch;
    Eigen::Vector3d reference_point_m;  ///< from the IMU
    Eigen::Vector3d antenna_m;          ///< as estimated
    double antenna_sigma_m = 0.0;       ///< 0 if it is estimated
    double rate_variance = 0.0;         ///< of a sample's angular rate, rad^2/s^2
};

}  // namespace runcert
