#pragma once

#include <limits>
#include <span>
#include <vector>

#include "stages/window/certify.h"
#include "stages/window/window_fault.h"

// A contradiction lasts: where a witness contradicted the positions, they are suspect for the rest
// of the motion, until the same witness has shown them sound again.

namespace runcert {

/// A fault's probability where a witness makes positions suspect.
inline constexpr double as_likely_as_not = 0.5;

/// A window in which a witness contradicts the positions.
struct Contradiction {
    std::size_t series = 0;  ///< the arc
    TimeSpan window;
    WitnessKind kind = WitnessKind::velocities;
    std::string receiver = {};
    double drift_m_s = 0.0;  ///< by how much the displacements differ there
    /// The last instant before the window, and the first one after it, from which to which and
    /// beyond the positions are sound again. They are for windows of up to `sound_over_s`.
    double sound_until_s = -std::numeric_limits<double>::infinity();
    double sound_from_s = std::numeric_limits<double>::infinity();
    double sound_over_s = 0.0;
};

/// The contradictions in a certified window of an arc, and differences of more than the 95 % of all
/// witnesses together. Before and after it, this looks for the nearest span a fifth longer than the
/// window in which the same witness shows the positions sound: it agrees within the standard
/// uncertainty of the difference, and would have found the same drift with a probability of 0.8 by
/// a test of size 0.05.
template <int Axes>
std::vector<Contradiction> contradictions_in(const AxesEstimate<Axes>& estimate,
                                             const FoundWindow& found,
                                             const CertifiableWindow& window);

/// The contradiction by which the positions of another window of the arc are suspect. Such a window
/// lies before the positions were shown to be sound, and the witness (`witnesses`, with the
/// window's other ones) does not show it of the window itself. Null if there is none.
const Contradiction* suspected_by(std::span<const Contradiction> contradictions,
                                  const FoundWindow& window,
                                  std::span<const WitnessedSpeed> witnesses);

/// Takes the positions of a window to be as likely at fault as not where such a contradiction makes
/// them suspect. It does the same where a witness of the window (`witnesses`) differs from them by
/// more than the 95 % of both, and none contradicts them outright. Returns whether one does.
bool suspect(std::span<const Contradiction> contradictions, const FoundWindow& window,
             std::span<const WitnessedSpeed> witnesses, WindowFault& fault);

}  // namespace runcert
