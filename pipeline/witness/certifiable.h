#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/common/table.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// Indices of the first and the last epoch of a window.
struct EpochPair {
    std::size_t first = 0;
    std::size_t last = 0;
};

/// For each epoch, the first later one at least `duration_s` away (to the tolerance). Empty if
/// there is none, or if it is more than one nominal interval beyond. Times must increase. The
/// cost is linear.
std::vector<std::optional<std::size_t>> window_ends(std::span<const ElapsedTime> times,
                                                    double duration_s, double duration_tolerance_s,
                                                    double nominal_interval_s);

/// One arc's rows in a trajectory.
struct ArcRows {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;
};

/// The arcs of a trajectory, in order.
std::vector<ArcRows> arcs_in(const TrajectoryTable& trajectory);

/// The certifiable windows of each arc, in order, as indices into the arc's rows. They begin and
/// end at usable epochs of one arc and contain no unusable epoch. Each is `duration_s` long, to the
/// tolerance; where no epoch is exactly that far, the next one is taken. The cost is linear.
std::vector<std::vector<EpochPair>> certifiable_windows(const TrajectoryTable& trajectory,
                                                        const std::vector<ArcRows>& arcs,
                                                        double duration_s,
                                                        double duration_tolerance_s);

}  // namespace runcert
