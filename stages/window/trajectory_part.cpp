#include "stages/window/trajectory_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "core/failure.h"

namespace runcert {
namespace {

/// Where the trajectory is not the part smoothed.
struct TrajectoryDifference {
    std::int64_t epoch = 0;
    double difference_m = 0.0;
};

/// The first of the window's ends where the two differ.
template <int Axes>
std::optional<TrajectoryDifference> difference_from(const TrajectoryTable& trajectory,
                                                    const ArcPart<Axes>& part,
                                                    const SmoothedArc<Axes>& smoothed) {
    constexpr double tolerance_m = 2e-6;  // coordinates are written to a micrometre
    for (const std::size_t k : {part.window.first, part.window.last}) {
        const TrajectoryEpoch& row = trajectory.rows[part.arc.rows[k]];
        const SpeedVector<Axes> position =
            smoothed.states[k].mean.template head<speed_axes<Axes>>();
        SpeedVector<Axes> written;
        if constexpr (Axes == 1)
            written << *row.up_m;
        else
            written << *row.east_m, *row.north_m;
        const double difference_m = (position - written).norm();
        if (difference_m > tolerance_m) return TrajectoryDifference{row.epoch, difference_m};
    }
    return std::nullopt;
}

}  // namespace

template <int Axes>
CheckedPart<Axes> checked_estimate(const AxesEstimate<Axes>& estimate, const FoundWindow& found) {
    const Arc<Axes>& arc = estimate.arcs[found.series];
    const EpochPair window{found.first, found.last};
    const double memory = std::max(stretch_margin_s, memory_s(arc, window, estimate.model));
    for (const double margin_s : {memory, std::numeric_limits<double>::infinity()}) {
        CheckedPart<Axes> checked{
            .part = part_around(arc, estimate.times[found.series], window, margin_s),
            .smoothed = {}};
        // Again, as the trajectory does not hold what the errors of two epochs have in common.
        checked.smoothed = smooth<Axes>(checked.part.arc.epochs, estimate.model);
        const auto different = difference_from(estimate.trajectory, checked.part, checked.smoothed);
        if (!different) return checked;
        if (checked.part.whole)
            throw Failure(fmt::format("epoch {}", different->epoch),
                          fmt::format("the trajectory is {:.1e} m from the estimate of the same "
                                      "screened epochs",
                                      different->difference_m),
                          "Run runcert-smooth again, with the same attempt");
    }
    return {};
}

template CheckedPart<1> checked_estimate<1>(const AxesEstimate<1>&, const FoundWindow&);
template CheckedPart<2> checked_estimate<2>(const AxesEstimate<2>&, const FoundWindow&);

}  // namespace runcert
