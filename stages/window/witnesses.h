#pragma once

#include "estimation/tables/recorded_velocities.h"
#include "schemas/trajectory/trajectory.h"
#include "schemas/windows/windows.h"
#include "stages/window/speed_by_definition.h"

namespace runcert {

/// The smoothed direction of travel at each row.
Directions directions_of(const TrajectoryTable& trajectory);

/// Whether a witness's path is what corresponds to the speed of a definition, not its displacement.
bool counts_path(SpeedDefinition definition);

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
};

/// The speed of a window by a witness beside that by positions, and what part of their difference
/// is to be expected as the positions' error; nothing where the witness does not cover the window.
/// The two contradict one another where the speeds differ by more than twice the standard
/// uncertainty of the difference, or the displacements by what chance does once in a thousand.
/// `undetected_m_s` is left 0.
template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const Witness<Axes>& witness,
                                              const PositionFigures<Axes>& positions);

/// What an error that changes the speed by `positions_alone_m_s`, and that the tests of positions
/// find with a non-centrality of `noncentrality`, can be at most when the witness's comparison
/// tests for it too: the non-centralities of independent tests add up.
double undetected_beside(const WitnessedSpeed& witnessed, double positions_alone_m_s,
                         double noncentrality);

/// The budget of a speed that a witness confirms. With a share K of the difference to be expected
/// as the positions' error, the speed less K times the difference is the weighted mean of both: the
/// rows of what the witness does not share count by 1 - K, the witness's own error by K (row g),
/// and that the mean is not what is stated by K times the difference (row e). So the speed by
/// position keeps its place, and what is stated with it holds what the witness says.
void condition_on(const WitnessedSpeed& witnessed, std::vector<BudgetRow>& rows);

/// Expanded uncertainty (k = 2, m/s) to be expected of a window beside velocities of a receiver:
/// 0.1 m/s at each epoch, and never better than `least_velocity_sigma_m_s` altogether. They are
/// taken to differ from the positions by the median of what chance makes of the positions' own
/// errors.
double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s);

/// Standard uncertainty (m/s) by the rows that a witness does not share, with undetected errors
/// (row d) or without.
enum class Undetected { counted, left_out };
double position_uncertainty(const std::vector<BudgetRow>& rows, Undetected undetected);

}  // namespace runcert
