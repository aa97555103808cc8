#pragma once

#include <vector>

#include "stages/window/certify.h"
#include "witness/certifiable.h"

namespace runcert {

/// What a window is expected to be certified with, from one that has been certified, so that the
/// one of the highest assured speed can be looked for before each is.
struct Reference {
    const CertifiableWindow& window;
    const FoundWindow& found;
};

/// For any window of the recording, the expanded uncertainty that it is expected to have under the
/// profile: that of the reference, by source, in proportion. What positions' errors make goes with
/// the stated standard deviation of the window's epochs over its duration; what an undetected error
/// makes, with the largest that screening may have kept in it; and of the witnesses what they
/// say of this very window. Infinite where a witness contradicts the window: nothing can be
/// claimed.
///
/// `level` and `upright` are the witnesses of horizontal and vertical motion. Linear to set up; a
/// window costs the logarithm of the rows, and what its witnesses take to answer.
Allowance expected_allowance(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<ArcRows>& arcs, const Profile& profile,
                             const Reference& reference, const HeardWitnesses<2>& level,
                             const HeardWitnesses<1>& upright);

}  // namespace runcert
