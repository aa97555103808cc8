#include "stages/window/craft_speeds.h"

#include <algorithm>
#include <cmath>

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

std::optional<std::size_t> epoch_at(const InertialSolution& solution, double time_s) {
    constexpr double same_instant_s = 1e-7;
    const auto found = std::ranges::lower_bound(solution.epochs, time_s - same_instant_s, {},
                                                &InertialEpoch::time_s);
    if (found == solution.epochs.end() || found->time_s > time_s + same_instant_s)
        return std::nullopt;
    return static_cast<std::size_t>(found - solution.epochs.begin());
}

struct Speed {
    double m_s = 0.0;
    double variance = 0.0;
};

Eigen::Vector3d position(const InertialSolution& solution, std::size_t epoch) {
    return solution.epochs[epoch].reference_point.position_m;
}

/// Displacement, or length of the path, over time.
Speed speed_of_positions(const InertialSolution& solution, std::size_t s, std::size_t e,
                         Dimension dimension, bool path) {
    const double duration_s = solution.epochs[e].time_s - solution.epochs[s].time_s;
    std::vector<PointGradient> gradients(e - s + 1);
    double length_m = 0.0;
    for (std::size_t from = s; from < e;) {
        const std::size_t to = path ? from + 1 : e;
        const Eigen::Vector3d step =
            counted(position(solution, to) - position(solution, from), dimension);
        const double step_m = step.norm();
        length_m += step_m;
        if (step_m > 0.0) {
            gradients[to - s].position += step / (step_m * duration_s);
            gradients[from - s].position -= step / (step_m * duration_s);
        }
        from = to;
    }
    return {length_m / duration_s, solution.variance(s, gradients, CraftPoint::reference_point)};
}

/// Mean of the speeds of the epochs from `first` on.
Speed mean_of_speeds(const InertialSolution& solution, std::size_t first, std::size_t e,
                     Dimension dimension) {
    std::vector<PointGradient> gradients(e - first + 1);
    const double share = 1.0 / static_cast<double>(gradients.size());
    double mean_m_s = 0.0;
    for (std::size_t k = first; k <= e; ++k) {
        const Eigen::Vector3d velocity =
            counted(solution.epochs[k].reference_point.velocity_m_s, dimension);
        const double speed = velocity.norm();
        mean_m_s += share * speed;
        if (speed > 0.0) gradients[k - first].velocity = share * velocity / speed;
    }
    return {mean_m_s, solution.variance(first, gradients, CraftPoint::reference_point)};
}

std::optional<Speed> speed_by(const InertialSolution& solution, const Profile& profile,
                              std::size_t s, std::size_t e) {
    switch (profile.definition) {
        case SpeedDefinition::displacement:
            return speed_of_positions(solution, s, e, profile.dimension, false);
        case SpeedDefinition::path_length:
            return speed_of_positions(solution, s, e, profile.dimension, true);
        case SpeedDefinition::mean_n_plus_1:
            return mean_of_speeds(solution, s, e, profile.dimension);
        case SpeedDefinition::mean_n:
            return mean_of_speeds(solution, s + 1, e, profile.dimension);
        case SpeedDefinition::elapsed_time:
            return std::nullopt;
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::pair<std::size_t, std::size_t>> epochs_within(const InertialSolution& solution,
                                                                 const WindowSpan& span) {
    if (!solution.consistency.consistent()) return std::nullopt;
    const auto s = epoch_at(solution, span.start.seconds());
    const auto e = epoch_at(solution, span.start.seconds() + span.duration.seconds());
    if (!s || !e || *e <= *s || solution.bridged_between(*s, *e)) return std::nullopt;
    return std::pair(*s, *e);
}

CraftSpeeds craft_speeds(const InertialSolution& solution, const Profile& profile,
                         const WindowSpan& span, double antenna_speed_m_s) {
    CraftSpeeds speeds{.antenna_speed_m_s = antenna_speed_m_s};
    const auto within = epochs_within(solution, span);
    if (!within || profile.speed_source == SpeedSource::velocity) return speeds;
    if (const auto speed = speed_by(solution, profile, within->first, within->second)) {
        constexpr double coverage_factor = 2.0;
        speeds.reference_point_speed_m_s = speed->m_s;
        speeds.reference_point_expanded_uncertainty_m_s =
            coverage_factor * std::sqrt(std::max(0.0, speed->variance));
    }
    return speeds;
}

void add_craft_speeds(const InertialSolution& solution, const std::vector<Profile>& profiles,
                      Windows& windows) {
    for (ProfileWindows& found : windows.profiles) {
        const auto profile = std::ranges::find(profiles, found.profile, &Profile::id);
        if (profile == profiles.end()) continue;
        const auto set = [&](auto& window) {
            window.points = craft_speeds(solution, *profile, window.span, window.speed_m_s);
        };
        if (found.best) set(*found.best);
        if (found.fastest) set(*found.fastest);
        for (FurtherWindow& further : found.further)
            set(further);
    }
}

}  // namespace runcert
