#pragma once

#include "estimation/tables/certifiable.h"
#include "stages/window/best_window.h"
#include "stages/window/window.h"

namespace runcert {

/// The speed of a window from the velocities that the recording states, with what they state of
/// their accuracy: its errors are taken as the same throughout the window, so that no mean makes
/// them smaller. `all` are the windows that it was chosen from: the fastest of so many adds at most
/// u sqrt(2 ln n) in the mean, whatever their correlation ([BLM13] 2.5),
/// u being the part of the uncertainty that differs between windows.
///
/// Failure where an epoch inside states no accuracy of its velocity.
CertifiableWindow certified_by_velocity(const ScreenedTable& screened,
                                        const TrajectoryTable& trajectory, const ArcRows& arc,
                                        const Profile& profile, const FoundWindow& found,
                                        const std::vector<FoundWindow>& all,
                                        double least_uncertainty_m_s);

/// Whether every epoch of the window states how accurate its velocity is.
bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found);

}  // namespace runcert
