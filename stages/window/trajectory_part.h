#pragma once

#include <span>
#include <vector>

#include "motion/kalman.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "stages/window/certify.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A part of an arc around a window. Distant epochs have no effect on the window, and an arc may be
/// of any length.
template <int Axes>
struct ArcPart {
    Arc<Axes> arc;
    std::vector<ElapsedTime> times;  ///< of its epochs
    EpochPair window;                ///< indices into its epochs
    bool whole = false;              ///< it is the whole arc
};

/// The window with up to `margin_s` of its arc before and after. It begins with a measured epoch.
template <int Axes>
ArcPart<Axes> part_around(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                          EpochPair window, double margin_s);

/// The model's memory (`memory_s`) for the noise and interval of the window's epochs.
template <int Axes>
double memory_s(const Arc<Axes>& arc, EpochPair window, const EstimationModel& model) {
    return memory_s<Axes>(std::span<const ArcEpoch<Axes>>(arc.epochs)
                              .subspan(window.first, window.last - window.first + 1),
                          model);
}

// Beyond a minute no measurement changes the speed of a window.
inline constexpr double stretch_margin_s = 60.0;

/// The arc around a window, smoothed again with the trajectory's own model.
template <int Axes>
struct CheckedPart {
    ArcPart<Axes> part;
    Chain<Axes> smoothed;
};

/// The part of the arc that determines the window, confirmed to agree with the trajectory at the
/// window's epochs. Failure if it does not, even with the whole arc.
template <int Axes>
CheckedPart<Axes> checked_estimate(const AxesEstimate<Axes>& estimate, const FoundWindow& found);

/// Compares the robust solution's speed between the epochs that enclose a window with the screened
/// solution's (`smoothed`, for the part of the arc), which has the same noise model. Empty if
/// the trajectory has no robust solution there.
///
/// They agree within twice the sum of the screened speed's standard uncertainty and `model_m_s`,
/// the change of the speed under other motion models. Where the craft moves harder than its model
/// allows, the two estimates distribute the residuals differently.
std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const Chain<2>& smoothed, double model_m_s);

}  // namespace runcert
