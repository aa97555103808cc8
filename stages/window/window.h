#pragma once

#include <Eigen/Core>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "stages/window/counted_part.h"
#include "stages/window/witnesses.h"
#include "witness/certifiable.h"

namespace runcert {

/// The parameters of the window search (`parameters.window` in `schemas/attempt/v1.yaml`), and the
/// attempt's statements about the receiver.
struct WindowConfig : WindowParameters {
    bool fault_probability_given = false;  ///< by the attempt, not by default
    double gap_max_s = 2.0;                ///< a longer gap ended the arc in screening
    double gap_factor = 1.5;               ///< or one of more intervals, if that is longer
    std::optional<Eigen::Vector3d> lever_arm = std::nullopt;  ///< m
    std::optional<double> rotation_bound_deg = std::nullopt;
    std::optional<AntennaMotion> antenna_motion = std::nullopt;
    /// Of a speed, by the receiver's certificate of calibration. Empty if it states none.
    std::optional<double> calibration_standard_uncertainty_m_s = std::nullopt;
    bool velocity_accuracy_claimed = false;  ///< by the attempt, because the recording states none
    PartStatements part = {};                ///< what the attempt states of the part that counts
};

/// The parameters that the attempt states, with the schema's defaults elsewhere.
WindowConfig window_config(const Attempt& attempt, const Receiver& receiver);

/// For each profile, the best certifiable windows of the smoothed trajectory, their measured speeds
/// with all sources of uncertainty, and the fastest that the recording indicates.
///
/// A certifiable window lies in one arc and contains no unusable epoch. It has no time step longer
/// than the rule's rate allows, and is as long as the rule says. Windows are compared on the
/// trajectory, or on the recorded velocities where the profile uses these. The fastest are taken,
/// or those with the highest speed that can be claimed where these prove more.
///
/// The speed of the best is the estimate with the position error bounded by the profile's rule
/// (`error_bound`), with the budget's combined uncertainty. The speeds with the fitted noise and by
/// the robust solution are given with it.
///
/// `course` comes from the attempt; `records` are other witnesses of the positions. Failure if a
/// profile needs a course and there is none, or if the trajectory is not the estimate from these
/// screened epochs.
Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config,
                     const std::optional<Course>& course = std::nullopt,
                     const WitnessRecords& records = {});

/// The window that shows most in the unscreened recording, certifiable or not. It is judged by its
/// positions or its recorded velocities and their stated standard deviations. A sentence gives each
/// reason why it cannot be certified. It lies in the part of the recording that counts.
std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened,
                                                 const Profile& profile, const WindowConfig& config,
                                                 const std::optional<SurveyedCourse>& gates,
                                                 const std::optional<WindowPart>& part = {});

}  // namespace runcert
