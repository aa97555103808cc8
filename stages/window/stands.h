#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inertial/still_spans.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "store/measured_series.h"

namespace runcert {

/// The stretches of a recording in which the craft stood, in order of time: by its IMU
/// (`still_spans`), or else by a wheel that does not turn for 10 s while smoothed positions are
/// slower than 0.2 m/s, or else by smoothed positions that stay within a metre for 30 s. Each has
/// what the measured positions moved in 3 s, beyond a steady movement: neither an IMU nor a wheel
/// that begins to count at some speed feels a craft that creeps.
std::vector<Stand> stands_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<StillSpan>& by_imu, const MeasuredSeries* wheel);

/// The standard deviation (m, of an axis) of the time-correlated position error that shows while
/// the craft stands. Over `lag_s` the positions then move by their errors alone, steady movement
/// apart: by twice the variance of the white noise, which is the stated one times the square of
/// `scale`, and by at most twice that of the correlated error.
///
/// Only stands that IMU or wheel show count, and only pairs of usable epochs of the fix type.
/// Empty if they last less than five times `lag_s`. Axes: 2, or 1 for heights.
template <int Axes>
std::optional<double> standing_error_m(const ScreenedTable& screened,
                                       const std::vector<Stand>& stands, FixType fix, double lag_s,
                                       double scale);

/// What the stands say of the stated standard deviations: some sentences, empty if nothing or if
/// they last less than 15 s. Stands by positions alone are mentioned only where these moved by more
/// than chance lets them once in a thousand.
std::string standing_text(const std::vector<Stand>& stands);

}  // namespace runcert
