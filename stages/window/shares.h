#pragma once

#include <vector>

#include "schemas/windows/windows.h"
#include "stages/window/combination.h"

// Reduction of a budget's rows by witnesses.

namespace runcert {

/// Standard deviation (m, each axis) of a time-correlated error that positions and phases of one
/// antenna may share: half of the error that rules assume for positions with fixed ambiguities. A
/// phase is never disturbed by more than a quarter of its wavelength, 48 mm, and a position from
/// several satellites by less.
inline constexpr double shared_by_phases_m = 0.010;

/// The combined effect of a window's witnesses on its speed: their shares, and what remains of the
/// rows of the positions.
struct HeardTogether {
    double position_share = 1.0;
    double difference_m_s = 0.0;  ///< speed by positions minus the weighted mean of all
};

/// Weights the positions, as in the budget, and the witnesses that agree and confirm, and sets the
/// shares. All shares are 0 if a witness contradicts the positions, or the witnesses contradict
/// one another. The joint result is stored in `evidence`.
HeardTogether hear_together(const PositionTerms& positions, double correlated_m_s,
                            std::vector<WitnessedSpeed>& witnesses, SpeedEvidence& evidence);

/// Adapts the budget of a speed to witnesses with shares. The speed minus the difference from the
/// weighted mean is that mean. Rows that the witnesses do not share are therefore scaled by the
/// share of the positions, and each witness's own error is added by its share (rows g). The stated
/// speed is that by positions, so that the difference remains (row e). Another receiver has the
/// positions' own time-correlated error in full (row b).
///
/// Carrier phases come from the same antenna. Multipath moves them and the positions alike, and
/// their difference does not show it. Row s is what both may share (`shared_by_phases_m`).
void condition_on(const std::vector<WitnessedSpeed>& witnesses, double correlated_m_s,
                  double remaining_difference_m_s, std::vector<BudgetRow>& rows);

/// Expanded uncertainty (k = 2, m/s) to be expected for a window if a receiver's velocities were
/// also available. They are assumed to err by 0.1 m/s at each epoch, and by at least
/// `least_velocity_sigma_m_s` overall. They are assumed to differ from the positions by the median
/// that chance makes of the positions' own errors.
double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s);

/// The budget rows of the positions, combined into errors that no witness shares, time-correlated
/// errors (row b) and undetected errors (row d). Other rows are left out.
PositionTerms position_terms(const std::vector<BudgetRow>& rows);

}  // namespace runcert
