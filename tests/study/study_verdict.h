#pragma once

#include <optional>
#include <string>

#include "schemas/profile/profile.h"
#include "stages/check/check.h"

// What the check says of a simulated recording.

namespace runcert {

/// What the check reads of one receiver's stages.
ReceiverFindings findings_of(const ScreenedTable& screened, TrajectoryTable&& trajectory,
                             Windows&& windows);

/// By one rule, with this record (m/s), or without one.
ProfileVerdict verdict_at(Attempt attempt, std::optional<double> record_m_s,
                          const ReceiverFindings& findings, const Profile& rule);

/// The first words of a reason, each number a "#".
std::string reason_words(const std::string& reason);

}  // namespace runcert
