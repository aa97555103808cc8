#pragma once

#include "stages/window/best_window_sums.h"

namespace runcert {

/// All allowed windows of a series by a rule of time, distance or alpha, in order of
/// start.
WindowSearch windows_in(const SummedSeries& series, const WindowCriteria& rule);

/// The windows at any instant that begin at the end of a window of this series, and end at its
/// start: with those that begin or end at a sample, the fastest beside it is among them.
WindowSearch windows_beside(const SummedSeries& series, const WindowCriteria& rule,
                            const FoundWindow& found);

}  // namespace runcert
