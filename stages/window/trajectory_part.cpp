#include "stages/window/trajectory_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "core/failure.h"
#include "core/uncertainty.h"
#include "stages/window/instants.h"
#include "witness/window_speed.h"

namespace runcert {

namespace {

/// How far (m) the trajectory is from the smoothed part at one of its epochs.
template <int Axes>
double apart_m(const TrajectoryEpoch& row, const StateVector<Axes>& smoothed) {
    if constexpr (Axes == 1)
        return std::abs(smoothed(0) - *row.up_m);
    else
        return std::hypot(smoothed(0) - *row.east_m, smoothed(1) - *row.north_m);
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
        // Smoothed again, because the trajectory does not hold the correlation of the errors of two
        // epochs.
        checked.smoothed = Chain<Axes>(checked.part.arc.epochs, estimate.model);
        constexpr double tolerance_m = 2e-6;  // coordinates are written to a micrometre
        bool agrees = true;
        for (const std::size_t k : {checked.part.window.first, checked.part.window.last}) {
            const TrajectoryEpoch& row = estimate.trajectory.rows[checked.part.arc.rows[k]];
            const double off_m = apart_m<Axes>(row, checked.smoothed.mean(k));
            agrees = agrees && off_m <= tolerance_m;
            if (!agrees && checked.part.whole)
                throw Failure(fmt::format("epoch {}", row.epoch),
                              fmt::format("the trajectory is {:.1e} m from the estimate of the "
                                          "same screened epochs",
                                          off_m),
                              "Run runcert-smooth again, with the same attempt");
        }
        if (agrees) return checked;
    }
    return {};
}

template CheckedPart<1> checked_estimate<1>(const AxesEstimate<1>&, const FoundWindow&);
template CheckedPart<2> checked_estimate<2>(const AxesEstimate<2>&, const FoundWindow&);

template <int Axes>
ArcPart<Axes> part_around(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                          EpochPair window, double margin_s) {
    const EpochPair reach = reach_around(arc, window, margin_s);
    const std::size_t first = reach.first, end = reach.last + 1;
    const auto cut = [&](const auto& all) {
        return std::remove_cvref_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                                  all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {.arc = {.number = arc.number, .rows = cut(arc.rows), .epochs = cut(arc.epochs)},
            .times = cut(times),
            .window = {window.first - first, window.last - first},
            .whole = first == 0 && end == arc.epochs.size()};
}

template ArcPart<1> part_around<1>(const Arc<1>&, const std::vector<ElapsedTime>&, EpochPair,
                                   double);
template ArcPart<2> part_around<2>(const Arc<2>&, const std::vector<ElapsedTime>&, EpochPair,
                                   double);

std::optional<RobustSpeed> robust_speed(const TrajectoryTable& trajectory, const ArcPart<2>& part,
                                        const Chain<2>& smoothed, double model_m_s) {
    const Arc<2>& arc = part.arc;
    const EpochPair& window = part.window;
    const double duration_s = arc.epochs[window.last].time_s - arc.epochs[window.first].time_s;
    const SpeedEstimate screened = smoothed_speed(smoothed, window, duration_s, {});
    const TrajectoryEpoch& first = trajectory.rows[arc.rows[window.first]];
    const TrajectoryEpoch& last = trajectory.rows[arc.rows[window.last]];
    if (!first.robust_east_m || !last.robust_east_m) return std::nullopt;
    RobustSpeed robust;
    robust.speed_m_s = std::hypot(*last.robust_east_m - *first.robust_east_m,
                                  *last.robust_north_m - *first.robust_north_m) /
                       duration_s;
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
