#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "estimation/speed_mixture.h"
#include "files/measured_series.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "witness/copies.h"
#include "witness/phase_motion.h"
#include "witness/track.h"
#include "witness/witness.h"

// Every kind of witness that there is. A kind is a word of `WitnessKind` (schemas/screened/v1.yaml:
// its name and its origin) and a file in kinds/ that makes its entry here, of the same name. One
// that is handed in is a series of the attempt under the key of the same name, whose `read_by` says
// which stages hear it.

namespace runcert {

/// A witness of a recording's positions, and which one it is.
template <int Axes>
struct HeardWitness {
    WitnessKind kind = WitnessKind::velocities;
    std::string receiver = {};  ///< id, where it is another receiver
    std::shared_ptr<const Witness<Axes>> motion;
    std::shared_ptr<const PhaseWitness<Axes>> phases = nullptr;  ///< the same, where it is that
    std::string note = {};  ///< a sentence on what was estimated of it; empty where nothing was
    /// It was made from the positions or from another witness, and says nothing of any window.
    bool is_copy = false;
    bool confirms = true;  ///< false: only a contradiction by it counts
};

template <int Axes>
using HeardWitnesses = std::vector<HeardWitness<Axes>>;

/// What was handed in beside a receiver's recording.
struct HandedIn {
    AttemptDocument attempt = {};                       ///< what it says of the series
    std::map<std::string, MeasuredSeries> series = {};  ///< by key
};

/// A series that a witness is made of, and what its errors are judged by.
struct HandedInSeries {
    const MeasuredSeries& series;
    const AttemptDocument& attempt;
    std::span<const TimedPosition<2>> positions;
    const Track& track;
    double jerk_density = 0.0;                    ///< of the craft's motion, m s^-2.5
    std::span<const WitnessSource> sources = {};  ///< what else it may have been made from
};

/// How screening tests positions against a witness, and what it marks them with.
struct ScreeningTest {
    Reason reason;
    Hypothesis hypothesis;
    bool single_epochs = true;  ///< whether the witness is sharp enough over one interval
    /// Whether it is worth its figures only where the craft moves fast: a wheel that slips and a
    /// second antenna that swings are of slow stretches.
    bool only_fast = false;
};

struct WitnessEntry {
    WitnessKind kind;
    /// How likely it errs unseen in a window, and by how much; the positions' own is given.
    FaultPrior (*fault)(const FaultPrior& positions);
    std::string_view silent;  ///< why one that there is may say nothing, behind a colon
    std::optional<ScreeningTest> screening = {};
    /// Makes one of a series; nothing where that tells no motion. Null: a receiver records it.
    std::optional<HeardWitness<2>> (*make)(const HandedInSeries& given) = nullptr;
};

/// How likely measured speeds err unseen in a window, and by how much.
inline constexpr FaultPrior faults_of_speeds{.probability = 0.01, .largest_m_s = 1.0};

/// In the order of `WitnessKind`, in which they are heard.
const std::vector<WitnessEntry>& witness_roster();

/// Of a kind that is a witness of positions: not `WitnessKind::positions`.
const WitnessEntry& witness_entry(WitnessKind kind);

/// The witness of that entry, where its series was handed in and tells a motion.
std::optional<HeardWitness<2>> handed_in_witness(const WitnessEntry& entry, const HandedIn& given,
                                                 std::span<const TimedPosition<2>> positions,
                                                 const Track& track, double jerk_density,
                                                 std::span<const WitnessSource> sources = {});

}  // namespace runcert
