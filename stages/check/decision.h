#pragma once

#include <optional>
#include <string>

#include "schemas/profile/profile.h"

namespace runcert {

/// The speed (m/s) that must be reached to beat a record (m/s) by the profile's margin, rounded as
/// the body rounds it.
double target_speed(const Profile& profile, double record_mps);

/// Guarded acceptance [JCGM106]: "beaten" only if the speed less its expanded uncertainty reaches
/// the target, "not_beaten" if the speed itself is below it, else "not_proven". All in m/s, not
/// rounded.
std::string decide(double speed_mps, double expanded_uncertainty_mps, double target_mps);

}  // namespace runcert
