#pragma once

#include "motion/speed_mixture.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// The witnesses behind a distribution of the speed: all that have a share in it, or only the
/// observed ones.
enum class WitnessSet { all, observed };

/// The distribution of a speed (m/s, as stated) where positions and witnesses may be at fault. The
/// prior of the positions is that of a window chosen among its rivals. `also_m_s` is a further
/// standard uncertainty common to all speeds.
SpeedMixture mixture_of(const SpeedEvidence& evidence, double speed_m_s, WitnessSet heard,
                        double also_m_s = 0.0);

/// Least expanded uncertainty (m/s) beside witnesses: the half-width about the stated speed of the
/// mixture whose fault probability is printed, with the coverage of two standard deviations.
///
/// A fault that the witnesses leave no likelier than it was widens nothing: the result is then at
/// most `alone_m_s`, the expanded uncertainty by positions alone. Where no witness has a share, the
/// fault has the probability that the budget takes, without the window's rivals, and widens nothing
/// up to 0.05.
double least_expanded_m_s(const SpeedEvidence& evidence, double speed_m_s, double alone_m_s);

}  // namespace runcert
