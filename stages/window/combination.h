#pragma once

#include <span>
#include <vector>

#include "estimation/speed_mixture.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"

// Positions and witnesses by one rule: an error that nothing found counts by its probability, and
// the speeds of all are weighed by one covariance.

namespace runcert {

/// A window's fault: with its probability, and with that of the window chosen among its rivals.
struct WindowFault {
    FaultPrior prior;
    bool is_shown = false;  ///< the recorded velocities show that they or the positions err
    double chosen_probability = 0.0;

    /// Standard uncertainty (m/s): that of a rare error is its root mean square ([GUM] 4.3, C.3.2).
    double standard_uncertainty_m_s(double times = 1.0) const;
};

/// How likely positions with an error that nothing found are, and how large it is.
///
/// `probability` is that of fixed ambiguities in 3 s under open sky (`window.fault_probability`).
/// It grows with the window; it is five times as large where screening rejected an epoch within a
/// minute of it, 25 times of other solutions, and never above 0.05. The largest effect is that of
/// the largest undetected error of any kind, drifts included, but at most 3 m over the window's
/// time, which a wrong fix is off by, or 30 m of positions by code: a tenth of a chip of the C/A
/// code. Of a path it is twice that, and then upwards alone.
///
/// A window chosen as the fastest is one that such an error may have made so: its probability grows
/// with each rival that does not overlap it, by half of what of the largest effect its being slower
/// leaves.
///
/// `unexplained_m_s`: as below. Above 0 it is the positions that err, or the velocities, all over
/// the recording: the probability is a half.
WindowFault window_fault(const ScreenedTable& screened, const FoundWindow& found,
                         const std::vector<FoundWindow>& all, EpochPair rows,
                         const std::vector<UndetectedError>& reliability, bool by_path,
                         double probability, double unexplained_m_s = 0.0);

/// The standard deviation (m/s, each axis) of an error that lasts, which displacements of up to 10
/// s by recorded velocities and by positions differ by, where neither twice the positions' stated
/// errors, the white noise of the velocities, nor what these are stated to err by explains it; 0
/// where they do, and up to 0.07 m/s (upwards 0.1), which good receivers leave.
double unexplained_by_velocities_m_s(const ScreenedTable& screened, TestedAxes axes);

/// A window's speed by positions, by what its errors come from, m/s.
struct PositionTerms {
    double own_m_s = 0.0;    ///< what no witness shares
    double slow_m_s = 0.0;   ///< time-correlated errors (row b)
    double fault_m_s = 0.0;  ///< standard uncertainty of what nothing found (row d)
};

/// What a witness says beside them.
struct WitnessTerm {
    double difference_m_s = 0.0;  ///< speed by positions less that by the witness
    double own_m_s = 0.0;         ///< its standard uncertainty, without what it shares
    double shared_m_s = 0.0;      ///< time-correlated error that it shares with the positions
    bool shares_slow = false;     ///< another receiver: it may have all of the positions' own
    FaultPrior fault = {};
};

/// The weights of positions and witnesses whose mean has the least variance of those that are not
/// negative; they add up to 1.
struct WeightedSpeed {
    double positions = 1.0;
    std::vector<double> witnesses;
    double difference_m_s = 0.0;  ///< speed by positions less the mean
};
WeightedSpeed weigh(const PositionTerms& positions, std::span<const WitnessTerm> witnesses);

/// The mean of one witness at least, weighed among themselves. Whether another receiver's
/// time-correlated error is the positions' own is not known: their difference is taken to show
/// both, and the mean to be no better for it.
struct WitnessMean {
    double difference_m_s = 0.0;  ///< speed by positions less the mean
    double standard_uncertainty_m_s = 0.0;
    double common_m_s = 0.0;   ///< of that, what it shares with the positions
    double besides_m_s = 0.0;  ///< what else it may share, beside that uncertainty
    FaultPrior fault;
};
WitnessMean mean_of_witnesses(const PositionTerms& positions,
                              std::span<const WitnessTerm> witnesses);

/// How far the speeds are from one, where none is at fault: the sum of squares in units of what
/// chance makes of it once in a thousand.
double disagreement(const PositionTerms& positions, std::span<const WitnessTerm> witnesses);

}  // namespace runcert
