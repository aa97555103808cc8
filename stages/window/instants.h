#pragma once

#include "stages/window/best_window.h"
#include "stages/window/course_windows.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A window within a stretch of an arc, cut so that everything relevant is included.
template <int Axes>
struct WindowStretch {
    std::vector<ArcEpoch<Axes>> epochs;
    EpochPair window;  ///< indices into the epochs
    double duration_s = 0.0;
    std::size_t first = 0;  ///< index of the arc's epoch at which the stretch begins
};

/// The first and the last epoch of the arc within `margin_s` of a window; the first one measured.
template <int Axes>
EpochPair reach_around(const Arc<Axes>& arc, EpochPair window, double margin_s);

/// The window with up to `margin_s` of its arc before and after. It begins with a measured epoch.
template <int Axes>
WindowStretch<Axes> cut_stretch(const Arc<Axes>& arc, EpochPair window, double margin_s);

/// An arc with epochs, without a measurement, added at the two ends of a window, so that it has
/// smoothed states at these instants. An end at an existing epoch uses that epoch.
template <int Axes>
struct ArcWithInstants {
    Arc<Axes> arc;     ///< an added epoch has the row of the epoch before it
    EpochPair window;  ///< indices of the two instants
};

/// Adds the instants to an arc, within which they must lie. `times` are those of the arc's epochs,
/// in whole nanoseconds.
template <int Axes>
ArcWithInstants<Axes> with_instants(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                                    ElapsedTime start, ElapsedTime end);

/// The unit normal of a gate in the direction of the course (east, north).
Eigen::Vector2d along_course(const SurveyedLine& gate);

/// The instants at which a track crosses the start and the finish gate.
struct CrossingTimes {
    ElapsedTime start, end;
};

/// The crossings of the two gates by the smoothed track, starting from `straight`, those of
/// straight lines between its epochs (three Newton iterations).
CrossingTimes smoothed_crossings(const Arc<2>& arc, const std::vector<ElapsedTime>& times,
                                 const EstimationModel& model, const CrossingTimes& straight,
                                 const SurveyedLine& start, const SurveyedLine& finish);

}  // namespace runcert
