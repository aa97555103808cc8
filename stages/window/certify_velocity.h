#pragma once

#include "stages/window/certify.h"
#include "stages/window/velocity_noise.h"
#include "stages/window/window.h"
#include "witness/certifiable.h"

namespace runcert {

/// The data from which windows of recorded speeds are certified.
struct VelocityEstimate {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const std::vector<ArcRows>& rows;                    ///< of each arc
    const std::vector<std::vector<ElapsedTime>>& times;  ///< of each arc's epochs
    const WindowConfig& config;
    std::vector<ComparedSpeed> compared;  ///< in the rule's dimension
};

/// A window certified by the recorded velocities, as `certify_by_positions` does. Their errors
/// come from the recording (`speed_errors`). The bias of the choice comes from draws of those
/// errors that may differ between windows (`speed_choice_bias`). The smoothed positions serve as a
/// witness. Every epoch of the window must state the standard deviation of its velocity.
CertifiableWindow certify_by_velocities(const VelocityEstimate& estimate,
                                        const WindowChoice& choice);

/// Whether every epoch of the window states the standard deviation of its velocity.
bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found);

}  // namespace runcert
