#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

namespace runcert::velocities {

/// A recorded horizontal position and the horizontal speed recorded with it.
struct SpeedBesidePosition {
    double time_s = 0.0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    std::optional<double> speed_m_s = std::nullopt;
};

/// Origin of recorded speeds.
enum class Origin {
    independent,  ///< no difference of the positions reproduces them
    positions,    ///< the device computed them from its positions, so they are no witness
    unclear,      ///< too few, or rounded too coarsely relative to the positions' noise
};

/// How positions are differenced: from the previous epoch, to the next, or between both.
enum class Difference { backward, forward, central };

/// The origin of recorded speeds, and the comparison that shows it.
struct OriginFound {
    Origin origin = Origin::unclear;
    /// The difference nearest to the speeds, averaged over `before` epochs before each epoch to
    /// `after` epochs after it.
    Difference difference = Difference::backward;
    int before = 0, after = 0;
    double residual_m_s = 0.0;  ///< robust scatter of the speeds around it
    double noise_m_s = 0.0;     ///< scatter expected from the positions' white noise
    std::size_t compared = 0;   ///< number of epochs
};

/// The white noise of the positions (m, each coordinate), from their differences of third to sixth
/// order. The smallest counts, so that motion is not taken for noise. 0 if there are too few.
double white_noise_m(std::span<const SpeedBesidePosition> rows);

/// The step (m/s) that all speeds are multiples of. 0.01 where it is finer, or cannot be seen.
double speed_resolution_m_s(std::span<const SpeedBesidePosition> rows);

/// Whether recorded speeds are differences of the recorded positions, and of which type.
///
/// An independently measured speed differs from every difference of positions by at least that
/// difference's noise, which the positions' white errors cause (`white_noise_m`). Speeds within a
/// fifth of this noise, beyond rounding, were computed from the positions. Where rounding alone
/// would hide this, the answer is `unclear`.
///
/// `rows` are in order of time, in s and m; gaps are allowed. `position_resolution_m` is the
/// rounding of the positions. Only magnitudes of velocities are compared, so a rounded course has
/// no effect. Never fails.
OriginFound origin_of_speeds(std::span<const SpeedBesidePosition> rows,
                             double position_resolution_m);

}  // namespace runcert::velocities
