#pragma once

#include <memory>
#include <optional>
#include <span>

#include "simulation/raw_measurements.h"
#include "witness/screened_phases.h"

namespace runcert {

/// Phases of a simulated run, screened, and when they begin.
struct StudyPhases {
    std::shared_ptr<const JudgedPhases> phases;
    GpsTime first_epoch;
};

/// Where and when the runs with raw measurements are: that of examples/phase, whose broadcast
/// orbits they are measured with.
FrameOrigin study_origin();
GpsTime study_start();

/// What a receiver measures at these epochs (their true places, at a constant rate), one band, all
/// satellites of the orbits above 10 degrees; imported and screened beside the positions of the
/// table as the program does it. Only Doppler shifts are as good as none: the craft's velocity is
/// not known to the simulation of raw measurements.
StudyPhases study_phases(std::span<const SimulatedEpoch> epochs, double phase_noise_m,
                         double phase_multipath_m, std::uint64_t seed, const EnuTable& positions);

}  // namespace runcert
