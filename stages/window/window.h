#pragma once

#include <vector>

#include "estimation/motion_model.h"
#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// The figures of the window search; `parameters.window` in `schemas/attempt/v1.yaml`, and the
/// motion model that the trajectory was estimated with.
struct WindowConfig {
    double duration_tolerance_s = 0.0;
    MotionModel model;
};

WindowConfig window_config(const Attempt& attempt, const TrajectoryTable& trajectory);

/// For each profile the best certifiable window of the smoothed trajectory, and the fastest one
/// that the raw positions indicate.
///
/// A certifiable window begins and ends at usable epochs of one arc, holds no unusable epoch, and
/// is as long as the rule says (to the tolerance; where no epoch is exactly so far, the next one).
/// Its speed is by the profile's definition, its uncertainty that of the displacement, from the
/// joint covariance of both ends, computed anew from the screened epochs and multiplied by the
/// trajectory's variance factor. Failure where that new estimate is not the trajectory's.
Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config);

/// The fastest window of the raw positions over `duration_s`, by displacement, certifiable or not,
/// with a sentence for each reason why it cannot be certified.
std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened, double duration_s,
                                                 const WindowConfig& config);

}  // namespace runcert
