#include "stages/window/craft_speeds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace runcert {
namespace {

/// The components of motion that a rule counts.
Eigen::Vector3d counted(const Eigen::Vector3d& vector, Dimension dimension) {
    switch (dimension) {
        case Dimension::horizontal:
            return {vector.x(), vector.y(), 0.0};
        case Dimension::vertical:
            return {0.0, 0.0, vector.z()};
        case Dimension::space:
            return vector;
    }
    return vector;
}

/// The epochs of a solution that enclose a span.
struct SpanEpochs {
    std::size_t first = 0;
    std::size_t last = 0;
};

constexpr double same_instant_s = 1e-7;

std::optional<SpanEpochs> epochs_of(const InertialSolution& solution, const PointSpan& span) {
    if (!solution.consistency.consistent() || solution.epochs.empty()) return std::nullopt;
    const auto found = solution.enclosing(span.from_s, span.to_s);
    if (!found || solution.bridged_between(found->first, found->second)) return std::nullopt;
    return SpanEpochs{found->first, found->second};
}

/// A speed as a function of a point's motion at the epochs that enclose its span.
struct PointSpeed {
    double m_s = 0.0;
    std::vector<PointGradient> gradients;
};

const PointMotion& motion_at(const InertialSolution& solution, std::size_t epoch,
                             CraftPoint point) {
    const InertialEpoch& at = solution.epochs[epoch];
    return point == CraftPoint::antenna ? at.antenna : at.reference_point;
}

/// The speeds of a point over a span.
class PointSpeeds {
  public:
    PointSpeeds(const InertialSolution& solution, SpanEpochs at, const PointSpan& span,
                CraftPoint point)
        : solution_(solution), at_(at), span_(span), point_(point) {}

    PointSpeed by(SpeedDefinition definition) const {
        switch (definition) {
            case SpeedDefinition::path_length:
                return by_position(true);
            case SpeedDefinition::mean_n_plus_1:
                return mean(first_inside());
            case SpeedDefinition::mean_n:
                return mean(first_inside() + 1);
            case SpeedDefinition::displacement:
            case SpeedDefinition::elapsed_time:
                break;
        }
        return by_position(false);
    }

  private:
    /// An instant of the span, and how its position hangs on those of two epochs.
    struct Knot {
        std::size_t before = 0;
        double share_after = 0.0;
        Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
    };

    Knot knot(std::size_t before, double time_s) const {
        const InertialEpoch& from = solution_.epochs[before];
        const InertialEpoch& to = solution_.epochs[before + 1];
        const double share = (time_s - from.time_s) / (to.time_s - from.time_s);
        return {before, std::clamp(share, 0.0, 1.0), position_between(from, to, time_s, point_)};
    }

    std::vector<Knot> knots(bool all) const {
        std::vector<Knot> knots{knot(at_.first, span_.from_s)};
        for (std::size_t k = at_.first + 1; all && k < at_.last; ++k)
            knots.push_back({k, 0.0, motion_at(solution_, k, point_).position_m});
        knots.push_back(knot(at_.last - 1, span_.to_s));
        return knots;
    }

    void add(const Knot& knot, const Eigen::Vector3d& gradient, PointSpeed& speed) const {
        const std::size_t k = knot.before - at_.first;
        speed.gradients[k].position += (1.0 - knot.share_after) * gradient;
        if (knot.share_after > 0.0) speed.gradients[k + 1].position += knot.share_after * gradient;
    }

    /// Length of the displacement, or of the path, over time.
    PointSpeed by_position(bool path) const {
        PointSpeed speed{.m_s = 0.0,
                         .gradients = std::vector<PointGradient>(at_.last - at_.first + 1)};
        const double duration_s = span_.to_s - span_.from_s;
        const std::vector<Knot> all = knots(path);
        for (std::size_t i = 1; i < all.size(); ++i) {
            const Eigen::Vector3d step =
                counted(all[i].position_m - all[i - 1].position_m, span_.dimension);
            const double step_m = step.norm();
            if (!(step_m > 0.0)) continue;
            speed.m_s += step_m / duration_s;
            add(all[i], step / (step_m * duration_s), speed);
            add(all[i - 1], -step / (step_m * duration_s), speed);
        }
        return speed;
    }

