#pragma once

#include <Eigen/Core>

#include "schemas/observations/observations.h"

namespace runcert {

/// The covariance (m^2) that a stated standard deviation stands for; what is not stated counts as
/// zero. Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy);

}  // namespace runcert
