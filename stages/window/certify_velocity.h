#pragma once

#include "stages/window/best_window.h"
#include "stages/window/velocity_noise.h"
#include "stages/window/window.h"
#include "witness/certifiable.h"

namespace runcert {

/// What the windows of recorded speeds are certified from.
struct VelocityEstimate {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const std::vector<ArcRows>& rows;  ///< of each arc
    const WindowConfig& config;
    std::vector<ComparedSpeed> compared;  ///< of the rule's dimension
};

/// The speed of a window from the velocities that the recording states. Their errors come from the
/// recording (`speed_errors`), the bias of the choice from draws of what of these may differ
/// between windows (`speed_choice_bias`). `all` are the windows that it was chosen from.
///
/// The rows, in this order: w white noise, b errors shorter than ten seconds, u lasting errors, t
/// time stamps and l delay, which count where positions decide the ends, k clock rate, r resolution
/// of the speeds, d undetected error, f choice of the fastest. The smoothed positions stand beside
/// as a witness.
///
/// Failure where an epoch inside states no accuracy of its velocity.
CertifiableWindow certified_by_velocity(const VelocityEstimate& estimate, const Profile& profile,
                                        const FoundWindow& found,
                                        const std::vector<FoundWindow>& all);

/// What other windows are expected to be certified with, by one that is: infinite where an epoch
/// inside states no accuracy.
Allowance velocity_allowance(const VelocityEstimate& estimate, const Profile& profile,
                             const FoundWindow& reference);

/// Whether every epoch of the window states how accurate its velocity is.
bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found);

}  // namespace runcert
