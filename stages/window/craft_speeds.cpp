#include "stages/window/craft_speeds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "witness/window_speed.h"

namespace runcert {
namespace {

constexpr double same_instant_s = 1e-7;

std::optional<EpochPair> epochs_of(const InertialSolution& solution, const PointSpan& span) {
    if (!solution.consistency.consistent() || solution.epochs.empty()) return std::nullopt;
    const auto found = solution.enclosing(span.from_s, span.to_s);
    if (!found || solution.bridged_between(found->first, found->second)) return std::nullopt;
    return EpochPair{found->first, found->second};
}

/// A speed as a function of a point's motion at the epochs that enclose its span.
struct PointSpeed {
    double m_s = 0.0;
    std::vector<PointGradient> gradients;
};

/// The speed of a point over a span. An end between two epochs lies on the cubic through both, and
/// its errors are shared between them. A mean is one of the epochs that lie in the span.
PointSpeed point_speed(const InertialSolution& solution, EpochPair at, const PointSpan& span,
                       CraftPoint point, SpeedDefinition definition) {
    const Eigen::Vector3d axes = axes_of_speed(span.dimension);
    const auto epoch = [&](std::size_t k) -> const InertialEpoch& { return solution.epochs[k]; };
    const auto before = [&](std::size_t k) { return k == at.last ? k - 1 : k; };
    const auto instant_s = [&](std::size_t k) {
        return k == at.first ? span.from_s : k == at.last ? span.to_s : epoch(k).time_s;
    };
    const SpeedTrack track{
        [&](std::size_t k) -> Eigen::Vector3d {
            return axes.cwiseProduct(
                position_between(epoch(before(k)), epoch(before(k) + 1), instant_s(k), point));
        },
        [&](std::size_t k) -> Eigen::Vector3d {
            return axes.cwiseProduct(
                (point == CraftPoint::antenna ? epoch(k).antenna : epoch(k).reference_point)
                    .velocity_m_s);
        }};
    EpochPair window = at;
    if (is_mean(definition)) {
        if (epoch(at.first).time_s < span.from_s - same_instant_s) ++window.first;
        if (epoch(at.last).time_s > span.to_s + same_instant_s) --window.last;
    }
    PointSpeed speed{.gradients = std::vector<PointGradient>(at.last - at.first + 1)};
    speed.m_s = speed_of(
        track, window, span.to_s - span.from_s, {.definition = definition},
        [&](std::size_t k, const Eigen::Vector3d& derivative) {
            const double from_s = epoch(before(k)).time_s, to_s = epoch(before(k) + 1).time_s;
            const double share = std::clamp((instant_s(k) - from_s) / (to_s - from_s), 0.0, 1.0);
            PointGradient* const gradients = &speed.gradients[before(k) - at.first];
            gradients[0].position += (1.0 - share) * derivative;
            gradients[1].position += share * derivative;
        },
        [&](std::size_t k, const Eigen::Vector3d& derivative) {
            speed.gradients[k - at.first].velocity += derivative;
        });
    return speed;
}

/// By how much the lever's own motion along the track differs at the two ends, over time.
double lag_effect(const InertialSolution& solution, EpochPair at, const PointSpan& span) {
    const InertialEpoch& first = solution.epochs[at.first];
    const InertialEpoch& last = solution.epochs[at.last];
    const Eigen::Vector3d chord_m =
        axes_of_speed(span.dimension)
            .cwiseProduct(last.antenna.position_m - first.antenna.position_m);
    if (!(chord_m.norm() > 0.0)) return 0.0;
    const auto swings = [](const InertialEpoch& epoch) -> Eigen::Vector3d {
        return epoch.reference_point.velocity_m_s - epoch.antenna.velocity_m_s;
    };
    return chord_m.normalized().dot(swings(last) - swings(first)) / (span.to_s - span.from_s);
}

}  // namespace

std::optional<EpochPair> epochs_within(const InertialSolution& solution, const WindowSpan& span) {
    return epochs_of(solution, {.from_s = span.start.seconds(),
                                .to_s = span.start.seconds() + span.duration.seconds()});
}

std::optional<CraftCorrection> craft_correction(const InertialSolution& solution,
                                                const PointSpan& span) {
    const auto at = epochs_of(solution, span);
    if (!at) return std::nullopt;
    const auto of = [&](CraftPoint point, SpeedDefinition definition) {
        return point_speed(solution, *at, span, point, definition);
    };
    const auto faster = [&](SpeedDefinition definition) {
        return of(CraftPoint::reference_point, definition).m_s -
               of(CraftPoint::antenna, definition).m_s;
    };
    const PointVariance variance = solution.difference_variance(
        at->first, of(CraftPoint::reference_point, span.definition).gradients,
        of(CraftPoint::antenna, span.definition).gradients);
    // Antenna and reference point were each measured from the IMU. The estimator's uncertainty is
    // that of the antenna alone.
    constexpr double of_both = std::numbers::sqrt2;
    return CraftCorrection{
        .speed_m_s =
            span.definition == SpeedDefinition::elapsed_time ? 0.0 : faster(span.definition),
        .definitions = {.displacement_m_s = faster(SpeedDefinition::displacement),
                        .path_length_m_s = faster(SpeedDefinition::path_length),
                        .mean_n_plus_1_m_s = faster(SpeedDefinition::mean_n_plus_1),
                        .mean_n_m_s = faster(SpeedDefinition::mean_n)},
        .attitude_m_s = std::sqrt(std::max(0.0, variance.by_errors)),
        .arm_m_s = of_both * std::sqrt(std::max(0.0, variance.by_arm)),
        .arm_sigma_m = of_both * solution.antenna_m.sigma.x(),
        .lag_m_s_per_s = lag_effect(solution, *at, span),
        .lag_sigma_s = solution.time_offset_s.sigma > 0.0 ? 0.0 : unseen_lag_s};
}

TrajectoryTable at_reference_point(TrajectoryTable trajectory, const InertialSolution& solution) {
    auto epoch = solution.epochs.begin();
    for (TrajectoryEpoch& row : trajectory.rows) {
        const double time_s = row.time.seconds();
        while (epoch != solution.epochs.end() && epoch->time_s < time_s - same_instant_s)
            ++epoch;
        const bool reached =
            epoch != solution.epochs.end() && epoch->time_s < time_s + same_instant_s;
        const bool ends_bridge = std::ranges::any_of(
            solution.bridged,
            [&](const BridgedStretch& bridged) { return bridged.to_s == time_s; });
        if (!reached || ends_bridge || !row.east_m || !row.velocity_east_m_s) {
            row.usable = false;
            continue;
        }
        const Eigen::Vector3d lever_m =
            epoch->reference_point.position_m - epoch->antenna.position_m;
        const Eigen::Vector3d swings =
            epoch->reference_point.velocity_m_s - epoch->antenna.velocity_m_s;
        *row.east_m += lever_m.x();
        *row.north_m += lever_m.y();
        if (row.up_m) *row.up_m += lever_m.z();
        *row.velocity_east_m_s += swings.x();
        *row.velocity_north_m_s += swings.y();
        if (row.velocity_up_m_s) *row.velocity_up_m_s += swings.z();
        row.speed_m_s = std::hypot(*row.velocity_east_m_s, *row.velocity_north_m_s);
    }
    return trajectory;
}

CraftSpeeds craft_speeds(const InertialSolution& solution, const Profile& profile,
                         const WindowSpan& span, double speed_m_s,
                         double expanded_uncertainty_m_s) {
    CraftSpeeds speeds{.antenna_speed_m_s = speed_m_s};
    if (profile.speed_source == SpeedSource::velocity ||
        profile.definition == SpeedDefinition::elapsed_time)
        return speeds;
    const PointSpan stretch{.from_s = span.start.seconds(),
                            .to_s = span.start.seconds() + span.duration.seconds(),
                            .definition = profile.definition,
                            .dimension = profile.dimension};
    const auto at = epochs_of(solution, stretch);
    if (!at) return speeds;
    const CraftCorrection correction = *craft_correction(solution, stretch);
    const PointSpeed by_imu =
        point_speed(solution, *at, stretch, CraftPoint::reference_point, profile.definition);
    if (profile.speed_of == SpeedOf::reference_point) {
        speeds.antenna_speed_m_s = speed_m_s - correction.speed_m_s;
        speeds.reference_point_speed_m_s = speed_m_s;
        speeds.reference_point_expanded_uncertainty_m_s = expanded_uncertainty_m_s;
    } else {
        constexpr double coverage_factor = 2.0;
        // It holds one of the two distances from the IMU, which were measured alike, and no clock.
        const double variance =
            solution.variance(at->first, by_imu.gradients, CraftPoint::reference_point);
        speeds.reference_point_speed_m_s = by_imu.m_s;
        speeds.reference_point_expanded_uncertainty_m_s =
            coverage_factor * std::hypot(std::sqrt(std::max(0.0, variance)),
                                         correction.arm_m_s / std::numbers::sqrt2,
                                         correction.lag_sigma_s * correction.lag_m_s_per_s);
    }
    return speeds;
}

void add_craft_speeds(const InertialSolution& solution, const std::vector<Profile>& profiles,
                      Windows& windows) {
    for_each_window(windows, [&](auto& window, const std::string& id) {
        const auto profile = std::ranges::find(profiles, id, &Profile::id);
        if (profile == profiles.end()) return;
        window.points = craft_speeds(solution, *profile, window.span, window.speed_m_s,
                                     2.0 * window.standard_uncertainty_m_s + window.bias_limit_m_s);
    });
}

}  // namespace runcert
