#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/satellite.h"

namespace runcert {

// A receiver's carrier phases for estimation: epochs, their satellites, and the signals of these.
// Each level is one array, ordered by time, satellite and signal. A signal takes 24 bytes and a
// satellite 56, because millions of epochs are held.

/// The measurements of one signal at an epoch. NaN if missing.
struct PhaseSignal {
    double phase_cycles = std::numeric_limits<double>::quiet_NaN();
    double pseudorange_m = std::numeric_limits<double>::quiet_NaN();
    float doppler_hz = std::numeric_limits<float>::quiet_NaN();
    SignalCode code = {};
    bool loss_of_lock = false;
    bool half_cycle = false;
};

/// A satellite at an epoch, with its signals `first_signal` to first_signal + signals - 1.
struct PhaseSatellite {
    Satellite id;
    std::int16_t issue = 0;  ///< of the ephemeris
    std::uint8_t signals = 0;
    bool healthy = true;
    float sine_of_elevation = std::numeric_limits<float>::quiet_NaN();
    std::uint32_t first_signal = 0;
    float group_delay_m = 0.0F;  ///< of the first band's pseudoranges relative to the clock
    Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< at transmission
    /// Clock offset from GPS time, times c. NaN without an orbit.
    double clock_m = std::numeric_limits<double>::quiet_NaN();

    bool has_orbit() const { return clock_m == clock_m; }
};

/// An epoch, with its satellites `first_satellite` to first_satellite + satellites - 1.
struct PhaseEpoch {
    std::int64_t time_ns = 0;  ///< by the receiver's clock, since the record's first epoch
    std::int64_t number = 0;   ///< in the table, counted from 1; epochs without rows are not stored
                               ///< here
    std::uint32_t first_satellite = 0;
    std::uint16_t satellites = 0;
    Eigen::Vector3d receiver_m = Eigen::Vector3d::Zero();  ///< accurate to some metres; zero if
                                                           ///< unknown

    bool has_position() const { return receiver_m != Eigen::Vector3d::Zero(); }
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
