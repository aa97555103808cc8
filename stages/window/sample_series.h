#pragma once

#include <vector>

#include "estimation/tables/certifiable.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/window/best_window.h"

namespace runcert {

/// The search that a profile asks for. A course is not searched for: see crossings.h.
WindowCriteria window_criteria(const Profile& profile, double duration_tolerance_s,
                               double nominal_interval_s);

/// The longest step of time (s) that a window of the profile may hold beside what screening joins:
/// by the rule's rate of epochs, where a clause asks for one; and regular steps where the speed is
/// a mean of the epochs' speeds, which gaps would weight wrongly. Empty where there is no such
/// limit.
std::optional<double> longest_step_of(const Profile& profile, double nominal_interval_s);

/// The horizontal speed of a velocity, its vertical speed, or its speed in space; the standard
/// uncertainty of it, first order, empty where one is missing.
struct RecordedSpeed {
    double speed_m_s = 0.0;
    std::optional<double> standard_uncertainty_m_s;
};

/// What an epoch's recorded velocity says of the speed, or its recorded speed where it has no
/// course; empty where one is missing.
std::optional<RecordedSpeed> recorded_speed(const RecordedVelocity& velocity, Dimension dimension);

/// The arcs of a trajectory as the profile counts them, in order: positions without the offsets of
/// bridged steps, and speeds, of the smoothed trajectory; or, where the profile takes recorded
/// velocities, speeds as recorded and the path that they make. Heights of a vertical speed are
/// above the ellipsoid. Unusable epochs, missing values, and bridged steps where the profile does
/// not allow them, are obstacles.
std::vector<SampleSeries> certifiable_series(const ScreenedTable& screened,
                                             const TrajectoryTable& trajectory,
                                             const std::vector<ArcRows>& arcs,
                                             const Profile& profile);

/// The whole recording as it is, one series without obstacles, and the rows it is made of: those
/// with a fix and the values that the profile counts, their times increasing. None where there are
/// none.
struct IndicatedSeries {
    std::vector<SampleSeries> series;
    std::vector<std::size_t> rows;
};
IndicatedSeries indicated_series(const ScreenedTable& screened, const Profile& profile);

}  // namespace runcert
