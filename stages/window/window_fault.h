#pragma once

#include <string>
#include <vector>

#include "motion/joint_speeds.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/best_window.h"
#include "stages/window/lasting_difference.h"
#include "witness/certifiable.h"

namespace runcert {

/// The largest probability of a rare error. Above it, root mean squares no longer hold 95 %.
inline constexpr double largest_rare_probability = 0.05;

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
/// minute of the window, and 25 times for other solutions, but never more than that of a rare
/// error. The largest effect is that of the largest undetected error of any type, drifts included.
/// It is at most 3 m over the window's time, the error of an incorrect fix, or 30 m for code
/// positions: a tenth of a chip of the C/A code. For a path it is twice that, and then only
/// upwards.
///
/// Such an error may be what made a chosen window the fastest. Its probability grows with each
/// rival that does not overlap it, by half of the fraction of the largest effect that remains after
/// the rival's deficit in speed.
///
/// `lasting` comes from `lasting_difference`. The probability is then at least that with which the
/// positions drift all over the recording.
WindowFault window_fault(const ScreenedTable& screened, const FoundWindow& found,
                         const std::vector<FoundWindow>& all, EpochPair rows,
                         const std::vector<UndetectedError>& reliability, bool by_path,
                         double probability, const LastingDifference& lasting = {});

}  // namespace runcert
