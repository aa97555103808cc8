#pragma once

#include <span>

#include "estimation/kalman.h"

namespace runcert {

/// Time (s) over which an estimate under the model forgets what was before by a factor of 1e12,
/// twelve digits of the distance of what is supposed there from what is: 28 times the longest time
/// constant of the filter, which is below the correlation time of the time-correlated error, two
/// intervals, and twice the times in which the motion becomes as uncertain as white noise and
/// time-correlated error leave it ((density / jerk density)^(1/3), the pole of the steady filter of
/// third order). White noise, at its largest, and mean interval are those of the epochs, of which
/// there must be two.
template <int Axes>
double memory_s(std::span<const ArcEpoch<Axes>> epochs, const EstimationModel& model);

}  // namespace runcert
