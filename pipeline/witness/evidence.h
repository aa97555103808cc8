#pragma once

#include "motion/joint_speeds.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// The witnesses behind a distribution of the speed: all that have a share in it, or only the
/// observed ones.
enum class WitnessSet { all, observed };

/// The speeds by positions (first) and by witnesses, from the speed (m/s) as stated. The positions
/// have the probability of a fault of a window chosen among its rivals.
std::vector<SpeedBySource> speeds_of(const SpeedEvidence& evidence, double speed_m_s,
                                     WitnessSet set = WitnessSet::all);

/// The distribution of that speed, where each may be at fault. `also_m_s` is a further standard
/// uncertainty common to all speeds.
SpeedMixture mixture_of(const SpeedEvidence& evidence, double speed_m_s, WitnessSet set,
                        double also_m_s = 0.0);

}  // namespace runcert
