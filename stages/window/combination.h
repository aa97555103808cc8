#pragma once

#include <span>
#include <string>
#include <vector>

#include "motion/speed_mixture.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/best_window.h"
#include "stages/window/lasting_difference.h"
#include "witness/certifiable.h"

// Combines positions and witnesses by one rule. An undetected error counts by its probability, and
// all speeds are weighted by one joint covariance.

namespace runcert {

/// A fault of a window: its prior, and its probability once the window is chosen among its rivals.
struct WindowFault {
    FaultPrior prior;
    double chosen_probability = 0.0;
    /// The finding that makes it likelier than a rare error, as row d states it. Empty if there is
    /// none.
    std::string shown = {};

    /// Raises both probabilities to at least `probability`, and the largest effect to at least
    /// `largest_m_s`, because of a finding.
    void raise(double probability, double largest, std::string finding);

    /// Standard uncertainty (m/s): the root mean square of a rare error ([GUM] 4.3, C.3.2).
    double standard_uncertainty_m_s(double times = 1.0) const;
};

/// Probability and size of an undetected error of the positions.
///
/// `probability` holds for fixed ambiguities in 3 s under open sky (`window.fault_probability`). It
/// grows with the window. It is five times as large where screening rejected an epoch within a
/// minute of the window, and 25 times for other solutions, but never above 0.05. The largest effect
/// is that of the largest undetected error of any type, drifts included. It is at most 3 m over the
/// window's time, the error of an incorrect fix, or 30 m for code positions: a tenth of a chip of
/// the C/A code. For a path it is twice that, and then only upwards.
///
/// Such an error may be what made a chosen window the fastest. Its probability grows with each
/// rival that does not overlap it, by half of the fraction of the largest effect that remains after
/// the rival's deficit in speed.
///
/// `lasting` comes from the function below. The probability is then at least that with which the
/// positions drift all over the recording.
WindowFault window_fault(const ScreenedTable& screened, const FoundWindow& found,
                         const std::vector<FoundWindow>& all, EpochPair rows,
                         const std::vector<UndetectedError>& reliability, bool by_path,
                         double probability, const LastingDifference& lasting = {});

/// Standard deviation (m/s, each axis) of a lasting error, from the difference of displacements of
/// up to 10 s by recorded velocities and by positions. It is what remains unexplained by twice the
/// positions' stated errors, the white noise of the velocities and the velocities' stated errors. 0
/// if all is explained, and up to 0.07 m/s (vertically 0.1), which good receivers leave.
double unexplained_by_velocities_m_s(const ScreenedTable& screened, TestedAxes axes);

/// That error, weighed as a scale of the velocities and as a drift of the positions. `velocities`
/// are the recorded ones as a witness; null if there are none.
template <int Axes>
LastingDifference lasting_difference(const ScreenedTable& screened,
                                     const Witness<Axes>* velocities);

/// A window's speed by positions, by source of error, m/s.
struct PositionTerms {
    double own_m_s = 0.0;    ///< not shared by any witness
    double slow_m_s = 0.0;   ///< time-correlated errors (row b)
    double fault_m_s = 0.0;  ///< standard uncertainty of undetected errors (row d)
};

/// The terms of a witness.
struct WitnessTerm {
    double difference_m_s = 0.0;  ///< speed by positions minus by the witness
    double own_m_s = 0.0;         ///< standard uncertainty without the shared part
    double shared_m_s = 0.0;      ///< time-correlated error that it shares with the positions
    bool shares_slow = false;     ///< another receiver, which may have all of the positions' own
    FaultPrior fault = {};
};

/// The non-negative weights of positions and witnesses whose mean has least variance. They sum to
/// 1.
struct WeightedSpeed {
    double positions = 1.0;
    std::vector<double> witnesses;
    double difference_m_s = 0.0;  ///< speed by positions minus the mean
};
/// The weighted mean of positions and witnesses.
WeightedSpeed weigh(const PositionTerms& positions, std::span<const WitnessTerm> witnesses);

/// The weighted mean of one or more witnesses. It is unknown whether another receiver's
/// time-correlated error is the positions' own. Their difference is therefore assumed to show both,
/// and the mean is assumed to gain nothing from it.
struct WitnessMean {
    double difference_m_s = 0.0;  ///< speed by positions minus the mean
    double standard_uncertainty_m_s = 0.0;
    double common_m_s = 0.0;   ///< the part shared with the positions
    double besides_m_s = 0.0;  ///< a further part that it may share, in addition to that
                               ///< uncertainty
    FaultPrior fault;
};
/// The weighted mean of the witnesses alone. There must be at least one.
WitnessMean mean_of_witnesses(const PositionTerms& positions,
                              std::span<const WitnessTerm> witnesses);

/// Disagreement of the speeds if none is at fault: the sum of squares divided by the value that
/// chance exceeds once in a thousand.
double disagreement(const PositionTerms& positions, std::span<const WitnessTerm> witnesses);

}  // namespace runcert
