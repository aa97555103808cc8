#pragma once

#include <Eigen/Core>

namespace runcert {

// Accuracy measures of a zero-mean normal error, after [NAV]. The printed tables hold for
// circular and spherical covariances; these functions hold for any, degenerate ones included.
// Unit of a radius: that of the standard deviations. All fail (at "covariance", or "radius" and
// "probability") on a negative or non-finite standard deviation or radius, on a covariance that
// is not finite, not symmetric (to 1e-9 of its largest element) or has an eigenvalue below -1e-12
// of its largest, and on a probability outside [0, 1). An error that is exactly zero is within
// every radius.

/// P(|x| <= radius), x normal with this standard deviation.
double probability_within_1d(double sigma, double radius);

/// P(|x| <= radius), x normal in the plane. To 1e-12, by quadrature over the smaller axis.
double probability_within_2d(const Eigen::Matrix2d& covariance, double radius);

/// P(|x| <= radius), x normal in space. To 1e-12, by quadrature over the smaller axes.
double probability_within_3d(const Eigen::Matrix3d& covariance, double radius);

/// The radius that holds the error with this probability: the inverse of `probability_within_*`.
double radius_1d(double sigma, double probability);
double radius_2d(const Eigen::Matrix2d& covariance, double probability);
double radius_3d(const Eigen::Matrix3d& covariance, double probability);

/// Linear error probable: 50 % of the errors are within it, in one dimension.
double lep(double sigma);

/// 95 % of the errors are within it, in one dimension.
double r95_1d(double sigma);

/// Circular error probable: 50 %, in the plane.
double cep(const Eigen::Matrix2d& covariance);

/// 95 %, in the plane.
double r95(const Eigen::Matrix2d& covariance);

/// Root mean square distance in the plane, sqrt(trace), and twice that. The probability they hold
/// depends on the shape: 63.2 % and 98.2 % for a circle, 68.3 % and 95.4 % for a line.
double drms(const Eigen::Matrix2d& covariance);
double two_drms(const Eigen::Matrix2d& covariance);

/// Spherical error probable: 50 %, in space.
double sep(const Eigen::Matrix3d& covariance);

/// Mean radial spherical error: root mean square distance in space, sqrt(trace).
double mrse(const Eigen::Matrix3d& covariance);

}  // namespace runcert
