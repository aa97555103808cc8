#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/satellite.h"
#include "satellites/ephemeris.h"
#include "simulation/simulate.h"

namespace runcert {

/// A slip of a satellite's phase: from a time on it is off by so many cycles.
struct SlipFault {
    double time_s = 0.0;
    Satellite satellite;
    std::uint8_t band = 1;
    double cycles = 1.0;
    bool is_flagged = false;  ///< whether the receiver says so
};

/// A stretch in which something is wrong with a satellite.
struct SatelliteStretch {
    TimeStretch stretch;
    Satellite satellite;
};

/// How a receiver measures raw signals.
struct RawSpec {
    double mask_deg = 10.0;
    bool two_bands = true;           ///< GPS 1C and 2W, Galileo 1C and 5Q; or the first alone
    double phase_noise_m = 0.001;    ///< of a phase of the first band, at the zenith
    double phase_multipath_m = 0.0;  ///< first-order Gauss-Markov, of each satellite and band
    double multipath_time_s = 20.0;
    double pseudorange_noise_m = 0.3;
    double doppler_noise_hz = 0.05;
    double clock_offset_s = 0.0;  ///< of the receiver, at time 0
    double clock_drift = 0.0;     ///< s/s
    bool clock_jumps = false;     ///< it is set back by a millisecond whenever it is 0.5 ms off
    std::vector<SlipFault> slips{};
    std::vector<SatelliteStretch> half_cycles{};  ///< half a cycle is open, and said to be
    std::vector<SatelliteStretch> outages{};
};

/// The raw measurements of a simulated run, as RINEX 3.04 observations: phases, pseudoranges,
/// Doppler shifts and strengths of the satellites of these ephemerides, at the epochs that are
/// recorded, in the receiver's own time. Troposphere is simulated, ionosphere is not. The same
/// specs give the same text; each satellite and band draws from a sequence of its own. Failure
/// where the run has no place or no time, or no satellite is above the mask at some epoch.
std::string rinex_observations_text(const SimulationSpec& spec, const RawSpec& raw,
                                    std::span<const SimulatedEpoch> epochs,
                                    const std::vector<Ephemeris>& ephemerides);

}  // namespace runcert
