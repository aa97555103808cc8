#pragma once

#include <vector>

#include "arcs/arcs.h"
#include "arcs/window_ends.h"

namespace runcert {

/// A part of an arc with a window in it: what is far from a window changes nothing of it, and an
/// arc may be of any length.
template <int Axes>
struct ArcPart {
    Arc<Axes> arc;
    std::vector<ElapsedTime> times;  ///< of its epochs
    EpochPair window;                ///< indices into its epochs
    bool whole = false;              ///< it is all of the arc
};

/// The window with up to `margin_s` of its arc before and after; it begins with a measured epoch.
template <int Axes>
ArcPart<Axes> part_around(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                          EpochPair window, double margin_s);

/// Time (s) over which an estimate under the model forgets what was before by a factor of 1e12,
/// twelve digits of the distance of what is supposed there from what is: 28 times the longest time
/// constant of the filter, which is below the correlation time of the slow error, two intervals,
/// and twice the times in which the motion becomes as uncertain as white noise and slow error leave
/// it ((density / jerk density)^(1/3), the pole of the steady filter of third order). White noise
/// and interval are those of the window.
template <int Axes>
double memory_s(const Arc<Axes>& arc, EpochPair window, const EstimationModel& model);

}  // namespace runcert
