#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "motion/epoch_motion.h"

// Estimates the delay of recorded velocities relative to the positions, for the velocity check.

namespace runcert::velocities {

/// Least number of epochs for a comparison of recorded velocities.
inline constexpr std::size_t least_comparisons = 30;

/// A velocity at a time of an arc, with its acceleration.
struct Knot {
    std::size_t row = 0;
    std::int64_t arc = 0;
    double time_s = 0.0;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
};
using Knots = std::vector<Knot>;

/// Velocity and acceleration between knots, by the cubic that has both at either end (Hermite), in
/// the arc of knot `near`, where the search starts. Empty outside the arc.
std::optional<Knot> motion_at(const Knots& knots, std::size_t near, double time_s);

/// A usable row with a recorded velocity, and the knot of its smoothed motion.
struct Comparison {
    std::size_t knot = 0;
    Eigen::Vector2d recorded = Eigen::Vector2d::Zero();
};

/// An estimated delay with its standard uncertainty.
struct Delay {
    std::optional<double> delay_s;  ///< empty if undetermined
    double sigma_s = 0.0;
};

/// The delay of the least of a profile: the mean square of residuals at each delay within
/// `range_s` of `middle_s`, on a grid of `step_s` and then by the parabola through the least and
/// its neighbours. Its standard uncertainty follows from the curvature, for so many `independent`
/// residuals. Undetermined where the least lies at the end of the range.
Delay delay_of(const std::function<double(double delay_s)>& mean_square, double middle_s,
               double range_s, double step_s, double independent);

/// Standard deviation on each axis of normally distributed two-dimensional vectors whose squared
/// norm has the quantile `squared_norm` at `probability`.
double scale_of(double squared_norm, double probability);

/// The delay d of v_recorded(t) = v(t - d), between minus and plus `limit_s`. It is a Huber
/// M-estimate (`delay_of`, with Huber's criterion in place of the square). Undetermined where
/// hardly any epoch accelerates, where the criterion is least at the end of the range, or where the
/// standard uncertainty exceeds half an interval. It may then lie anywhere in the range, and its
/// standard uncertainty is that.
Delay estimate_delay(const Knots& knots, const Motion& motion, const std::vector<Comparison>& all,
                     double limit_s, double interval_s);

}  // namespace runcert::velocities

// Estimates the delay of recorded speeds from their magnitudes alone: over a wide range, and along
// the recording.

namespace runcert::velocities {

/// Delays are searched between minus and plus this. Watches have been seen to lose a minute.
inline constexpr double delay_range_s = 120.0;

/// A row of a recording: the speed computed from its positions, and the recorded one (m/s).
struct SpeedPair {
    double time_s = 0.0;
    std::optional<double> by_positions_m_s = std::nullopt;
    std::optional<double> recorded_m_s = std::nullopt;
};

/// A part of a recording with a single delay.
struct DelayStretch {
    std::size_t first = 0, last = 0;  ///< indices into the pairs
    double delay_s = 0.0;
    double sigma_s = 0.0;
    /// Mean absolute difference of the speeds, at this delay and at the best one within the limit.
    /// Recorded speeds are divided by their factor.
    double difference_m_s = 0.0;
    double difference_within_m_s = 0.0;

    bool is_beyond(double limit_s) const;
};

/// The delays d of |v_recorded|(t) = c |v|(t - d), in order of time, with one factor c for all.
/// They minimise the differences of the speeds, integrated over time, plus a price for each change
/// of the delay [Viterbi67].
///
/// Of delays that explain the speeds equally well, the smaller is taken, and a late one rather than
/// an early one. Some stretches are left out: those shorter than two minutes (half of a shorter
/// recording, but at least a minute), those whose delay leaves more than three tenths of the
/// variation of the speeds unexplained, and those beyond `limit_s` that do not explain a fifth more
/// than the best within it. `pairs` are rows in the recording's order. A time that goes back begins
/// another session. Never fails.
std::vector<DelayStretch> delays_along(std::span<const SpeedPair> pairs, double limit_s);

}  // namespace runcert::velocities
