#pragma once

#include <span>
#include <string>
#include <vector>

#include "satellites/ephemeris.h"
#include "simulation/simulate.h"

namespace runcert {

/// The raw measurements of a simulated run, as RINEX 3.04 observations: phases, pseudoranges,
/// Doppler shifts and strengths of the satellites of these ephemerides, at the epochs that are
/// recorded, in the receiver's own time. Troposphere is simulated, ionosphere is not. The same
/// specs give the same text; each satellite and band draws from a sequence of its own. Failure
/// if the run has no place or no time, or no satellite is above the mask at some epoch.
std::string rinex_observations_text(const SimulationSpec& spec, const RawSpec& raw,
                                    std::span<const SimulatedEpoch> epochs,
                                    const std::vector<Ephemeris>& ephemerides);

}  // namespace runcert
