#pragma once

#include "inertial/inertial_filter.h"

namespace runcert {

/// Passes from one start, until the attitude stays.
struct Passes {
    InertialPass last;  ///< smoothed
    int count = 0;
    /// What the last pass turned the attitude by about an axis, at most, in units of what it may:
    /// the greater of 1e-3 rad and a tenth of the standard deviation.
    double turned = 0.0;
};

/// Forwards in closed loop and backwards, then about the smoothed trajectory until the attitude
/// stays, 12 times at most. With a trajectory given, the first pass is about that.
Passes run_passes(const InertialData& data, const InertialPrior& prior,
                  std::vector<InertialNominal> about = {});

}  // namespace runcert
