#include "witness/window_speed.h"

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"

namespace runcert {

bool is_mean(SpeedDefinition definition) {
    return definition == SpeedDefinition::mean_n_plus_1 || definition == SpeedDefinition::mean_n;
}

bool counts_path(SpeedDefinition definition) {
    return definition == SpeedDefinition::path_length || is_mean(definition);
}

Eigen::Vector3d axes_of_speed(Dimension dimension) {
    if (dimension == Dimension::horizontal) return {1.0, 1.0, 0.0};
    return dimension == Dimension::vertical ? Eigen::Vector3d(0.0, 0.0, 1.0)
                                            : Eigen::Vector3d::Ones();
}

template <int Axes>
Gradients<Axes> speed_gradients(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                                const SpeedQuantity& quantity) {
    constexpr int counted = speed_axes<Axes>;
    constexpr double standing_m_s = 0.1;
    Gradients<Axes> gradients(window.last - window.first + 1, StateVector<Axes>::Zero());
    const auto track = smoothed_track(smoothed);
    const auto add_to = [&](Eigen::Index row) {
        return [&, row](std::size_t k, const SpeedVector<Axes>& derivative) {
            gradients[k - window.first].template segment<counted>(row) += derivative;
        };
    };
    const double speed_m_s = speed_of(track, window, duration_s, quantity, add_to(0), add_to(Axes));
    if (quantity.definition != SpeedDefinition::path_length || !quantity.length_is_given)
        return gradients;
    // The length is reached earlier or later, at the speed of the end.
    const double slower_m_s =
        std::min(track.velocity(window.first).norm(), track.velocity(window.last).norm());
    for (StateVector<Axes>& gradient : gradients)
        gradient *= std::max(1.0, speed_m_s / std::max(slower_m_s, standing_m_s));
    return gradients;
}

template <int Axes>
SpeedEstimate smoothed_speed(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                             const SpeedQuantity& quantity) {
    const auto [first, last] = window;
    const double speed_m_s = speed_of(smoothed_track(smoothed), window, duration_s, quantity);
    double variance = 0.0;
    if (quantity.definition == SpeedDefinition::displacement && speed_m_s == 0.0)
        variance =
            symmetric_eigenvalues(displacement_covariance(smoothed, first, last)).maxCoeff() /
            (duration_s * duration_s);
    else
        variance =
            smoothed.variance(first, speed_gradients(smoothed, window, duration_s, quantity));
    return {speed_m_s, std::sqrt(std::max(variance, 0.0))};
}

#define RUNCERT_INSTANTIATE(AXES)                                                         \
    template Gradients<AXES> speed_gradients<AXES>(const Chain<AXES>&, EpochPair, double, \
                                                   const SpeedQuantity&);                 \
    template SpeedEstimate smoothed_speed<AXES>(const Chain<AXES>&, EpochPair, double,    \
                                                const SpeedQuantity&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
