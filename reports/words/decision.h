#pragma once

#include <string>

#include "schemas/profile/profile.h"
#include "schemas/verdict/figures.h"

// The decision rule, and what it leaves to chance, in the words of ISO/IEC 17025 and [JCGM106].

namespace runcert {

/// The guard band w in a unit, without it: acceptance limit less required speed ([JCGM106] 8.3), as
/// the two are shown beside the measured speed. Empty where nothing was decided.
std::string guard_band_figure(const ProfileVerdict& verdict, const SpeedUnit& unit);

/// "w = 0.17 km/h (acceptance limit less required speed)."; empty where there is none.
std::string guard_band_text(const ProfileVerdict& verdict, const SpeedUnit& unit);

/// The specific risk of the outcome: of false acceptance where it is beaten, else of false
/// rejection. "of false acceptance: 0.3 % (that the true speed is below the required speed).";
/// empty where nothing was decided or proven, or the speed cannot be certified.
std::string risk_text(const ProfileVerdict& verdict);

/// "202.9 km/h ± 0.1 km/h (k = 2): its source".
std::string record_text(const RecordToBeat& record);

/// From which probability on the speed counts as beaten, and as not beaten; and what it means that
/// a rule does not say so.
std::string decision_rule_text(const Profile& profile, const ProfileVerdict& verdict);

/// What it means that a rule does not say how uncertainty counts in the decision; empty for a rule
/// that does.
std::string silent_rule_text(const Profile& profile);

}  // namespace runcert
