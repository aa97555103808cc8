#pragma once

#include <string_view>
#include <vector>

#include "arcs/arcs.h"
#include "arcs/window_ends.h"
#include "estimation/speed.h"

namespace runcert {

/// A window within a stretch of an arc, cut so that what lies beyond changes nothing that counts.
struct WindowStretch {
    std::vector<ArcEpoch<2>> epochs;
    EpochPair window;  ///< indices into the epochs
    double duration_s = 0.0;
    std::size_t first = 0;  ///< index of the arc's epoch that the stretch begins with
};

/// The window with up to `margin_s` of its arc before and after; it begins with a measured epoch.
WindowStretch cut_stretch(const Arc<2>& arc, EpochPair window, double margin_s);

/// Horizontal speed of the window by a definition of the profile's schema ("displacement",
/// "path_length", "mean_n_plus_1", "mean_n"), with its uncertainty from the joint covariance of
/// all states that it rests on.
SpeedEstimate speed_by_definition(const SmoothedArc<2>& smoothed, EpochPair window,
                                  double duration_s, std::string_view definition);

}  // namespace runcert
