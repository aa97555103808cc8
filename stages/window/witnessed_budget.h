#pragma once

#include <vector>

#include "motion/joint_speeds.h"
#include "schemas/windows/windows.h"
#include "stages/window/window_fault.h"

// The budget of a window's speed with its witnesses. Rows and witnesses become one vector of
// speeds with one covariance (motion/joint_speeds.h), and its weighted mean becomes rows again.

namespace runcert {

/// Standard deviation (m, each axis) of a time-correlated error that positions and phases of one
/// antenna may share: half of the error that rules assume for positions with fixed ambiguities. A
/// phase is never disturbed by more than a quarter of its wavelength, 48 mm, and a position from
/// several satellites by less.
inline constexpr double shared_by_phases_m = 0.010;

/// The positions as a source of speed, by the rows that touch them alone or other receivers. The
/// speed stays 0.
SpeedBySource positions_of(const std::vector<BudgetRow>& rows, const FaultPrior& fault = {});

/// A window's speed with its witnesses.
struct WitnessedBudget {
    std::vector<WitnessedSpeed> witnesses;  ///< with their shares
    std::vector<BudgetRow> rows;
    SpeedEvidence evidence;
    double position_share = 1.0;  ///< factor on the rows of the positions
    double bias_m_s = 0.0;        ///< of the choice of the window, to be subtracted
};

/// Combines the budget by positions alone with the witnesses that confirm. All shares are 0 if a
/// witness contradicts the positions, or the witnesses contradict one another.
///
/// The speed less its difference from the weighted mean is that mean. Rows that touch the positions
/// alone count by their weight, and each witness's own error by its weight (rows g).
/// Time-correlated errors count by the weights of all that may have them: row b as far as phases do
/// not share them, row s as far as they do. The stated speed is that by positions, so that the
/// difference remains (row e). The positions' part of the bias of the choice is told by the
/// witnesses between its limits, as far as they count.
WitnessedBudget combine_with_witnesses(const std::vector<BudgetRow>& alone,
                                       const WindowFault& fault, const SelectionBias& selection,
                                       std::vector<WitnessedSpeed> witnesses);

/// Least expanded uncertainty (m/s) with witnesses: the half-width about the stated speed of the
/// mixture whose fault probability is printed, with the coverage of two standard deviations.
///
/// A fault that the witnesses leave no likelier than it was widens nothing: the result is then at
/// most `alone_m_s`, the expanded uncertainty by positions alone. Where no witness has a share, the
/// fault has the probability that the budget takes, without the window's rivals, and widens nothing
/// up to the largest of a rare one.
double least_expanded_m_s(const SpeedEvidence& evidence, double speed_m_s, double alone_m_s);

/// Adds row x to the budget of a window that has witnesses, so that its expanded uncertainty is at
/// least that. `alone` is the budget by positions alone.
void cover_fault_mixture(double coverage_factor, const std::vector<BudgetRow>& alone,
                         CertifiableWindow& window);

/// Expanded uncertainty (k = 2, m/s) to be expected for a window if a receiver's velocities were
/// also available. They are assumed to err by 0.1 m/s at each epoch, and by at least
/// `least_velocity_sigma_m_s` overall. They are assumed to differ from the positions by the median
/// that chance makes of the positions' own errors.
double expected_with_velocities(const std::vector<BudgetRow>& rows, double own_uncertainty_m_s,
                                double bias_limit_m_s, double duration_s, double interval_s);

}  // namespace runcert
