#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"

// Positions at the moments of recorded velocities, which may be behind them.

namespace runcert {

/// 1 for each of east, north and up that a speed of this dimension counts, else 0.
Eigen::Vector3d axes_of_speed(Dimension dimension);

/// By how much the recorded velocities are behind the positions, as far as screening tells; else 0.
double delay_of_velocities(const ScreenedTable& screened);

/// Standard uncertainty of that delay, s; of one that is not told, that of any that is looked for.
double sigma_of_delay(const ScreenedTable& screened);

/// Moves the positions of a series of recorded speeds to the moments of these: those of a delay
/// before, between samples by cubics. No window may begin or end where the series has none.
void move_to_moments(SampleSeries& series, double delay_s);

/// The smoothed track at the moment of a recorded speed: its speed, and the path since the sample
/// before.
struct TrackMoment {
    double speed_m_s = 0.0;
    double step_m = 0.0;
};

/// For each sample of an arc; empty where its moment lies before the first position or after the
/// last.
std::vector<std::optional<TrackMoment>> track_at_moments(const ScreenedTable& screened,
                                                         const TrajectoryTable& trajectory,
                                                         const ArcRows& arc, Dimension dimension);

/// A speed by the smoothed track over a window, and its standard uncertainty.
struct TrackSpeed {
    double speed_m_s = 0.0;
    double standard_uncertainty_m_s = 0.0;
};

/// The speed by the rule's definition of the smoothed positions at the moments of a window's
/// recorded speeds. A path is that of the cubics through positions and velocities, so that a turn
/// between epochs is not cut short; what it exceeds the chords by counts as bound of its error. The
/// uncertainty is that of both ends, or of the velocities if that is less and for means of speeds;
/// with the rule's floor for time-correlated errors at either end, and what the speed changes by
/// within the uncertainty of the delay.
TrackSpeed track_speed(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                       const ArcRows& arc, const Profile& profile, const FoundWindow& found);

}  // namespace runcert
