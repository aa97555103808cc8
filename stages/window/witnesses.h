#pragma once

#include <memory>
#include <string>
#include <vector>

#include "estimation/phase_motion.h"
#include "estimation/tables/handed_in.h"
#include "estimation/tables/recorded_velocities.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/speed_by_definition.h"

namespace runcert {

/// The smoothed direction of travel at each row.
Directions directions_of(const TrajectoryTable& trajectory);

/// A witness of a recording's positions, and which one it is.
template <int Axes>
struct HeardWitness {
    WitnessKind kind = WitnessKind::velocities;
    std::string receiver = {};  ///< id, where it is another receiver
    std::shared_ptr<const Witness<Axes>> motion;
    std::shared_ptr<const PhaseWitness<Axes>> phases = nullptr;  ///< the same, where it is that
    std::string note = {};  ///< a sentence on what was estimated of it; empty where nothing was
    /// It has the positions' own errors, and says nothing of any window.
    bool made_from_positions = false;
    bool confirms = true;  ///< false: only a contradiction by it counts
};

template <int Axes>
using HeardWitnesses = std::vector<HeardWitness<Axes>>;

/// What was recorded beside a receiver's positions and their velocities.
struct Beside {
    std::shared_ptr<const JudgedPhases> phases = nullptr;
    GpsTime first_of_phases = {};                        ///< their first epoch
    std::vector<const TrajectoryTable*> receivers = {};  ///< the others of the attempt
    std::vector<TimedValue> wheel_m_s = {};              ///< speeds of a wheel
    std::vector<TimedValue> gates_m = {};                ///< passages: distances from the first
    GateErrors gate_errors = {};
    std::vector<std::string> notes = {};  ///< on what was read of them, a sentence each
};

/// What was handed in and became no witness, a sentence each.
std::vector<std::string> unheard(const Beside& beside, const HeardWitnesses<2>& witnesses);

/// Why a witness says nothing of a window, from the trajectory's first instant to its last.
template <int Axes>
std::string silence_text(const HeardWitness<Axes>& witness, const TrajectoryTable& trajectory,
                         const std::string& profile);

/// Every witness of the positions that there is: the recorded velocities, where anything bounds
/// their errors; the carrier phases; the other receivers.
template <int Axes>
HeardWitnesses<Axes> witnesses_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                  const Beside& beside, double jerk_density);

/// Whether a witness's path is what corresponds to the speed of a definition, not its displacement.
bool counts_path(SpeedDefinition definition);

enum class Undetected { counted, left_out };

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
    /// Of the speed, of what a witness does not share: without undetected errors, and with them.
    double standard_uncertainty_m_s = 0.0;
    double with_undetected_m_s = 0.0;
    /// Of the speed, by the bound on time-correlated errors: part of the first.
    double correlated_m_s = 0.0;
};

/// The difference of the displacements by positions and by a witness over the largest that chance
/// makes once in a thousand: above 1 they contradict one another.
template <int Axes>
double displacement_ratio(const WitnessedMotion<Axes>& moved,
                          const PositionFigures<Axes>& positions);

/// The speed of a window by a witness beside that by positions, and what part of their difference
/// is to be expected as the positions' error; nothing where the witness does not cover the window.
/// The two contradict one another where the speeds differ by more than twice the standard
/// uncertainty of the difference, or the displacements by what chance does once in a thousand.
/// Another receiver's time-correlated error is taken to be bounded as the positions' own is; the
/// test allows for both, as if they had nothing in common.
/// `undetected_m_s` is left 0.
template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const HeardWitness<Axes>& witness,
                                              const PositionFigures<Axes>& positions);

/// Standard uncertainty (m/s) by the rows that a witness of this kind does not share, with
/// undetected errors (row d) or without. A second receiver hears the same signals: what disturbs
/// both slowly (row b) may be common.
double unshared_uncertainty(const std::vector<BudgetRow>& rows, WitnessKind kind,
                            Undetected undetected);

/// Leaves a share to the sharpest witness alone, that of the least standard uncertainty; to none
/// where one contradicts the positions. Returns the one that has it, or null.
WitnessedSpeed* choose_share(std::vector<WitnessedSpeed>& witnesses);

/// What an error that changes the speed by `positions_alone_m_s`, and that the tests of positions
/// find with a non-centrality of `noncentrality`, can be at most when the witness's comparison
/// tests for it too: the non-centralities of independent tests add up.
double undetected_beside(const WitnessedSpeed& witnessed, double positions_alone_m_s,
                         double noncentrality);

/// Row d beside a witness that agrees: nothing is left out of it, drifts included, because all
/// tests together would have found anything larger than `witnessed.undetected_m_s`. `worst` is the
/// largest by the positions alone.
void set_undetected_beside(const WitnessedSpeed& witnessed, const UndetectedError& worst,
                           std::vector<BudgetRow>& rows);

/// The budget of a speed that a witness confirms. With a share K of the difference to be expected
/// as the positions' error, the speed less K times the difference is the weighted mean of both: the
/// rows of what the witness does not share count by 1 - K, the witness's own error by K (row g),
/// and that the mean is not what is stated by K times the difference (row e). So the speed by
/// position keeps its place, and what is stated with it holds what the witness says.
///
/// Carrier phases come from the same antenna: multipath moves them and the positions alike, and
/// their difference does not show it. Row s is what both may share (`shared_by_phases_m`).
void condition_on(const WitnessedSpeed& witnessed, std::vector<BudgetRow>& rows);

/// Standard deviation (m, each axis) of a time-correlated error that positions and phases of one
/// antenna may share: half of what rules take positions with fixed ambiguities to err by. A phase
/// is never disturbed by more than a quarter of its wave, 48 mm, and a position by several
/// satellites less.
inline constexpr double shared_by_phases_m = 0.010;

/// Expanded uncertainty (k = 2, m/s) to be expected of a window beside velocities of a receiver:
/// 0.1 m/s at each epoch, and never better than `least_velocity_sigma_m_s` altogether. They are
/// taken to differ from the positions by the median of what chance makes of the positions' own
/// errors.
double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s);

/// Standard uncertainty (m/s) by the rows of the positions, with undetected errors (row d) or
/// without.
double position_uncertainty(const std::vector<BudgetRow>& rows, Undetected undetected);

}  // namespace runcert
