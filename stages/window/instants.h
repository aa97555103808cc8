#pragma once

#include "stages/window/best_window.h"
#include "stages/window/course_windows.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// An arc with epochs, without a measurement, at the two ends of a window: the smoothed states
/// there are those of the instants. Where an end is at an epoch already, that is taken.
template <int Axes>
struct ArcWithInstants {
    Arc<Axes> arc;     ///< an added epoch has the row of the epoch before it
    EpochPair window;  ///< indices of the two instants
};

/// `times` are those of the arc's epochs, whole nanoseconds. The instants must lie in the arc.
template <int Axes>
ArcWithInstants<Axes> with_instants(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                                    ElapsedTime start, ElapsedTime end);

/// The unit normal of a gate, in the direction of the course (east, north).
Eigen::Vector2d along_course(const SurveyedLine& gate);

/// The instants at which the smoothed track crosses the two gates, from those that straight lines
/// between its epochs give (three steps of Newton's method). Failure where the track there runs
/// along a gate.
struct CrossingTimes {
    ElapsedTime start, end;
};
CrossingTimes smoothed_crossings(const Arc<2>& arc, const std::vector<ElapsedTime>& times,
                                 const EstimationModel& model, const CrossingTimes& straight,
                                 const SurveyedLine& start, const SurveyedLine& finish);

}  // namespace runcert
