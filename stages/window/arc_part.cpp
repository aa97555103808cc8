#include "stages/window/arc_part.h"

#include <algorithm>
#include <cmath>

namespace runcert {

template <int Axes>
ArcPart<Axes> part_around(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                          EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const double from_s = epochs[window.first].time_s - margin_s;
    const double to_s = epochs[window.last].time_s + margin_s;
    std::size_t first = window.first;
    while (first > 0 && epochs[first - 1].time_s >= from_s)
        --first;
    while (!epochs[first].measurement)
        ++first;
    std::size_t end = window.last + 1;
    while (end < epochs.size() && epochs[end].time_s <= to_s)
        ++end;
    const auto cut = [&](const auto& all) {
        return std::remove_cvref_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                                  all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {.arc = {.number = arc.number, .rows = cut(arc.rows), .epochs = cut(epochs)},
            .times = cut(times),
            .window = {window.first - first, window.last - first},
            .whole = first == 0 && end == epochs.size()};
}

template <int Axes>
double memory_s(const Arc<Axes>& arc, EpochPair window, const EstimationModel& model) {
    constexpr double time_constants = 28.0;
    double variance_m2 = 0.0;
    for (std::size_t k = window.first; k <= window.last; ++k)
        if (const auto& measurement = arc.epochs[k].measurement)
            variance_m2 = std::max(variance_m2, measurement->covariance.trace());
    variance_m2 *= model.measurement_scale * model.measurement_scale;
    const double interval_s = (arc.epochs[window.last].time_s - arc.epochs[window.first].time_s) /
                              static_cast<double>(window.last - window.first);
    const GaussMarkovError& error = model.error;
    const double slow_m2 =
        std::max(std::pow(error.initial_sigma_m, 2),
                 0.5 * error.tau_s * error.process_density * error.process_density);
    const auto uncertain_s = [&](double density) {
        return std::cbrt(std::sqrt(density) / model.motion.jerk_density);
    };
    return time_constants *
           (error.tau_s + 2.0 * interval_s + 2.0 * uncertain_s(variance_m2 * interval_s) +
            2.0 * uncertain_s(2.0 * slow_m2 * error.tau_s));
}

#define RUNCERT_INSTANTIATE(AXES)                                                               \
    template ArcPart<AXES> part_around<AXES>(const Arc<AXES>&, const std::vector<ElapsedTime>&, \
                                             EpochPair, double);                                \
    template double memory_s<AXES>(const Arc<AXES>&, EpochPair, const EstimationModel&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)

}  // namespace runcert
