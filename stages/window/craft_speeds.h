#pragma once

#include <optional>

#include "inertial/inertial_smoother.h"
#include "schemas/profile/profile.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "witness/certifiable.h"

namespace runcert {

/// Calls `set` with each window found, and the id of its profile.
template <class Set>
void for_each_window(Windows& windows, const Set& set) {
    for (auto* const list : {&windows.profiles, &windows.with_files})
        for (ProfileWindows& found : *list) {
            if (found.best) set(*found.best, found.profile);
            if (found.fastest) set(*found.fastest, found.profile);
            for (FurtherWindow& further : found.further)
                set(further, found.profile);
        }
}

/// The epochs of an inertial solution that enclose a window. None where the solution is not
/// consistent, does not reach both ends, or only the IMU bridges a part of it.
std::optional<EpochPair> epochs_within(const InertialSolution& solution, const WindowSpan& span);

/// A stretch of time (s) over which the speeds of two points of the craft are compared, and by
/// which definition.
struct PointSpan {
    double from_s = 0.0;
    double to_s = 0.0;
    SpeedDefinition definition = SpeedDefinition::displacement;
    Dimension dimension = Dimension::horizontal;
};

/// By how much the craft's reference point is faster than the antenna, m/s, and the standard
/// uncertainties of that. The positions' errors are those of both and do not count.
struct CraftCorrection {
    double speed_m_s = 0.0;  ///< by the rule's definition; 0 where the ends are crossings of lines
    SpeedDefinitions definitions = {};  ///< by each definition
    double attitude_m_s = 0.0;          ///< by the attitude's errors
    double arm_m_s = 0.0;               ///< by those of the distances on the craft
    double arm_sigma_m = 0.0;           ///< of each component of these
    double lag_m_s_per_s = 0.0;         ///< change by the time that the attitude is late
    double lag_sigma_s = 0.0;           ///< of that time, beyond what the attitude's errors hold
};

/// The correction by the inertial solution. None where it is not consistent, does not cover the
/// span, or only the IMU bridges part of it.
std::optional<CraftCorrection> craft_correction(const InertialSolution& solution,
                                                const PointSpan& span);

/// The trajectory with the reference point in place of the antenna: what windows are searched in
/// where a rule counts the craft's speed. Rows that the solution does not reach, and the ends of
/// what only the IMU bridges, are not usable there.
TrajectoryTable at_reference_point(TrajectoryTable trajectory, const InertialSolution& solution);

/// The speed of a window at the antenna and at the reference point. Where the rule counts the
/// latter, it is the window's, with its expanded uncertainty as given. Else it is that of the
/// inertial solution by the same definition, with its expanded uncertainty (k = 2) from the joint
/// covariance of all epochs of the window, the distances on the craft and the IMU's clock: absent
/// where `craft_correction` gives nothing, of a course's length and of recorded velocities.
CraftSpeeds craft_speeds(const InertialSolution& solution, const Profile& profile,
                         const WindowSpan& span, double speed_m_s, double expanded_uncertainty_m_s);

/// Sets these speeds of all windows found.
void add_craft_speeds(const InertialSolution& solution, const std::vector<Profile>& profiles,
                      Windows& windows);

}  // namespace runcert
