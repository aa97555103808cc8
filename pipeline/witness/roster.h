#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "motion/joint_speeds.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "store/measured_series.h"
#include "witness/antenna_swing.h"
#include "witness/copies.h"
#include "witness/phase_motion.h"
#include "witness/track.h"
#include "witness/witness.h"

// The roster of all kinds of witness. A kind consists of a value of `WitnessKind`
// (schemas/screened/v1.yaml: its name and its origin) and a file of the same name in kinds/, which
// defines its entry. A witness that is handed in is a series of the attempt under the key of the
// same name. The `read_by` of that key says which stages use it.

namespace runcert {

/// A witness of a recording's positions and its identity.
template <int Axes>
struct AssessedWitness {
    WitnessKind kind = WitnessKind::velocities;
    std::string receiver = {};  ///< id of the other receiver, where it is one
    std::shared_ptr<const Witness<Axes>> motion;
    std::shared_ptr<const PhaseWitness<Axes>> phases = nullptr;  ///< the same witness, where it
                                                                 ///< consists of phases
    std::string note = {};  ///< a sentence on the estimated parameters; empty if there are none
    /// It was made from the positions or from another witness, and says nothing about any window.
    bool is_copy = false;
    bool confirms = true;     ///< false: it can only contradict
    bool unanswered = false;  ///< because no official has answered for its file
};

template <int Axes>
using AssessedWitnesses = std::vector<AssessedWitness<Axes>>;

/// Data handed in in addition to a receiver's recording.
struct HandedIn {
    AttemptDocument attempt = {};                       ///< describes the series
    std::map<std::string, MeasuredSeries> series = {};  ///< by key
};

/// A series from which to make a witness, and the data by which to judge its errors.
struct HandedInSeries {
    const MeasuredSeries& series;
    const AttemptDocument& attempt;
    std::span<const TimedPosition<2>> positions;  ///< of the antenna, as measured
    std::span<const TimedPosition<2>> of_craft;   ///< the same of the craft, as far as it is known
    const Track& track;                           ///< of the craft
    double jerk_density = 0.0;                    ///< of the craft's motion, m s^-2.5
    std::span<const WitnessSource> sources = {};  ///< other data that it may have been made from
};

/// How screening tests positions against a witness, and how it marks them.
struct ScreeningTest {
    Reason reason;
    Hypothesis hypothesis;
    bool single_epochs = true;  ///< whether the witness is precise enough over a single interval
    /// Whether its errors hold only where the craft moves fast. In slow stretches wheels slip and
    /// second antennas swing.
    bool only_fast = false;
};

/// The entry of a kind of witness in the roster.
struct WitnessEntry {
    WitnessKind kind;
    /// Probability and size of its undetected errors in a window, given those of the positions.
    FaultPrior (*fault)(const FaultPrior& positions);
    std::string_view silent;  ///< why an existing witness may say nothing; printed after a colon
    std::string_view remedy;  ///< a sentence on what to check where it contradicts all else
    /// Why it may agree with a window and not confirm it; printed after a colon. Empty if it always
    /// does.
    std::string_view unconfirming = {};
    std::optional<ScreeningTest> screening = {};
    /// Makes a witness from a series. Empty if the series determines no motion. Null if a
    /// receiver records this kind.
    std::optional<AssessedWitness<2>> (*make)(const HandedInSeries& given) = nullptr;
};

/// Probability and size of undetected errors of measured speeds in a window.
inline constexpr FaultPrior faults_of_speeds{.probability = 0.01, .largest_m_s = 1.0};

/// All kinds in the order of `WitnessKind`, in which they are used.
const std::vector<WitnessEntry>& witness_roster();

/// The entry of a kind of witness. `WitnessKind::positions` has none.
const WitnessEntry& witness_entry(WitnessKind kind);

/// The witness of an entry, of the antenna's motion. Empty if its series was not handed in or
/// determines no motion. Such a series is about the craft: `positions` and `track` are the
/// antenna's, and `swing` says what is known of its motion against the craft.
std::optional<AssessedWitness<2>> handed_in_witness(const WitnessEntry& entry,
                                                    const HandedIn& given,
                                                    std::span<const TimedPosition<2>> positions,
                                                    const Track& track, double jerk_density,
                                                    std::span<const WitnessSource> sources = {},
                                                    const AntennaSwing& swing = {});

}  // namespace runcert
