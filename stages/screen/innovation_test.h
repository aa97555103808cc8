#pragma once

#include <vector>

#include "stages/screen/screen.h"

namespace runcert {

/// Ratio of the median innovation statistic to its expected value (the chi-squared median), at
/// least 1: the factor by which the errors' variance exceeds the stated one. Robust against the
/// outliers that the test is to find.
double robust_variance_factor(const std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                              const ScreenConfig& config);

/// Chi-squared test of the innovations along each arc, with covariances multiplied by
/// `variance_factor`. Fills statistic and threshold of every tested epoch and marks the rejected
/// ones. Splits an arc where `restart_after` consecutive epochs are rejected.
void test_innovations(std::vector<ScreenedEpoch>& rows, bool vertical_measured,
                      double variance_factor, const ScreenConfig& config);

/// Renumbers arcs from 1, and removes those with fewer than `min_arc_epochs` usable epochs.
void drop_short_arcs(std::vector<ScreenedEpoch>& rows, const ScreenConfig& config);

}  // namespace runcert
