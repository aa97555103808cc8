#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/common/table.h"
#include "schemas/trajectory/trajectory.h"

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

/// The rows of one arc, as a trajectory has them.
struct ArcRows {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;
};

std::vector<ArcRows> arcs_in(const TrajectoryTable& trajectory);

/// Whether a window that can be certified may span a bridged step.
enum class BridgedSteps { refused, allowed };

/// The windows that can be certified, for each arc in order: they begin and end at usable epochs of
/// one arc, hold no unusable epoch, span no bridged step unless that is allowed, and are as long as
/// asked for (to the tolerance; where no epoch is exactly so far, the next one). The ends are
/// indices into the arc's rows. Linear.
std::vector<std::vector<EpochPair>> certifiable_windows(const TrajectoryTable& trajectory,
                                                        const std::vector<ArcRows>& arcs,
                                                        double duration_s,
                                                        double duration_tolerance_s,
                                                        BridgedSteps bridged);

}  // namespace runcert
