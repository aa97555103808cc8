#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/speed.h"
#include "schemas/profile/declared.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A window within a stretch of an arc, cut so that what lies beyond changes nothing that counts.
template <int Axes>
struct WindowStretch {
    std::vector<ArcEpoch<Axes>> epochs;
    EpochPair window;  ///< indices into the epochs
    double duration_s = 0.0;
    std::size_t first = 0;  ///< index of the arc's epoch that the stretch begins with
};

/// The first and the last epoch of the arc within `margin_s` of a window; the first one measured.
template <int Axes>
EpochPair reach_around(const Arc<Axes>& arc, EpochPair window, double margin_s);

/// The window with that much of its arc before and after.
template <int Axes>
WindowStretch<Axes> cut_stretch(const Arc<Axes>& arc, EpochPair window, double margin_s);

/// Which speed of a window is meant.
struct SpeedQuantity {
    SpeedDefinition definition = SpeedDefinition::displacement;
    /// Of elapsed_time: the length, and the unit normals (east, north), along the course, of the
    /// lines that are crossed at the window's two ends.
    double length_m = 0.0;
    Eigen::Vector2d start_normal = Eigen::Vector2d::Zero();
    Eigen::Vector2d finish_normal = Eigen::Vector2d::Zero();
    /// Of path_length: the window ends where the path has reached a length, so that an error of
    /// the path is one of the time at the speed of its slower end.
    bool length_is_given = false;
    /// The displacement between the measured positions at the window's ends, as they are.
    bool of_samples = false;
};

/// Speed of the window by a definition, with its uncertainty from the joint covariance of all
/// states that it rests on. Horizontal; of heights alone (Axes 1) vertical, and not of a course.
template <int Axes>
SpeedEstimate speed_by_definition(const SmoothedArc<Axes>& smoothed, EpochPair window,
                                  double duration_s, const SpeedQuantity& quantity);

/// The gradients of that speed, and the state that they begin with.
template <int Axes>
struct SpeedGradients {
    std::size_t from = 0;
    Gradients<Axes> gradients;
};
template <int Axes>
SpeedGradients<Axes> speed_gradients(const SmoothedArc<Axes>& smoothed, EpochPair window,
                                     double duration_s, const SpeedQuantity& quantity);

}  // namespace runcert
