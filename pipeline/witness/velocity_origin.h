#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

namespace runcert::velocities {

/// A recorded position in the plane with the recorded horizontal speed beside it.
struct SpeedBesidePosition {
    double time_s = 0.0;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    std::optional<double> speed_m_s = std::nullopt;
};

enum class Origin {
    independent,  ///< no difference of the positions gives them
    positions,    ///< the device computed them from its positions: they witness nothing
    unclear,      ///< too few, or what is recorded is too coarse beside the positions' noise
};

/// The difference of positions: between an epoch and the one before, the one after, or both.
enum class Difference { backward, forward, central };

struct OriginFound {
    Origin origin = Origin::unclear;
    /// The difference that comes nearest to the speeds, meaned over the epochs from `before` ahead
    /// of each to `after` behind it.
    Difference difference = Difference::backward;
    int before = 0, after = 0;
    double residual_m_s = 0.0;  ///< robust scatter of the speeds about it
    double noise_m_s = 0.0;     ///< what the positions' white noise makes it scatter by
    std::size_t compared = 0;   ///< epochs
};

/// The white noise of the positions (m, each coordinate) by their differences of third to sixth
/// order, of which the smallest counts, so that motion does not pass for noise; 0 where there are
/// too few.
double white_noise_m(std::span<const SpeedBesidePosition> rows);

/// The step (m/s) that all speeds are multiples of; 0.01 where it is finer, or hidden.
double speed_resolution_m_s(std::span<const SpeedBesidePosition> rows);

/// Whether recorded speeds are differences of the recorded positions, and of which kind.
///
/// A speed measured on its own differs from every difference of positions by at least the noise
/// that the positions' white errors (`white_noise_m`) give that difference. Speeds that lie within
/// a fifth of it, beyond rounding, were computed from the positions. Where rounding alone would
/// hide it the answer is `unclear`.
///
/// `rows`: in order of time, s and m; gaps are allowed. `position_resolution_m`: what the positions
/// are rounded to. Only the lengths of velocities are compared, so a rounded course does no harm.
/// Never fails.
OriginFound origin_of_speeds(std::span<const SpeedBesidePosition> rows,
                             double position_resolution_m);

}  // namespace runcert::velocities
