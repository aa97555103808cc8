#include "stages/window/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arcs/arcs.h"
#include "arcs/noise_models.h"
#include "core/failure.h"
#include "estimation/speed.h"
#include "stages/window/best_window.h"
#include "stages/window/budget.h"
#include "stages/window/position_noise.h"
#include "stages/window/reliability.h"
#include "stages/window/selection.h"

namespace runcert {
namespace {

// Beyond a minute nothing measured changes the speed of a window.
constexpr double stretch_margin_s = 60.0;
// A window that many standard uncertainties slower than the best could not have been it.
constexpr double selection_width = 4.0;

Eigen::Vector2d position_of(const TrajectoryEpoch& row) {
    return {*row.east_m, *row.north_m};
}

/// Mean of a method's speeds over the window; nothing if one is missing.
std::optional<double> mean_over(const TrajectoryTable& trajectory, const ArcRows& arc,
                                EpochPair window, std::optional<double> TrajectoryEpoch::*method) {
    double sum = 0.0;
    for (std::size_t k = window.first; k <= window.last; ++k) {
        const auto& value = trajectory.rows[arc.rows[k]].*method;
        if (!value) return std::nullopt;
        sum += *value;
    }
    return sum / static_cast<double>(window.last - window.first + 1);
}

/// What all profiles' windows are certified from.
struct Evidence {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const WindowConfig& config;
    const NoiseSummary& noise;
    EstimationModel model;              ///< of the trajectory
    std::vector<WeightedModel> models;  ///< that the recording allows
    std::vector<Arc<2>> arcs;
    std::vector<ArcRows> rows;  ///< of each arc, in the trajectory
};

/// The arcs of both tables, which must be the same, bridged steps included.
std::vector<Arc<2>> matching_arcs(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                  const std::vector<ArcRows>& rows) {
    std::vector<Arc<2>> arcs = arcs_of<2>(screened);
    const auto same_steps = [&](const Arc<2>& arc) {
        for (std::size_t k = 0; k < arc.rows.size(); ++k)
            if (arc.epochs[k].step_before != trajectory.rows[arc.rows[k]].begins_after_step())
                return false;
        return true;
    };
    const bool equal =
        std::equal(arcs.begin(), arcs.end(), rows.begin(), rows.end(),
                   [&](const Arc<2>& arc, const ArcRows& own) {
                       return arc.number == own.number && arc.rows == own.rows && same_steps(arc);
                   });
    if (!equal)
        throw Failure("4-trajectory of receiver " + screened.facts.receiver,
                      "the trajectory does not have the arcs of the screened epochs",
                      "Run runcert-smooth again");
    return arcs;
}

/// The candidate's arc smoothed anew with the trajectory's own model, and found to be it.
SmoothedArc<2> checked_estimate(const Evidence& evidence, EpochPair window, const Arc<2>& arc) {
    SmoothedArc<2> smoothed = smooth<2>(arc.epochs, evidence.model);
    for (const std::size_t k : {window.first, window.last}) {
        const TrajectoryEpoch& row = evidence.trajectory.rows[arc.rows[k]];
        const Eigen::Vector2d position = smoothed.states[k].mean.head<2>();
        const double difference_m = (position - position_of(row)).norm();
        if (difference_m > 2e-6)  // both coordinates are written to a micrometre
            throw Failure(fmt::format("epoch {}", row.epoch),
                          fmt::format("the trajectory is {:.1e} m from the estimate of the same "
                                      "screened epochs",
                                      difference_m),
                          "Run runcert-smooth again, with the same attempt");
    }
    return smoothed;
}

/// Displacement (m) of the robust batch. It keeps positions alone: the motion over a bridged step
/// is that of the screened solution.
std::optional<Eigen::Vector2d> robust_displacement(const Evidence& evidence, const Arc<2>& arc,
                                                   const SmoothedArc<2>& smoothed,
                                                   EpochPair window) {
    const auto row = [&](std::size_t k) -> const TrajectoryEpoch& {
        return evidence.trajectory.rows[arc.rows[k]];
    };
    if (!row(window.first).robust_east_m || !row(window.last).robust_east_m) return std::nullopt;
    const auto difference = [&](std::size_t first, std::size_t last) {
        return Eigen::Vector2d(
            row(last).robust_east_m.value() - row(first).robust_east_m.value(),
            row(last).robust_north_m.value() - row(first).robust_north_m.value());
    };
    Eigen::Vector2d moved = difference(window.first, window.last);
    for (const BridgedStep& step : smoothed.bridged_between(window.first, window.last))
        moved += displacement(smoothed, step.epoch - 1, step.epoch) -
                 difference(step.epoch - 1, step.epoch);
    return moved;
}

/// The robust batch's speed against the screened solution's, whose noise model is the same.
std::optional<RobustSpeed> robust_speed(const Evidence& evidence, const Arc<2>& arc,
                                        const SmoothedArc<2>& smoothed, EpochPair window,
                                        const SpeedEstimate& screened, double duration_s) {
    constexpr double coverage_factor = 2.0;
    const auto displacement = robust_displacement(evidence, arc, smoothed, window);
    if (!displacement) return std::nullopt;
    RobustSpeed robust;
    robust.speed_mps = std::hypot(displacement->x(), displacement->y()) / duration_s;
    robust.difference_mps = robust.speed_mps - screened.speed_mps;
    robust.limit_mps = coverage_factor * screened.standard_uncertainty_mps;
    robust.agrees = std::abs(robust.difference_mps) <= robust.limit_mps;
    for (std::size_t k = window.first; k <= window.last; ++k) {
        const auto& weight = evidence.trajectory.rows[arc.rows[k]].robust_weight;
        if (weight && *weight < 0.5) ++robust.downweighted;
    }
    return robust;
}

/// The windows that could have been the best, those close to one another together.
std::vector<WindowCluster> clusters_of(const Evidence& evidence,
                                       const std::vector<std::vector<EpochPair>>& windows,
                                       const CandidateWindow& best, double least_mps) {
    std::vector<WindowCluster> clusters;
    for (std::size_t a = 0; a < evidence.arcs.size(); ++a) {
        const Arc<2>* arc = &evidence.arcs[a];
        const ArcRows& rows = evidence.rows[a];
        const auto positions = positions_without_offsets(evidence.trajectory, rows);
        for (const EpochPair& window : windows[a]) {
            const double time_s = duration_of(evidence.trajectory, rows, window);
            if (displacement_over_time(positions, window, time_s) < least_mps) continue;
            const bool apart = clusters.empty() || clusters.back().arc != arc ||
                               window.first > clusters.back().windows.back().last;
            if (apart) clusters.push_back({arc, {}, std::nullopt});
            WindowCluster& cluster = clusters.back();
            if (a == best.arc && window.first == best.window.first)
                cluster.chosen = cluster.windows.size();
            cluster.windows.push_back(window);
        }
    }
    return clusters;
}

CertifiableWindow certified(const Evidence& evidence,
                            const std::vector<std::vector<EpochPair>>& windows,
                            const CandidateWindow& candidate, const Profile& profile) {
    const TrajectoryTable& trajectory = evidence.trajectory;
    const Arc<2>& arc = evidence.arcs[candidate.arc];
    const ArcRows& rows = evidence.rows[candidate.arc];
    const std::size_t first_row = arc.rows[candidate.window.first];
    const std::size_t last_row = arc.rows[candidate.window.last];
    const TrajectoryEpoch& first = trajectory.rows[first_row];
    const TrajectoryEpoch& last = trajectory.rows[last_row];

    CertifiableWindow window;
    window.span = window_span(trajectory.facts, first.epoch, last.epoch, first.time, last.time);
    window.arc = arc.number;
    window.definitions = candidate.definitions;
    using Row = TrajectoryEpoch;
    window.methods = {
        .smoothed_mps = mean_over(trajectory, rows, candidate.window, &Row::speed_mps),
        .batch_mps = mean_over(trajectory, rows, candidate.window, &Row::speed_batch_mps),
        .v1_mps = mean_over(trajectory, rows, candidate.window, &Row::speed_v1_mps),
        .v2_mps = mean_over(trajectory, rows, candidate.window, &Row::speed_v2_mps),
        .kalman_mps = mean_over(trajectory, rows, candidate.window, &Row::speed_kalman_mps)};

    const SmoothedArc<2> smoothed = checked_estimate(evidence, candidate.window, arc);
    const WindowStretch stretch = cut_stretch(arc, candidate.window, stretch_margin_s);
    const SpeedEstimate displacement = displacement_speed(
        smoothed, candidate.window.first, candidate.window.last, stretch.duration_s);
    window.fitted = fitted_speed(stretch, evidence.models, profile.definition);
    window.robust =
        robust_speed(evidence, arc, smoothed, candidate.window, displacement, stretch.duration_s);
    window.repaired_steps =
        std::ssize(smoothed.bridged_between(candidate.window.first, candidate.window.last));

    ErrorBound bound =
        error_bound(evidence.screened, first_row, last_row, evidence.noise, profile.uncertainty);
    const EstimationModel bounded = bounded_model(evidence.noise, bound);
    const PositionNoise noise = position_noise(stretch, bounded, profile.definition);
    bound.standard_uncertainty_mps = noise.speed.standard_uncertainty_mps;
    window.bound = bound;
    window.displacement_m = noise.displacement_m;
    window.position_r95_m = position_r95_m(smoothed, candidate.window, bound);
    if (evidence.screened.evidence) {
        window.detection_power = evidence.screened.evidence->power;
        window.reliability =
            undetected_errors(evidence.screened, arc, stretch, bounded, profile.definition);
    }

    const double least_mps = candidate.definitions.displacement_mps -
                             selection_width * displacement.standard_uncertainty_mps;
    SelectionBias selection = selection_bias(
        clusters_of(evidence, windows, candidate, least_mps), {evidence.model, bounded},
        noise.speed.speed_mps, evidence.config.selection_samples, evidence.config.seed);
    selection.treatment = profile.uncertainty.subtract_selection_bias ? "subtracted" : "covered";
    window.selection = selection;
    window.speed_mps = noise.speed.speed_mps;
    if (profile.uncertainty.subtract_selection_bias) window.speed_mps -= selection.bias_mps;

    const BudgetInput input{.trajectory = trajectory,
                            .config = evidence.config,
                            .noise = noise,
                            .bound = bound,
                            .selection = selection,
                            .first_row = first_row,
                            .last_row = last_row,
                            .duration_s = stretch.duration_s,
                            .reliability = window.reliability,
                            .detection_power = window.detection_power.value_or(0.0)};
    window.budget = budget_of(input);
    const CombinedUncertainty combined = combine(window.budget);
    window.standard_uncertainty_mps = combined.standard_uncertainty;
    window.effective_degrees_of_freedom = combined.effective_degrees_of_freedom;
    window.monte_carlo = monte_carlo(input, window.budget, window.speed_mps);
    return window;
}

BridgedSteps bridged_steps_under(const Profile& profile) {
    return profile.repaired_steps ? BridgedSteps::allowed : BridgedSteps::refused;
}

}  // namespace

WindowConfig window_config(const Attempt& attempt, const Receiver& receiver) {
    const nlohmann::ordered_json& parameters = attempt.parameters.at("window");
    return {.duration_tolerance_s = parameters.at("duration_tolerance_s"),
            .seed = parameters.at("seed"),
            .selection_samples = parameters.at("selection_samples"),
            .monte_carlo_trials_max = parameters.at("monte_carlo_trials_max"),
            .plane_scale_bound = parameters.at("plane_scale_bound"),
            .lever_arm = receiver.lever_arm,
            .rotation_bound_deg = receiver.rotation_bound_deg};
}

Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config) {
    Windows windows;
    windows.receiver = trajectory.facts.receiver;
    windows.first_epoch = trajectory.facts.first_epoch;
    windows.georeferenced = trajectory.facts.georeferenced;
    const NoiseSummary& noise = horizontal_noise_of(trajectory);
    Evidence evidence{.screened = screened,
                      .trajectory = trajectory,
                      .config = config,
                      .noise = noise,
                      .model = model_of(noise),
                      .models = posterior_of(noise),
                      .arcs = {},
                      .rows = arcs_in(trajectory)};
    evidence.arcs = matching_arcs(screened, trajectory, evidence.rows);
    for (const Profile& profile : profiles) {
        ProfileWindows entry{.profile = profile.id,
                             .duration_s = profile.duration_s,
                             .definition = profile.definition,
                             .candidates = 0,
                             .best = std::nullopt,
                             .indicated = fastest_indicated(screened, profile.duration_s, config,
                                                            bridged_steps_under(profile))};
        const auto candidates =
            certifiable_windows(trajectory, evidence.rows, profile.duration_s,
                                config.duration_tolerance_s, bridged_steps_under(profile));
        for (const auto& of_arc : candidates)
            entry.candidates += static_cast<std::int64_t>(of_arc.size());
        if (const auto best =
                best_window(trajectory, evidence.rows, candidates, profile.definition))
            entry.best = certified(evidence, candidates, *best, profile);
        windows.profiles.push_back(std::move(entry));
    }
    return windows;
}

}  // namespace runcert
