#pragma once

#include <Eigen/Core>

#include "schemas/observations/declared.h"

namespace runcert {

/// The covariance (m^2) that a stated accuracy stands for; what is not stated counts as zero.
/// Axes: 1 (up alone), 2 (east, north) or 3 (all).
template <int Axes>
Eigen::Matrix<double, Axes, Axes> stated_covariance(const StatedAccuracy& accuracy);

/// Bad records of a recording that are listed one by one, at most.
constexpr std::size_t bad_records_listed_at_most = 1000;

}  // namespace runcert
