#pragma once

#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"

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
/// velocities, speeds as recorded, the path that they make, and positions of the same moments.
/// Heights of a vertical speed are above the ellipsoid. Speeds of other moments
/// (`velocities_of_other_moments`), unusable epochs, missing values, and bridged steps where the
/// profile does not allow them, are obstacles.
std::vector<SampleSeries> certifiable_series(const ScreenedTable& screened,
                                             const TrajectoryTable& trajectory,
                                             const std::vector<ArcRows>& arcs,
                                             const Profile& profile);

/// The recording as it is, without obstacles: rows with the values that the profile counts. Single
/// positions that those around them contradict show nothing, nor do epochs that repeat another.
struct IndicatedSeries {
    std::vector<SampleSeries> series;
    std::vector<std::vector<std::size_t>> rows;  ///< that each series is made of
    std::vector<std::size_t> jumps;              ///< rows that the clock jumps before, by pace
};

/// In the order of time, one series of what is not out of time; and a series for each run of far
/// positions, of those that the receiver calls no fix, and of those whose accuracy is absurd, as
/// long as they go on from one to the next. None where nothing shows anything.
IndicatedSeries indicated_series(const ScreenedTable& screened, const Profile& profile,
                                 double gap_factor);

/// In the order of the recording, the epochs out of time among them, as if the clock had not
/// jumped: one interval in place of each step of the stamps where the positions go on as in one
/// (`clock_jumped`; from and to an epoch out of time `goes_on`). None where the clock does not
/// jump.
IndicatedSeries indicated_by_pace(const ScreenedTable& screened, const Profile& profile,
                                  double gap_factor);

}  // namespace runcert
