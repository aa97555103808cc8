#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "motion/speed.h"
#include "schemas/profile/declared.h"
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

/// The definition of a window's speed.
struct SpeedQuantity {
    SpeedDefinition definition = SpeedDefinition::displacement;
    /// For elapsed_time: the length, and the unit normals (east, north), along the course, of the
    /// lines crossed at the window's two ends.
    double length_m = 0.0;
    Eigen::Vector2d start_normal = Eigen::Vector2d::Zero();
    Eigen::Vector2d finish_normal = Eigen::Vector2d::Zero();
    /// For path_length: the window ends where the path has reached a given length. An error of the
    /// path is then one of time, at the speed of the window's slower end.
    bool length_is_given = false;
    /// The displacement between the unsmoothed measured positions at the window's ends.
    bool of_samples = false;
};

/// Speed of the window by a definition, with its uncertainty from the joint covariance of all
/// states that it depends on. Horizontal; for heights alone (Axes 1) vertical, and not for a
/// course.
template <int Axes>
SpeedEstimate speed_by_definition(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                                  const SpeedQuantity& quantity);

/// The gradients of that speed with respect to the states, and the index of the first state.
template <int Axes>
struct SpeedGradients {
    std::size_t from = 0;
    Gradients<Axes> gradients;
};
template <int Axes>
SpeedGradients<Axes> speed_gradients(const Chain<Axes>& smoothed, EpochPair window,
                                     double duration_s, const SpeedQuantity& quantity);

}  // namespace runcert
