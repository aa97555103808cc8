#pragma once

#include <span>
#include <vector>

#include "estimation/kalman.h"
#include "witness/arcs.h"
#include "witness/window_ends.h"

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

/// What the model remembers (`memory_s`) with the noise and the interval of the window's epochs.
template <int Axes>
double memory_s(const Arc<Axes>& arc, EpochPair window, const EstimationModel& model) {
    return memory_s<Axes>(std::span<const ArcEpoch<Axes>>(arc.epochs)
                              .subspan(window.first, window.last - window.first + 1),
                          model);
}

}  // namespace runcert
