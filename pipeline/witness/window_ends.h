#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "schemas/common/table.h"

namespace runcert {

/// Indices of the first and the last epoch of a window.
struct EpochPair {
    std::size_t first = 0;
    std::size_t last = 0;
};

/// For each epoch, the first later one that is at least `duration` away; nothing where there is
/// none, or where it is further than one `nominal_interval` beyond. Times must increase. Linear.
std::vector<std::optional<std::size_t>> window_ends(std::span<const ElapsedTime> times,
                                                    double duration_s, double duration_tolerance_s,
                                                    double nominal_interval_s);

}  // namespace runcert
