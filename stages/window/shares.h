#pragma once

#include <vector>

#include "schemas/windows/windows.h"
#include "stages/window/combination.h"

// What witnesses leave of a budget's rows.

namespace runcert {

/// Standard deviation (m, each axis) of a time-correlated error that positions and phases of one
/// antenna may share: half of what rules take positions with fixed ambiguities to err by. A phase
/// is never disturbed by more than a quarter of its wave, 48 mm, and a position by several
/// satellites less.
inline constexpr double shared_by_phases_m = 0.010;

/// What the witnesses of a window make of its speed: their shares, and what is left of the rows of
/// the positions beside them.
struct HeardTogether {
    double position_share = 1.0;
    double difference_m_s = 0.0;  ///< speed by positions less the weighted mean of all
};

/// Weighs the positions, as the budget has them, and the witnesses that agree and confirm, and sets
/// the shares; those of all are 0 where one contradicts the positions, or they one another.
/// `evidence` gets what they say together.
HeardTogether hear_together(const PositionTerms& positions, double correlated_m_s,
                            std::vector<WitnessedSpeed>& witnesses, SpeedEvidence& evidence);

/// The budget of a speed beside witnesses with shares. The speed less the difference from the
/// weighted mean is that mean: the rows of what the witnesses do not share count by what is left to
/// the positions, each witness's own error by its share (rows g), and the speed stated is that by
/// positions, so that the difference remains (row e). Another receiver has the positions' own
/// time-correlated error in full (row b).
///
/// Carrier phases come from the same antenna: multipath moves them and the positions alike, and
/// their difference does not show it. Row s is what both may share (`shared_by_phases_m`).
void condition_on(const std::vector<WitnessedSpeed>& witnesses, double correlated_m_s,
                  double remaining_difference_m_s, std::vector<BudgetRow>& rows);

/// Expanded uncertainty (k = 2, m/s) to be expected of a window beside velocities of a receiver:
/// 0.1 m/s at each epoch, and never better than `least_velocity_sigma_m_s` altogether. They are
/// taken to differ from the positions by the median of what chance makes of the positions' own
/// errors.
double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s);

/// The rows of the positions by what witnesses share of them.
PositionTerms position_terms(const std::vector<BudgetRow>& rows);

}  // namespace runcert
