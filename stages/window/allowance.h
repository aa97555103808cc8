#pragma once

#include <vector>

#include "stages/window/certify.h"
#include "witness/certifiable.h"

namespace runcert {

/// A certified window from which to predict the uncertainty of others, so that the one with the
/// highest assured speed can be found before each is certified.
struct Reference {
    const CertifiableWindow& window;
    const FoundWindow& found;
};

/// The witnesses asked about a window. One that can only contradict makes an allowance infinite, or
/// changes nothing: without it allowances are the same or too small.
enum class AskedWitnesses { all, those_that_confirm };

/// Predicts the expanded uncertainty of any window of the recording under the profile: that of the
/// reference, scaled by source. The part from positions' errors is proportional to the stated
/// standard deviation of the window's epochs, and inversely to its duration. The part from
/// undetected errors scales with the largest that screening may have left in the window. Witnesses
/// are evaluated for each window itself. The result is infinite where a witness contradicts the
/// window, because no speed can be claimed. Windows that `contradictions` make suspect have the
/// fault probability of such, and no result is below the half-width of the mixture of faults.
///
/// `level` and `upright` are the witnesses of horizontal and vertical motion. Set-up is linear. A
/// window costs the logarithm of the rows, and the time its witnesses take to answer.
Allowance expected_allowance(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<ArcRows>& arcs, const Profile& profile,
                             const Reference& reference, const HeardWitnesses<2>& level,
                             const HeardWitnesses<1>& upright,
                             AskedWitnesses asked = AskedWitnesses::all,
                             std::span<const Contradiction> contradictions = {});

}  // namespace runcert
