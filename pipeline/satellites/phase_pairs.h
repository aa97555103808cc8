#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "satellites/phase_displacement.h"
#include "satellites/phase_record.h"
#include "satellites/phase_screening.h"

namespace runcert {

/// Number of slots for the satellites of all systems. `slot_of` gives a smaller index.
inline constexpr std::size_t satellite_slots = 700;
constexpr std::size_t slot_of(Satellite satellite) {
    return static_cast<std::size_t>(satellite.system) * 100 + satellite.number % 100;
}

/// Number of slots for signal codes. `slot_of` gives a smaller index.
inline constexpr std::size_t code_slots = 320;
constexpr std::size_t slot_of(SignalCode code) {
    return static_cast<std::size_t>(code.band % 10) * 32 +
           static_cast<std::size_t>(code.attribute & 31);
}

/// Chooses the signals to use. For each system it is the signal with most phases on its lowest
/// band. For each satellite it is also the signal with most phases on its other bands, as a check
/// on the first.
class SignalChoice {
  public:
    explicit SignalChoice(const PhaseRecord& record);

    bool is_first(Satellite satellite, SignalCode code) const {
        return first_[static_cast<std::size_t>(satellite.system)] == slot_of(code);
    }
    bool is_second(Satellite satellite, SignalCode code) const {
        return second_[slot_of(satellite)] == slot_of(code);
    }

  private:
    std::array<std::size_t, 7> first_{};
    std::vector<std::size_t> second_;
};

/// The chosen signals of a satellite, as indices into the record.
struct ChosenSignals {
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    std::size_t first = none, second = none;
};

/// A satellite whose first band is tracked from one epoch to the next.
struct PhasePair {
    const PhaseSatellite* before = nullptr;
    const PhaseSatellite* now = nullptr;
    ChosenSignals signals_before, signals_now;
    double wavelength_m = 0.0;  ///< of the first band
};

/// Combinations of the phases of neighbouring epochs of a record, restricted to phases that are
/// used. Epochs are indices into the record. Unknown values are NaN.
class PhasePairs {
  public:
    PhasePairs(const PhaseRecord& record, const std::vector<PhaseFinding>& findings)
        : record_(record), findings_(findings), choice_(record) {}

    const SignalChoice& choice() const { return choice_; }

    ChosenSignals chosen_of(const PhaseSatellite& satellite) const;

    /// Time (s) since the previous epoch, by the receiver's clock.
    double step_s(std::size_t epoch) const {
        return static_cast<double>(record_.epochs[epoch].time_ns -
                                   record_.epochs[epoch - 1].time_ns) *
               1e-9;
    }

    /// The satellites whose first band is used at an epoch and at the previous one, with the same
    /// ephemeris and without loss of lock.
    std::vector<PhasePair> at(std::size_t epoch) const;

    /// The wide-lane combination (Melbourne-Wuebbena), in cycles.
    double wide_lane_cycles(const PhaseSatellite& satellite, const ChosenSignals& chosen) const;

    /// Change of the geometry-free difference between the two bands (m).
    double geometry_free_change_m(const PhasePair& pair) const;

    /// Changes of the phases minus those predicted by the Doppler shifts, in cycles. Their median
    /// over the satellites, which is the clock's, is removed. Empty if too few satellites have
    /// one.
    std::vector<std::optional<double>> beyond_doppler_cycles(const std::vector<PhasePair>& pairs,
                                                             double step_s) const;

    /// The displacement over the pair that ends at an epoch.
    std::optional<PhaseDisplacement> displacement(std::size_t epoch,
                                                  const std::vector<PhasePair>& pairs,
                                                  const PhaseNoise& noise) const;

  private:
    double geometry_free_m(const PhaseSatellite& satellite, const ChosenSignals& chosen) const;

    const PhaseRecord& record_;
    const std::vector<PhaseFinding>& findings_;
    SignalChoice choice_;
};

}  // namespace runcert
