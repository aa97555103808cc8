#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "satellites/phase_record.h"

namespace runcert {

/// Whether a phase is used, and if not, why.
enum class PhaseUse : std::uint8_t {
    used,
    no_phase,
    no_orbit,    ///< no valid ephemeris, or no pseudorange to date the transmission
    unhealthy,   ///< the satellite says so
    low,         ///< below the mask, or the receiver's place is unknown
    half_cycle,  ///< half-cycle ambiguity unresolved
};

/// Why a new arc of a phase begins. An arc is a stretch without a slip.
enum class PhaseBreak : std::uint8_t {
    none,           ///< no new arc
    start,          ///< first phase of the signal
    gap,            ///< not used at the previous epoch, or that was too long ago
    lost_lock,      ///< the receiver says so
    ephemeris,      ///< the orbit comes from another ephemeris
    geometry_free,  ///< the difference of two bands jumped
    displacement,   ///< contradicts the other satellites
    uncontrolled,   ///< neither the others nor Doppler could have shown a slip of one cycle
    refused,        ///< the pair of epochs could not be judged
};

/// The result of screening for one phase.
struct PhaseFinding {
    std::int32_t arc = 0;         ///< arc of the signal, counted from 1; 0 if it is not used
    std::int32_t correction = 0;  ///< whole cycles to subtract from the phase: a repaired slip
    PhaseUse use = PhaseUse::no_phase;
    PhaseBreak begins = PhaseBreak::none;
    bool supports = false;  ///< a second band, which only checks the satellite's first
};

/// A slip, or a test that ended an arc.
struct PhaseSlip {
    std::size_t signal = 0;  ///< index into the record
    std::size_t epoch = 0;   ///< index into the record of the first epoch after the slip
    PhaseBreak test = PhaseBreak::displacement;
    double statistic = 0.0;
    double threshold = 0.0;
    std::optional<double> cycles{};  ///< estimated from the other satellites
    std::optional<double> sigma_cycles{};
    /// Further evidence, in cycles: the change of the wide lane (Melbourne-Wuebbena), and of the
    /// phase beyond the Doppler shift.
    std::optional<double> wide_lane_cycles{}, beyond_doppler_cycles{};
    bool is_repaired = false;
};

/// Why a pair of epochs was refused.
enum class RefusalReason : std::uint8_t {
    few_satellites,  ///< fewer than five have unbroken phases: no redundancy to test them
    no_single_set,   ///< the phases are contradictory, and no unique set of slips explains it
    no_place,        ///< the receiver's place is unknown
};

/// A pair of epochs whose phases could not be judged.
struct PhaseRefusal {
    std::size_t epoch = 0;  ///< the second of the pair
    RefusalReason reason = RefusalReason::few_satellites;
    std::size_t satellites = 0;
    double statistic = 0.0;  ///< of the displacement with all satellites, if there is one
    double threshold = 0.0;
};

/// A pair of epochs whose phases were disturbed by more than their noise but less than half a
/// cycle, so that nothing slipped.
struct DisturbedPair {
    std::size_t epoch = 0;  ///< the second of the pair
    double statistic = 0.0;
    double threshold = 0.0;
};

/// A jump of the receiver's clock by whole milliseconds.
struct ClockJump {
    std::size_t epoch = 0;  ///< the first after the jump
    std::int64_t milliseconds = 0;
};

/// Parameters of phase screening.
struct PhaseScreeningConfig {
    double mask_deg = 15.0;
    double longest_gap_s = 5.0;  ///< longest gap within an arc
    double significance = 1e-3;  ///< of the chi-squared test of all satellites between two epochs
    bool repair = false;
};

/// Noise of the phases, estimated from the record by medians of absolute values, so that slips have
/// no influence.
struct PhaseNoiseFigures {
    double white_m = 0.0012;                 ///< PhaseNoise::white_m
    std::optional<double> geometry_free_m;   ///< of its change, at the zenith, divided by sqrt 2
    std::optional<double> wide_lane_cycles;  ///< at a single epoch
    std::optional<double> doppler_cycles;    ///< of the phase's change beyond the Doppler shift
    std::int64_t pairs = 0;                  ///< number of epoch pairs behind the estimate
};

/// The result of screening a record of phases.
struct PhaseScreening {
    std::vector<PhaseFinding> findings;  ///< one for each signal of the record
    std::vector<PhaseSlip> slips;        ///< ordered by epoch and signal
    std::vector<PhaseRefusal> refusals;
    std::vector<DisturbedPair> disturbed;
    std::vector<ClockJump> jumps;
    /// Receiver clock offset from GPS time by pseudoranges at each epoch, times c. NaN if
    /// unknown.
    std::vector<double> clock_m;
    PhaseNoiseFigures noise;
    std::int64_t pairs = 0;  ///< number of epoch pairs judged
};

/// The wavelength (m) of a signal.
double wavelength_m(Satellite satellite, SignalCode code);

/// Receiver clock offset from GPS time at each epoch, times c. It is the median of the pseudorange
/// remainders of the satellites above the mask. NaN if fewer than four have one.
std::vector<double> receiver_clocks_m(const PhaseRecord& record, double mask_deg);

/// Screens the phases of a record for cycle slips, one pair of epochs after the other. The
/// receiver's own flags come first. Then one displacement and clock change must explain all
/// satellites of the first band together. Where they do not, satellites whose two bands diverge
/// (geometry-free) are removed, and then the set of satellites that explains the rest is searched
/// for (`find_slips`).
///
/// A satellite's arc also ends where a slip of one cycle would have gone unnoticed: neither the
/// others nor its Doppler shift nor its second band could have shown it. A new arc begins after
/// each slip, and for all phases after a refused pair.
///
/// With `repair`, a slip is subtracted from the phases that follow if its estimate is within 0.25
/// of a whole number, with a standard deviation below 0.12. Two bands must not contradict this.
PhaseScreening screen_phases(const PhaseRecord& record, const PhaseScreeningConfig& config);

}  // namespace runcert
