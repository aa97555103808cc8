#pragma once

#include <memory>
#include <string>
#include <vector>

#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/combination.h"
#include "stages/window/speed_by_definition.h"
#include "witness/phase_motion.h"
#include "witness/recorded_velocities.h"
#include "witness/roster.h"

namespace runcert {

/// The smoothed direction of travel at each row.
Directions directions_of(const TrajectoryTable& trajectory);

/// Another receiver of the attempt, with its estimate.
struct OtherReceiver {
    const ScreenedTable* screened = nullptr;
    const TrajectoryTable* trajectory = nullptr;
};

/// What was recorded beside a receiver's positions and their velocities.
struct WitnessRecords {
    std::shared_ptr<const JudgedPhases> phases = nullptr;
    GpsTime first_of_phases = {};  ///< their first epoch
    std::vector<OtherReceiver> receivers = {};
    HandedIn handed_in = {};
};

/// What of a series was left out, and what was handed in and became no witness, a sentence each.
std::vector<std::string> unheard(const WitnessRecords& beside, const HeardWitnesses<2>& witnesses);

/// Why a witness says nothing of a window, from the trajectory's first instant to its last.
template <int Axes>
std::string silence_text(const HeardWitness<Axes>& witness, const TrajectoryTable& trajectory,
                         const std::string& profile);

/// Every witness of the positions that there is: the recorded velocities, where anything bounds
/// their errors; the carrier phases; what was handed in; the other receivers.
template <int Axes>
HeardWitnesses<Axes> witnesses_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                  const WitnessRecords& beside, double jerk_density);

/// Why a witness that agrees with a window confirms nothing of it; empty where it does.
std::string unconfirming_text(const HeardWitness<2>& witness, const WindowSpan& span,
                              const std::string& profile);

/// Whether a witness's path is what corresponds to the speed of a definition, not its displacement.
bool counts_path(SpeedDefinition definition);

/// By how much a witness that contradicts a window shows another motion than the positions all over
/// the recording, and by how many seconds a clock may be off; empty where it does not, and of
/// phases, of which screening says so.
std::string contradiction_text(const HeardWitness<2>& witness, const ScreenedTable& screened);

/// What positions say of a window, to be compared with a witness.
template <int Axes>
struct PositionFigures {
    double start_s = 0.0;
    double end_s = 0.0;
    bool by_path = false;
    double speed_m_s = 0.0;  ///< by displacement, or by path
    SpeedVector<Axes> displacement_m = SpeedVector<Axes>::Zero();
    /// Of the speed, of what a witness does not share, without undetected errors.
    double standard_uncertainty_m_s = 0.0;
    /// Of the speed, by the bound on time-correlated errors: part of the first.
    double correlated_m_s = 0.0;
    FaultPrior fault = {};  ///< of the speed, by what nothing found
};

/// The difference of the displacements by positions and by a witness over the largest that chance
/// makes once in a thousand: above 1 they contradict one another.
template <int Axes>
double displacement_ratio(const WitnessedMotion<Axes>& moved,
                          const PositionFigures<Axes>& positions);

/// The speed of a window by a witness beside that by positions; nothing where the witness does not
/// cover the window. The two contradict one another where an error of either is more probable than
/// none (`SpeedMixture`), or where the displacements differ by what chance does once in a thousand.
/// Another receiver's time-correlated error is taken to be bounded as the positions' own is; the
/// test allows for both, as if they had nothing in common. `share` is left 0.
template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const HeardWitness<Axes>& witness,
                                              const PositionFigures<Axes>& positions);

}  // namespace runcert
