#pragma once

#include <Eigen/Core>

namespace runcert {

// Accuracy measures of a zero-mean normal error in the plane, after [NAV]. The printed tables hold
// for circles; these functions hold for any covariance, degenerate ones included. Unit of a radius:
// that of the standard deviations. All fail (at "covariance" or "radius") on a radius that is
// negative, and on a covariance that is not finite, not symmetric (to 1e-9 of its largest element)
// or has an eigenvalue below -1e-12 of its largest. An error that is exactly zero is within every
// radius.

/// P(|x| <= radius). To 1e-12, by quadrature over the smaller axis.
double probability_within(const Eigen::Matrix2d& covariance, double radius);

/// The radius that holds 95 % of the errors.
double r95(const Eigen::Matrix2d& covariance);

}  // namespace runcert
