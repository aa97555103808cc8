#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

#include "motion/chain.h"
#include "motion/speed.h"
#include "schemas/windows/windows.h"
#include "witness/certifiable.h"

// The measured speed of a window: what each definition makes of a track's positions and velocities.

namespace runcert {

/// What is measured as the speed of a window.
struct SpeedQuantity {
    SpeedDefinition definition = SpeedDefinition::displacement;
    /// For elapsed_time: the length, and the unit normals (east, north), along the course, of the
    /// lines crossed at the window's two ends.
    double length_m = 0.0;
    Eigen::Vector2d start_normal = Eigen::Vector2d::Zero();
    Eigen::Vector2d finish_normal = Eigen::Vector2d::Zero();
    /// For path_length: the window ends where the path has reached a given length. An error of the
    /// path is then one of time, at the speed of the window's slower end.
    bool length_is_given = false;
    /// The displacement between the unsmoothed measured positions at the window's ends.
    bool of_samples = false;
};

/// Whether a speed is a mean of the samples' speeds.
bool is_mean(SpeedDefinition definition);

/// Whether a definition's speed corresponds to a witness's path, rather than its displacement.
bool counts_path(SpeedDefinition definition);

/// 1 for each of east, north and up that counts in a speed of this dimension, otherwise 0.
Eigen::Vector3d axes_of_speed(Dimension dimension);

/// A track as its samples, by index: position (m) and velocity (m/s), vectors of the axes that
/// count. Each is asked for only where a definition needs it.
template <class Position, class Velocity>
struct SpeedTrack {
    Position position;
    Velocity velocity;
};
template <class Position, class Velocity>
SpeedTrack(Position, Velocity) -> SpeedTrack<Position, Velocity>;

struct NoDerivative {
    template <class Vector>
    void operator()(std::size_t, const Vector&) const {}
};

/// Speed (m/s) over the samples x_k, v_k from `first` to `last` of a track, which take T =
/// `duration_s`:
///
///     displacement   |x_last - x_first| / T
///     path_length    sum of |x_(k+1) - x_k| / T
///     mean_n_plus_1  mean of |v_k|
///     mean_n         the same without the first
///     elapsed_time   length_m / T; the displacement where the track has not two axes
///
/// Calls `by_position(k, derivative)` (1/s) and `by_velocity(k, derivative)` with its derivatives,
/// which add up for each k. A step without length, or a velocity of zero, has none. For
/// elapsed_time, a position error along a line's normal shifts the instant of its crossing by that
/// error over the speed along the normal.
template <class Track, class ByPosition = NoDerivative, class ByVelocity = NoDerivative>
double speed_of(const Track& track, EpochPair window, double duration_s,
                const SpeedQuantity& quantity, const ByPosition& by_position = {},
                const ByVelocity& by_velocity = {}) {
    using Vector = decltype(track.position(std::size_t{}));
    const auto [first, last] = window;
    double sum = 0.0;
    if (is_mean(quantity.definition)) {
        const std::size_t from = first + (quantity.definition == SpeedDefinition::mean_n ? 1 : 0);
        const auto count = static_cast<double>(last + 1 - from);
        for (std::size_t k = from; k <= last; ++k) {
            const auto velocity = track.velocity(k);
            const double speed_m_s = velocity.norm();
            sum += speed_m_s;
            if (speed_m_s > 0.0) by_velocity(k, (velocity / (speed_m_s * count)).eval());
        }
        return sum / std::max(count, 1.0);
    }
    if constexpr (Vector::RowsAtCompileTime == 2)
        if (quantity.definition == SpeedDefinition::elapsed_time) {
            const double per_second = quantity.length_m / (duration_s * duration_s);
            const auto add = [&](std::size_t k, double sign, const Eigen::Vector2d& normal) {
                by_position(k, (sign * per_second / normal.dot(track.velocity(k)) * normal).eval());
            };
            add(first, -1.0, quantity.start_normal);
            add(last, 1.0, quantity.finish_normal);
            return quantity.length_m / duration_s;
        }
    const std::size_t stride =
        quantity.definition == SpeedDefinition::path_length ? 1 : last - first;
    Vector before = track.position(first);
    for (std::size_t k = first; k < last; k += stride) {
        const Vector after = track.position(k + stride);
        const Vector step = after - before;
        const double step_m = step.norm();
        sum += step_m;
        before = after;
        if (!(step_m > 0.0)) continue;
        const Vector direction = step / (step_m * duration_s);
        by_position(k, (-direction).eval());
        by_position(k + stride, direction);
    }
    return sum / duration_s;
}

/// The speed over a window by the four definitions that need no course.
template <class Track>
SpeedDefinitions definitions_of(const Track& track, EpochPair window, double duration_s) {
    const auto by = [&](SpeedDefinition definition) {
        return speed_of(track, window, duration_s, {.definition = definition});
    };
    return {.displacement_m_s = by(SpeedDefinition::displacement),
            .path_length_m_s = by(SpeedDefinition::path_length),
            .mean_n_plus_1_m_s = by(SpeedDefinition::mean_n_plus_1),
            .mean_n_m_s = by(SpeedDefinition::mean_n)};
}

/// The smoothed states of an arc as a track, which must not outlive them. Horizontal; with heights
/// alone (Axes 1) vertical.
template <int Axes>
auto smoothed_track(const Chain<Axes>& smoothed) {
    constexpr int counted = speed_axes<Axes>;
    return SpeedTrack{[&smoothed](std::size_t k) -> SpeedVector<Axes> {
                          return smoothed.mean(k).template head<counted>();
                      },
                      [&smoothed](std::size_t k) -> SpeedVector<Axes> {
                          return smoothed.mean(k).template segment<counted>(Axes);
                      }};
}

/// The gradients of such a window's speed with respect to the states from `window.first` to
/// `window.last`, as `Chain::variance` and `Chain::weights` take them.
template <int Axes>
Gradients<Axes> speed_gradients(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                                const SpeedQuantity& quantity);

/// That speed, with its uncertainty from the joint covariance of all states it depends on. For a
/// displacement of zero it is that of the least certain direction.
template <int Axes>
SpeedEstimate smoothed_speed(const Chain<Axes>& smoothed, EpochPair window, double duration_s,
                             const SpeedQuantity& quantity);

}  // namespace runcert
