#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/satellite.h"

namespace runcert {

// A receiver's carrier phases as estimation needs them: epochs, in each of them satellites, in each
// of these signals; each in one array, by time, satellite and signal. 24 bytes a signal and 56 a
// satellite, because millions of epochs are held.

struct PhaseSignal {
    double phase_cycles = std::numeric_limits<double>::quiet_NaN();
    double pseudorange_m = std::numeric_limits<double>::quiet_NaN();
    float doppler_hz = std::numeric_limits<float>::quiet_NaN();
    SignalCode code = {};
    bool loss_of_lock = false;
    bool half_cycle = false;
};

struct PhaseSatellite {
    Satellite id;
    std::int16_t issue = 0;  ///< of the ephemeris
    std::uint8_t signals = 0;
    bool healthy = true;
    float sine_of_elevation = std::numeric_limits<float>::quiet_NaN();
    std::uint32_t first_signal = 0;
    float group_delay_m = 0.0F;  ///< of pseudoranges of the first band against the clock
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< at transmission
    /// Against GPS time, times c; not a number: without an orbit.
    double clock_m = std::numeric_limits<double>::quiet_NaN();

    bool has_orbit() const { return clock_m == clock_m; }
};

struct PhaseEpoch {
    std::int64_t time_ns = 0;  ///< by the receiver's clock, from the record's first epoch
    std::int64_t number = 0;   ///< in the table, counted from 1: epochs without rows are not here
    std::uint32_t first_satellite = 0;
    std::uint16_t satellites = 0;
    Eigen::Vector3d receiver_m = Eigen::Vector3d::Zero();  ///< to some metres; zero: not known

    bool has_place() const { return receiver_m != Eigen::Vector3d::Zero(); }
};

struct PhaseRecord {
    std::vector<PhaseEpoch> epochs{};
    std::vector<PhaseSatellite> satellites{};
    std::vector<PhaseSignal> signals{};

    std::span<const PhaseSatellite> of(const PhaseEpoch& epoch) const {
        return std::span(satellites).subspan(epoch.first_satellite, epoch.satellites);
    }
    std::span<const PhaseSignal> of(const PhaseSatellite& satellite) const {
        return std::span(signals).subspan(satellite.first_signal, satellite.signals);
    }
};

}  // namespace runcert
