#pragma once

#include "stages/check/requirements.h"

namespace runcert {

/// Gathers a profile's figures: what its windows say, the record and the required speed, the
/// probability that it is reached, course and craft, wind and current, second methods.
ClauseContext gather_context(const CheckInput& input, const Profile& profile,
                             const ProfileWindows& windows);

/// The runs of a recording as the profile cuts them.
std::vector<CraftRun> runs_under(const Profile& profile, const ReceiverFindings& judged);

/// Whether a second measurement of that expanded uncertainty (k = 2, m/s) could have failed: it is
/// at most three times that of the positions' speed, or of the margin over the record. One that is
/// less sure agrees with whatever is claimed, and confirms nothing.
bool could_have_failed(double expanded_uncertainty_m_s, const ClauseContext& context);

/// The same of a witness that agrees.
bool confirms(const WitnessedSpeed& one, const ClauseContext& context);

/// Whether a receiver's recording says it, not a file that was handed in beside one.
bool is_observed(const WitnessedSpeed& one);

/// "at ± 9.00 km/h it is too uncertain to confirm".
std::string too_uncertain_text(double expanded_uncertainty_m_s);

/// What a witness says of the window, in words.
std::string witness_text(const WitnessedSpeed& one);

/// What a witness of that kind is compared with.
std::string_view compared_with(WitnessKind kind);

/// Which witness it is, with "the".
std::string witness_name(const WitnessedSpeed& one);

/// The fastest speed that the recording shows, whatever of it can be certified, and where, in the
/// rule's unit: "44.12 kn at 10:03:43.0 UTC". The windows must have one.
std::string indicated_text(const ClauseContext& context);

/// The smallest drift (m/s) of the positions over the window that their tests would have found with
/// the stated power; nothing where a witness was heard, or the rule takes recorded velocities.
std::optional<double> unseen_drift_m_s(const ClauseContext& context);

/// The windows of a profile among those of 5-windows. Failure where they were searched for another
/// rule than the profile has now.
const ProfileWindows& windows_of(const Windows& windows, const Profile& profile);

}  // namespace runcert
