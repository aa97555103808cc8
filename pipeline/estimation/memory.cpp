#include "estimation/memory.h"

#include <algorithm>
#include <cmath>

namespace runcert {

template <int Axes>
double memory_s(std::span<const ArcEpoch<Axes>> epochs, const EstimationModel& model) {
    constexpr double time_constants = 28.0;
    double variance_m2 = 0.0;
    double least_factor = epochs.back().jerk_factor;
    for (const ArcEpoch<Axes>& epoch : epochs) {
        least_factor = std::min(least_factor, epoch.jerk_factor);
        if (epoch.measurement)
            variance_m2 = std::max(variance_m2, epoch.measurement->covariance.trace());
    }
    variance_m2 *= model.measurement_scale * model.measurement_scale;
    const double interval_s =
        (epochs.back().time_s - epochs.front().time_s) / static_cast<double>(epochs.size() - 1);
    const GaussMarkovError& error = model.error;
    const double slow_m2 =
        std::max(error.initial_sigma_m * error.initial_sigma_m,
                 0.5 * error.tau_s * error.process_density * error.process_density);
    const auto uncertain_s = [&](double density) {
        return std::cbrt(std::sqrt(density) / (least_factor * model.motion.jerk_density));
    };
    return time_constants *
           (error.tau_s + 2.0 * interval_s + 2.0 * uncertain_s(variance_m2 * interval_s) +
            2.0 * uncertain_s(2.0 * slow_m2 * error.tau_s));
}

template double memory_s<1>(std::span<const ArcEpoch<1>>, const EstimationModel&);
template double memory_s<2>(std::span<const ArcEpoch<2>>, const EstimationModel&);

}  // namespace runcert
