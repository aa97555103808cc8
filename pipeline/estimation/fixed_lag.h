#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// Fixed-lag smoother [YSM22]: the state of each epoch k of an arc given the measurements up to
/// epoch k + lag, or to the arc's end where that comes first. What an estimate with a delay of so
/// many epochs would know; lag 0 is the filter, a lag of the arc's length or more the smoother.
///
/// One RTS recursion for each epoch, from k + lag back to k: the cost is that of `lag` smoother
/// steps an epoch. Times must increase strictly; the first epoch must have a measurement. An arc
/// without an epoch has no states. Repairs and Failures are those of `smooth`.
template <int Axes>
std::vector<StateEstimate<Axes>> smooth_fixed_lag(std::span<const ArcEpoch<Axes>> arc,
                                                  const EstimationModel& model, std::size_t lag);

}  // namespace runcert
