#pragma once

#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "stages/window/best_window.h"
#include "stages/window/course_windows.h"

namespace runcert {

/// What an attempt states of the part of its recordings that counts.
struct PartStatements {
    std::optional<double> ground_height_m = std::nullopt;  ///< as the recording counts heights
    std::optional<StatedPart> part = std::nullopt;
};

/// The part of a recording in which the windows of a rule may lie. Empty if the rule counts all
/// of it.
///
/// Its ends are events of the usable epochs (of all, where none is usable), by their recorded
/// heights (above the ellipsoid or as the recording has them). Vertical speeds are the recorded
/// ones, or smoothed where none is recorded. A part that ends below a height ends at its last epoch
/// that is not yet lower. Its end is the first of the rule's events that are found, else the
/// recording's last epoch.
///
/// The ground's height is the attempt's, else that where the craft stood longest near its lowest
/// point, after the part begins if it stood there (median of the heights there). `missing` says
/// what was not found. Failure (at "attempt") if the rule needs a part that the attempt must state.
std::optional<WindowPart> counted_part(const ScreenedTable& screened,
                                       const TrajectoryTable& trajectory, const Profile& profile,
                                       const PartStatements& stated,
                                       const std::optional<SurveyedCourse>& gates);

/// Whether an instant lies in the part, its ends included. Nothing lies in one whose beginning was
/// not found.
bool lies_in(const std::optional<WindowPart>& part, ElapsedTime time);

/// Lets windows begin and end only in the part: sets `bounds`, by the times of the samples' rows.
void restrict_to(const std::optional<WindowPart>& part, const std::vector<ElapsedTime>& times,
                 SampleSeries& series);

}  // namespace runcert
