#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "estimation/epoch_motion.h"

// The delay of recorded velocities behind the positions: the part of the velocity check that
// estimates.

namespace runcert::velocities {

inline constexpr std::size_t least_comparisons = 30;

/// A velocity at a time of an arc, with its slope.
struct Knot {
    std::size_t row = 0;
    std::int64_t arc = 0;
    double time_s = 0.0;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
    Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};
using Knots = std::vector<Knot>;

/// The first of the two knots about `time_s` in the arc of knot `near`, where the search starts.
/// Nothing outside the arc.
std::optional<std::size_t> knot_before(const Knots& knots, std::size_t near, double time_s);

/// Velocity and acceleration between knots by the cubic that has both at either end (Hermite);
/// the covariance linearly between theirs. Nothing outside the arc.
std::optional<Knot> motion_at(const Knots& knots, std::size_t near, double time_s);

/// A usable row with a recorded velocity, and the knot of its smoothed motion.
struct Comparison {
    std::size_t knot = 0;
    Eigen::Vector2d recorded = Eigen::Vector2d::Zero();
};

struct Delay {
    std::optional<double> delay_s;  ///< empty if not told
    double sigma_s = 0.0;
};

/// Standard deviation for each axis of two-dimensional vectors whose squared norm has the given
/// quantile at `probability`, for normal errors.
double scale_of(double squared_norm, double probability);

/// The delay d of v_recorded(t) = v(t - d), looked for between minus and plus `limit_s`, by a Huber
/// M-estimate, refined from a grid by reweighted least squares. Not told where hardly any epoch
/// accelerates, where the criterion is least at the limit of the range, or where its standard
/// uncertainty is over half an interval.
Delay estimate_delay(const Knots& knots, const Motion& motion, const std::vector<Comparison>& all,
                     double limit_s, double interval_s);

}  // namespace runcert::velocities

// The delay of recorded speeds by their lengths alone: over a wide range, and along the recording.

namespace runcert::velocities {

/// Delays are looked for between minus and plus this: watches were seen to lose a minute.
inline constexpr double delay_range_s = 120.0;

/// A row of a recording: the speed that its positions make, and the recorded one (m/s).
struct SpeedPair {
    double time_s = 0.0;
    std::optional<double> by_positions_m_s = std::nullopt;
    std::optional<double> recorded_m_s = std::nullopt;
};

/// A part of a recording with one delay.
struct DelayStretch {
    std::size_t first = 0, last = 0;  ///< of the pairs
    double delay_s = 0.0;
    double sigma_s = 0.0;
    /// Mean of the differences of the speeds, without their signs: at this delay, and at the best
    /// within the limit; of the recorded speeds by their factor.
    double difference_m_s = 0.0;
    double difference_within_m_s = 0.0;

    bool is_beyond(double limit_s) const;
};

/// The delays d of |v_recorded|(t) = c |v|(t - d), in order of time, with one factor c for all:
/// those whose differences of the speeds, summed over time with a price for each change of the
/// delay, are the least [Viterbi67].
/// Of delays that explain the speeds alike the smaller is taken, and late rather than early. Left
/// out are stretches of less than two minutes (half of a shorter recording, a minute at least),
/// those of which the delay leaves more than three tenths of what the speeds change by, and delays
/// beyond `limit_s` that explain no fifth more than the best within it. `pairs`: rows in the
/// recording's order; a time that goes back begins another session. Never fails.
std::vector<DelayStretch> delays_along(std::span<const SpeedPair> pairs, double limit_s);

}  // namespace runcert::velocities
