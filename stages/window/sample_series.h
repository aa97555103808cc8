#pragma once

#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "stages/window/best_window.h"
#include "stages/window/counted_part.h"
#include "witness/certifiable.h"
#include "witness/recorded_velocities.h"

namespace runcert {

/// The search criteria of a profile. Courses are handled separately (course_windows.h).
WindowCriteria window_criteria(const Profile& profile, double duration_tolerance_s,
                               double nominal_interval_s);

/// The longest time step (s) allowed in a window of the profile, in addition to screening's limit.
/// It follows from the rule's rate of epochs, where a clause requires one. Regular steps are also
/// needed where the speed is a mean of the epochs' speeds, which gaps would weight unevenly. Empty
/// if there is no such limit.
std::optional<double> longest_step_of(const Profile& profile, double nominal_interval_s);

/// The speed from an epoch's recorded velocity, or its recorded speed where it has no course. Empty
/// if a needed value is missing.
std::optional<RecordedSpeed> recorded_speed(const RecordedVelocity& velocity, Dimension dimension);

/// Which positions a series has: those of the smoothed trajectory, or those recorded at the same
/// epochs.
enum class SeriesPositions { smoothed, recorded };

/// The arcs of a trajectory as series of the quantities that the profile counts, in order.
///
/// From the smoothed trajectory they are positions and speeds. Where the profile uses recorded
/// velocities, they are the recorded speeds, the path integrated from them, and positions at the
/// same moments. Vertical speeds use ellipsoidal heights. Obstacles are speeds of other moments or
/// refused (`velocities_left_out`), unusable epochs, and missing values.
std::vector<SampleSeries> certifiable_series(const ScreenedTable& screened,
                                             const TrajectoryTable& trajectory,
                                             const std::vector<ArcRows>& arcs,
                                             const Profile& profile,
                                             SeriesPositions positions = SeriesPositions::smoothed);

/// The recording as it is, without obstacles: rows with the values that the profile counts. Single
/// positions that their neighbours contradict are ignored, as are epochs that repeat another.
struct IndicatedSeries {
    std::vector<SampleSeries> series;
    std::vector<std::vector<std::size_t>> rows;  ///< rows behind each series
    std::vector<std::size_t> jumps;              ///< rows that a clock jump precedes, when ordered
                                                 ///< by pace
};

/// Series in order of time: one of all rows that are in time, plus one for each run of far
/// positions, of positions without a fix, and of those with absurd standard deviations, for as long
/// as these continue steadily. Empty if no row shows anything.
IndicatedSeries indicated_series(const ScreenedTable& screened, const Profile& profile,
                                 double gap_factor);

/// Series in the order of the recording, epochs out of time included, with clock jumps removed. A
/// step of the stamps counts as one interval where the positions continue as in one
/// (`clock_jumped`; from and to an epoch out of time `continues`). Empty if the clock does not
/// jump.
IndicatedSeries indicated_by_pace(const ScreenedTable& screened, const Profile& profile,
                                  double gap_factor);

/// Lets windows of recorded series begin and end only in the part (`restrict_to`), by the times of
/// their rows.
void restrict_to(const std::optional<WindowPart>& part, const ScreenedTable& screened,
                 IndicatedSeries& indicated);

}  // namespace runcert
