#include "stages/window/robust.h"

#include <cmath>

#include "core/uncertainty.h"
#include "estimation/speed.h"

namespace runcert {
namespace {

/// Displacement (m) of the robust batch. It keeps positions alone: the motion over a bridged step
/// is that of the screened solution.
std::optional<Eigen::Vector2d> robust_displacement(const TrajectoryTable& trajectory,
                                                   const ArcPart<2>& part,
                                                   const SmoothedArc<2>& smoothed) {
    const EpochPair& window = part.window;
    const auto row = [&](std::size_t k) -> const TrajectoryEpoch& {
        return trajectory.rows[part.arc.rows[k]];
    };
    if (!row(window.first).robust_east_m || !row(window.last).robust_east_m) return std::nullopt;
    const auto difference = [&](std::size_t first, std::size_t last) {
        return Eigen::Vector2d(
            row(last).robust_east_m.value() - row(first).robust_east_m.value(),
            row(last).robust_north_m.value() - row(first).robust_north_m.value());
    };
    Eigen::Vector2d moved = difference(window.first, window.last);
    for (const BridgedStep& step : smoothed.bridged_between(window.first, window.last))
        moved += displacement(smoothed, step.epoch - 1, step.epoch) -
                 difference(step.epoch - 1, step.epoch);
    return moved;
}

}  // namespace

std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const SmoothedArc<2>& smoothed, double model_m_s) {
    const Arc<2>& arc = part.arc;
    const EpochPair& window = part.window;
    const double duration_s = arc.epochs[window.last].time_s - arc.epochs[window.first].time_s;
    const SpeedEstimate screened =
        displacement_speed(smoothed, window.first, window.last, duration_s);
    const auto displacement = robust_displacement(trajectory, part, smoothed);
    if (!displacement) return std::nullopt;
    RobustSpeed robust;
    robust.speed_m_s = std::hypot(displacement->x(), displacement->y()) / duration_s;
    robust.difference_m_s = robust.speed_m_s - screened.speed_m_s;
    robust.limit_m_s = usual_coverage_factor * (screened.standard_uncertainty_m_s + model_m_s);
    robust.agrees = std::abs(robust.difference_m_s) <= robust.limit_m_s;
    for (std::size_t k = window.first; k <= window.last; ++k) {
        const auto& weight = trajectory.rows[arc.rows[k]].robust_weight;
        if (weight && *weight < 0.5) ++robust.downweighted;
    }
    return robust;
}

}  // namespace runcert
