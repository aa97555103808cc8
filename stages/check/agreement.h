#pragma once

#include <string>

#include "stages/check/check.h"

namespace runcert {

/// What the second receiver says of the window that is judged: speeds by displacement over time.
struct Agreement {
    std::string missing;  ///< why it says nothing; empty where it does
    double judged_m_s = 0.0;
    double other_m_s = 0.0;
    /// Of what the two do not share.
    double judged_standard_uncertainty_m_s = 0.0;
    double other_standard_uncertainty_m_s = 0.0;
    /// Difference over the root sum of squares of both expanded uncertainties (k = 2) of what the
    /// two do not share; at most 1 means agreement (ISO/IEC 17043).
    double normalised_error = 0.0;

    bool agrees() const { return missing.empty() && normalised_error <= 1.0; }
    bool contradicts() const { return missing.empty() && !agrees(); }
};

/// Compares the speed of the judged receiver's window with that of the other receiver's smoothed
/// trajectory over the same GPS time, to the microsecond: between its epochs, by the mean of the
/// motion model (the quintic through position, velocity and acceleration of both). It says nothing
/// where times are relative, or it does not cover the window by one arc of usable epochs without a
/// bridged step.
///
/// Antennas move differently in a turn: what the vector between them, turning with the track,
/// accounts for is taken off the other's displacement, where both are in one frame and their
/// distance is one that fits on a craft.
///
/// An error that both share shows in neither: base station, satellites and atmosphere, the frame's
/// scale, the time scale. The uncertainties that the difference is compared with are therefore
/// those of what each has of its own (`own_standard_uncertainty_m_s`): of the judged window, and of
/// the other's best window of the profile (`other_window`; where it has none, as the judged one's),
/// or what its positions at the two ends say, taken as independent, if that is larger.
Agreement compare_speeds(const ReceiverFindings& judged, const CertifiableWindow& window,
                         const ReceiverFindings& other, const CertifiableWindow* other_window);

}  // namespace runcert
