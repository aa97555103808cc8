#pragma once

#include "stages/window/arc_part.h"
#include "stages/window/certify.h"

namespace runcert {

// Beyond a minute nothing measured changes the speed of a window.
inline constexpr double stretch_margin_s = 60.0;

/// The arc around a window, smoothed anew with the trajectory's own model.
template <int Axes>
struct CheckedPart {
    ArcPart<Axes> part;
    SmoothedArc<Axes> smoothed;
};

/// As much of the arc as decides on the window, found to be the trajectory at the window's epochs.
/// Failure where it is not, even with the whole arc taken.
template <int Axes>
CheckedPart<Axes> checked_estimate(const AxesEstimate<Axes>& estimate, const FoundWindow& found);

}  // namespace runcert