    /// The first epoch that lies in the span.
    std::size_t first_inside() const {
        return solution_.epochs[at_.first].time_s < span_.from_s - same_instant_s ? at_.first + 1
                                                                                  : at_.first;
    }

    /// Mean of the speeds of the epochs from `first` on.
    PointSpeed mean(std::size_t first) const {
        const bool beyond = solution_.epochs[at_.last].time_s > span_.to_s + same_instant_s;
        const std::size_t last = beyond ? at_.last - 1 : at_.last;
        PointSpeed speed{.m_s = 0.0,
                         .gradients = std::vector<PointGradient>(at_.last - at_.first + 1)};
        if (last < first) return speed;
        const double share = 1.0 / static_cast<double>(last - first + 1);
        for (std::size_t k = first; k <= last; ++k) {
            const Eigen::Vector3d velocity =
                counted(motion_at(solution_, k, point_).velocity_m_s, span_.dimension);
            const double norm = velocity.norm();
            speed.m_s += share * norm;
            if (norm > 0.0) speed.gradients[k - at_.first].velocity = share * velocity / norm;
        }
        return speed;
    }

    const InertialSolution& solution_;
    SpanEpochs at_;
    const PointSpan& span_;
    CraftPoint point_;
};

/// By how much the lever's own motion along the track differs at the two ends, over time.
double lag_effect(const InertialSolution& solution, SpanEpochs at, const PointSpan& span) {
    const InertialEpoch& first = solution.epochs[at.first];
    const InertialEpoch& last = solution.epochs[at.last];
    const Eigen::Vector3d moved =
        counted(last.antenna.position_m - first.antenna.position_m, span.dimension);
    if (!(moved.norm() > 0.0)) return 0.0;
    const auto swings = [](const InertialEpoch& epoch) -> Eigen::Vector3d {
        return epoch.reference_point.velocity_m_s - epoch.antenna.velocity_m_s;
    };
    return moved.normalized().dot(swings(last) - swings(first)) / (span.to_s - span.from_s);
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> epochs_within(const InertialSolution& solution,
                                                                 const WindowSpan& span) {
    const auto at = epochs_of(solution, {.from_s = span.start.seconds(),
                                         .to_s = span.start.seconds() + span.duration.seconds()});
    if (!at) return std::nullopt;
    return std::pair(at->first, at->last);
}

std::optional<CraftCorrection> craft_correction(const InertialSolution& solution,
                                                const PointSpan& span) {
    const auto at = epochs_of(solution, span);
    if (!at) return std::nullopt;
    const PointSpeeds of_reference(solution, *at, span, CraftPoint::reference_point);
    const PointSpeeds of_antenna(solution, *at, span, CraftPoint::antenna);
    const auto faster = [&](SpeedDefinition definition) {
        return of_reference.by(definition).m_s - of_antenna.by(definition).m_s;
    };
    const PointVariance variance =
        solution.difference_variance(at->first, of_reference.by(span.definition).gradients,
                                     of_antenna.by(span.definition).gradients);
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
        const Eigen::Vector3d moved = epoch->reference_point.position_m - epoch->antenna.position_m;
        const Eigen::Vector3d swings =
            epoch->reference_point.velocity_m_s - epoch->antenna.velocity_m_s;
        *row.east_m += moved.x();
        *row.north_m += moved.y();
        if (row.up_m) *row.up_m += moved.z();
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
        PointSpeeds(solution, *at, stretch, CraftPoint::reference_point).by(profile.definition);
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
    for (auto* const list : {&windows.profiles, &windows.with_files})
        for (ProfileWindows& found : *list) {
            const auto profile = std::ranges::find(profiles, found.profile, &Profile::id);
            if (profile == profiles.end()) continue;
            const auto set = [&](auto& window) {
                window.points =
                    craft_speeds(solution, *profile, window.span, window.speed_m_s,
                                 2.0 * window.standard_uncertainty_m_s + window.bias_limit_m_s);
            };
            if (found.best) set(*found.best);
            if (found.fastest) set(*found.fastest);
            for (FurtherWindow& further : found.further)
                set(further);
        }
}

}  // namespace runcert
