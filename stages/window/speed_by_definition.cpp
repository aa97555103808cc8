#include "stages/window/speed_by_definition.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"

namespace runcert {

template <int Axes>
EpochPair reach_around(const Arc<Axes>& arc, EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const double from_s = epochs[window.first].time_s - margin_s;
    const double to_s = epochs[window.last].time_s + margin_s;
    std::size_t first = window.first;
    while (first > 0 && epochs[first - 1].time_s >= from_s)
        --first;
    while (!epochs[first].measurement)
        ++first;
    std::size_t last = window.last;
    while (last + 1 < epochs.size() && epochs[last + 1].time_s <= to_s)
        ++last;
    return {first, last};
}

template <int Axes>
WindowStretch<Axes> cut_stretch(const Arc<Axes>& arc, EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const auto [first, last] = reach_around(arc, window, margin_s);
    WindowStretch<Axes> stretch;
    stretch.epochs.assign(epochs.begin() + static_cast<std::ptrdiff_t>(first),
                          epochs.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    stretch.window = {window.first - first, window.last - first};
    stretch.duration_s = epochs[window.last].time_s - epochs[window.first].time_s;
    stretch.first = first;
    return stretch;
}

namespace {

template <int Axes>
double speed_at(const Chain<Axes>& smoothed, std::size_t k) {
    return smoothed.mean(k).template segment<speed_axes<Axes>>(Axes).norm();
}

/// Factor from an error of the path, over the duration, to the speed over a given length. The
/// length is reached earlier or later, at the speed of the end.
template <int Axes>
double factor_of_given_length(const Chain<Axes>& smoothed, EpochPair window, double path_m_s) {
    constexpr double standing_m_s = 0.1;
    const double slower =
        std::min(speed_at(smoothed, window.first), speed_at(smoothed, window.last));
    return std::max(1.0, path_m_s / std::max(slower, standing_m_s));
}

[[noreturn]] void refuse_vertical_course() {
    throw Failure("speed over a course", "a course is crossed horizontally",
                  "This is a fault of the program; please report it");
}

/// Gradients of the length over the elapsed time. A position error along a line's normal shifts the
/// instant of its crossing by that error over the speed along the normal.
Gradients<2> elapsed_time_gradients(const Chain<2>& smoothed, EpochPair window, double duration_s,
                                    const SpeedQuantity& quantity) {
    const auto velocity = [&](std::size_t k) -> Eigen::Vector2d {
        return smoothed.mean(k).segment<2>(2);
    };
    const double per_second = quantity.length_m / (duration_s * duration_s);
    Gradients<2> gradients(window.last - window.first + 1, StateVector<2>::Zero());
    gradients.front().head<2>() -=
        per_second / quantity.start_normal.dot(velocity(window.first)) * quantity.start_normal;
    gradients.back().head<2>() +=
        per_second / quantity.finish_normal.dot(velocity(window.last)) * quantity.finish_normal;
    return gradients;
}

}  // namespace

template <int Axes>
SpeedEstimate speed_by_definition(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                                  const SpeedQuantity& quantity) {
    const auto [first, last] = window;
    switch (quantity.definition) {
        case SpeedDefinition::displacement:
            break;
        case SpeedDefinition::path_length: {
            SpeedEstimate speed = path_speed(smoothed, first, last, duration_s);
            if (quantity.length_is_given)
                speed.standard_uncertainty_m_s *=
                    factor_of_given_length(smoothed, window, speed.speed_m_s);
            return speed;
        }
        case SpeedDefinition::mean_n_plus_1:
            return mean_speed(smoothed, first, last);
        case SpeedDefinition::mean_n:
            return mean_speed(smoothed, first + 1, last);
        case SpeedDefinition::elapsed_time:
            if constexpr (Axes == 2) {
                const double variance = smoothed.variance(
                    first, elapsed_time_gradients(smoothed, window, duration_s, quantity));
                return {quantity.length_m / duration_s, std::sqrt(std::max(variance, 0.0))};
            }
            refuse_vertical_course();
    }
    return displacement_speed(smoothed, first, last, duration_s);
}

template <int Axes>
SpeedGradients<Axes> speed_gradients(const Chain<Axes>& smoothed, EpochPair window,
                                     double duration_s, const SpeedQuantity& quantity) {
    const auto [first, last] = window;
    switch (quantity.definition) {
        case SpeedDefinition::displacement:
            break;
        case SpeedDefinition::path_length: {
            Gradients<Axes> gradients = path_speed_gradients(smoothed, first, last, duration_s);
            if (quantity.length_is_given) {
                const double speed = path_speed(smoothed, first, last, duration_s).speed_m_s;
                for (StateVector<Axes>& gradient : gradients)
                    gradient *= factor_of_given_length(smoothed, window, speed);
            }
            return {first, std::move(gradients)};
        }
        case SpeedDefinition::mean_n_plus_1:
            return {first, mean_speed_gradients(smoothed, first, last)};
        case SpeedDefinition::mean_n:
            return {first + 1, mean_speed_gradients(smoothed, first + 1, last)};
        case SpeedDefinition::elapsed_time:
            if constexpr (Axes == 2)
                return {first, elapsed_time_gradients(smoothed, window, duration_s, quantity)};
            refuse_vertical_course();
    }
    return {first, displacement_speed_gradients(smoothed, first, last, duration_s)};
}

#define RUNCERT_INSTANTIATE(AXES)                                                              \
    template EpochPair reach_around<AXES>(const Arc<AXES>&, EpochPair, double);                \
    template WindowStretch<AXES> cut_stretch<AXES>(const Arc<AXES>&, EpochPair, double);       \
    template SpeedEstimate speed_by_definition<AXES>(const Chain<AXES>&, EpochPair, double,    \
                                                     const SpeedQuantity&);                    \
    template SpeedGradients<AXES> speed_gradients<AXES>(const Chain<AXES>&, EpochPair, double, \
                                                        const SpeedQuantity&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
