#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "estimation/phase_record.h"

namespace runcert {

/// Whether a phase is used, and if not, why.
enum class PhaseUse : std::uint8_t {
    used,
    no_phase,
    no_orbit,    ///< no ephemeris is valid, or no pseudorange dates the transmission
    unhealthy,   ///< its satellite says so
    low,         ///< below the mask, or the receiver's place is not known
    half_cycle,  ///< half a cycle is open
};

/// Why a new arc of a phase begins: an arc is a stretch without a slip.
enum class PhaseBreak : std::uint8_t {
    none,           ///< none begins
    start,          ///< the signal's first
    gap,            ///< it was not used at the epoch before, or that is too long ago
    lost_lock,      ///< the receiver says so
    ephemeris,      ///< the orbit is of another ephemeris
    geometry_free,  ///< the difference of two bands jumped
    displacement,   ///< it contradicts the other satellites
    uncontrolled,   ///< neither the others nor Doppler could have told a slip of one cycle
    refused,        ///< the pair of epochs could not be judged
};

/// What screening found of a phase.
struct PhaseFinding {
    std::int32_t arc = 0;         ///< of the signal, counted from 1; 0 where it is not used
    std::int32_t correction = 0;  ///< whole cycles to be taken from the phase: a repaired slip
    PhaseUse use = PhaseUse::no_phase;
    PhaseBreak begins = PhaseBreak::none;
    bool supports = false;  ///< a second band, that only checks the satellite's first
};

/// A slip, or what ended an arc by a test.
struct PhaseSlip {
    std::size_t signal = 0;  ///< its number in the record
    std::size_t epoch = 0;   ///< its number in the record: the first after the slip
    PhaseBreak test = PhaseBreak::displacement;
    double statistic = 0.0;
    double threshold = 0.0;
    std::optional<double> cycles{};  ///< as the other satellites tell it
    std::optional<double> sigma_cycles{};
    /// Second evidence: change of the wide lane (Melbourne-Wuebbena), and of the phase beyond what
    /// the Doppler shift says, in cycles.
    std::optional<double> wide_lane_cycles{}, beyond_doppler_cycles{};
    bool is_repaired = false;
};

/// Why a pair of epochs was refused.
enum class RefusalReason : std::uint8_t {
    few_satellites,  ///< fewer than five have unbroken phases: nothing tests them
    no_single_set,   ///< the phases contradict each other, and no one set of slips explains it
    no_place,        ///< nobody knows where the receiver was
};

struct PhaseRefusal {
    std::size_t epoch = 0;  ///< the second of the pair
    RefusalReason reason = RefusalReason::few_satellites;
    std::size_t satellites = 0;
    double statistic = 0.0;  ///< of the displacement with all of them, where there is one
    double threshold = 0.0;
};

/// A pair of epochs whose phases were disturbed by more than their noise and less than half a
/// cycle: nothing slipped.
struct DisturbedPair {
    std::size_t epoch = 0;  ///< the second of the pair
    double statistic = 0.0;
    double threshold = 0.0;
};

/// A jump of the receiver's clock by whole milliseconds.
struct ClockJump {
    std::size_t epoch = 0;  ///< the first after it
    std::int64_t milliseconds = 0;
};

struct PhaseScreeningConfig {
    double mask_deg = 15.0;
    double longest_gap_s = 5.0;  ///< no arc goes on over more
    double significance = 1e-3;  ///< of the chi-squared test of all satellites between two epochs
    bool repair = false;
};

/// Noise of the phases, estimated from the record: medians of absolute values, so that slips do
/// not count.
struct PhaseNoiseFigures {
    double white_m = 0.0012;                 ///< PhaseNoise::white_m
    std::optional<double> geometry_free_m;   ///< of its change, at the zenith, over sqrt 2
    std::optional<double> wide_lane_cycles;  ///< of one epoch
    std::optional<double> doppler_cycles;    ///< of the phase's change beyond Doppler
    std::int64_t pairs = 0;                  ///< of epochs that it rests on
};

struct PhaseScreening {
    std::vector<PhaseFinding> findings;  ///< of each signal of the record
    std::vector<PhaseSlip> slips;        ///< by epoch and signal
    std::vector<PhaseRefusal> refusals;
    std::vector<DisturbedPair> disturbed;
    std::vector<ClockJump> jumps;
    /// The receiver's clock against GPS time by pseudoranges, at each epoch, times c; not a number
    /// where it is not known.
    std::vector<double> clock_m;
    PhaseNoiseFigures noise;
    std::int64_t pairs = 0;  ///< of epochs that were judged
};

/// The wavelength (m) of a signal.
double wavelength_m(Satellite satellite, SignalCode code);

/// The receiver's clock against GPS time at each epoch, times c: the median over the satellites
/// above the mask of what their pseudoranges leave; not a number where fewer than four do.
std::vector<double> receiver_clocks_m(const PhaseRecord& record, double mask_deg);

/// Screens the phases of a record for cycle slips, pair of epochs by pair of epochs: the
/// receiver's own flags; then all satellites of the first band together, whose displacement and
/// clock must explain every change; where they do not, those whose two bands parted (geometry-free)
/// are taken out, and then the set of satellites that explains it is searched (`find_slips`). A
/// satellite of which neither the others nor its Doppler shift nor its second band could have told
/// a slip of one cycle ends its arc, too. What slipped begins a new arc, and so does everything
/// after a pair that is refused. With `repair`, a slip whose estimate is within 0.25 of a whole
/// number, with a deviation below 0.12, is taken out of the phases that follow, if two bands do not
/// contradict that.
PhaseScreening screen_phases(const PhaseRecord& record, const PhaseScreeningConfig& config);

}  // namespace runcert
