#pragma once

#include <vector>

#include "stages/screen/screen.h"

namespace runcert {

/// Median of the innovation statistics over its expected value (the chi-squared median), at least
/// 1: by how much the errors' variance exceeds the stated one. Robust against the outliers that
/// the test is to find.
double robust_variance_factor(const std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                              const ScreenConfig& config);

/// The chi-squared test of the innovations along each arc, covariances multiplied by
/// `variance_factor`. Fills statistic and threshold of every epoch tested, marks the rejected, and
/// splits an arc where `restart_after` epochs in a row are rejected.
void test_innovations(std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                      double variance_factor, const ScreenConfig& config);

/// Renumbers arcs from 1, and takes those of fewer than `min_arc_epochs` usable epochs out.
void drop_short_arcs(std::vector<ScreenedEpoch>& rows, const ScreenConfig& config);

}  // namespace runcert
