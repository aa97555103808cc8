#pragma once

#include <Eigen/Core>

namespace runcert {

// Accuracy measures of a zero-mean normal error in the plane, after [NAV]. The printed tables hold
// for circular errors. These functions take any covariance, degenerate ones included. Radii have
// the unit of the standard deviations.
//
// All throw Failure (at "covariance" or "radius") where the radius is negative. They also do so
// where the covariance is not finite, is not symmetric (to 1e-9 of its largest element), or has an
// eigenvalue below -1e-12 of its largest. An error that is exactly zero lies within every radius.

/// P(|x| <= radius), to 1e-12, by quadrature over the smaller principal axis.
double probability_within(const Eigen::Matrix2d& covariance, double radius);

/// The radius of the circle that holds 95 % of the errors.
double r95(const Eigen::Matrix2d& covariance);

}  // namespace runcert
