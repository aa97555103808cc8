#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

// The delay of recorded speeds behind the positions by their lengths alone: over a wide range, and
// along the recording.

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
