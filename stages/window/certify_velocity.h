#pragma once

#include "stages/window/best_window.h"
#include "stages/window/certify.h"
#include "stages/window/velocity_noise.h"
#include "stages/window/window.h"
#include "witness/certifiable.h"

namespace runcert {

/// The data from which windows of recorded speeds are certified.
struct VelocityEstimate {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const std::vector<ArcRows>& rows;  ///< of each arc
    const WindowConfig& config;
    std::vector<ComparedSpeed> compared;  ///< in the rule's dimension
};

/// The speed of a window from the recorded velocities. Their errors come from the recording
/// (`speed_errors`). The bias of the choice comes from draws of those errors that may differ
/// between windows (`speed_choice_bias`). `all` are the windows from which it was chosen.
///
/// The rows, in this order: w white noise, b errors shorter than ten seconds, u lasting errors, p
/// scale of the speeds (which is taken off), t time stamps and l delay (both only where positions
/// decide the ends), k clock rate, r resolution of the speeds, d undetected error, f choice of the
/// fastest window. The smoothed positions serve as a witness.
///
/// Failure if an epoch inside states no standard deviation of its velocity.
CertifiableWindow certified_by_velocity(const VelocityEstimate& estimate, const Profile& profile,
                                        const FoundWindow& found,
                                        const std::vector<FoundWindow>& all,
                                        CertificateExtent extent = CertificateExtent::whole);

/// Whether every epoch of the window states the standard deviation of its velocity.
bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found);

}  // namespace runcert
