#pragma once

#include "inertial/inertial_smoother.h"
#include "schemas/profile/profile.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// First and last epoch of an inertial solution in a window. None where the solution is not
/// consistent, a stretch that only the IMU bridges lies between, or the window does not begin and
/// end at its epochs.
std::optional<std::pair<std::size_t, std::size_t>> epochs_within(const InertialSolution& solution,
                                                                 const WindowSpan& span);

/// The speed of a window at the antenna, as measured, and at the craft's reference point by the
/// inertial solution, by the same definition, with its expanded uncertainty (k = 2) from the joint
/// covariance of all epochs of the window.
///
/// Without the reference point where there are no `epochs_within`, or the rule takes a course's
/// length or recorded velocities.
CraftSpeeds craft_speeds(const InertialSolution& solution, const Profile& profile,
                         const WindowSpan& span, double antenna_speed_m_s);

/// Sets these speeds of all windows found.
void add_craft_speeds(const InertialSolution& solution, const std::vector<Profile>& profiles,
                      Windows& windows);

}  // namespace runcert
