#pragma once

#include <span>
#include <vector>

#include "estimation/kalman.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/certify.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

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

/// The robust batch's speed between the epochs that enclose a window against the screened
/// solution's (`smoothed`, of the part of the arc), whose noise model is the same. Empty where the
/// trajectory has none there.
///
/// It agrees within twice the sum of the screened speed's standard uncertainty and `model_m_s`, by
/// how much other models of the motion change the speed: where the craft moves harder than its
/// model has it, the two estimates spread what is left over differently.
std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const SmoothedArc<2>& smoothed, double model_m_s);

}  // namespace runcert
