#include "reports/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/failure.h"
#include "core/statistics.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

/// Rows of a window, first to last. Between them lie only rows of the same arc.
using RowPair = EpochPair;

/// The windows that can be certified, in order.
std::vector<RowPair> candidate_rows(const TrajectoryTable& trajectory, double duration_s,
                                    double duration_tolerance_s) {
    const std::vector<ArcRows> arcs = arcs_in(trajectory);
    const auto windows = certifiable_windows(trajectory, arcs, duration_s, duration_tolerance_s);
    std::vector<RowPair> rows;
    for (std::size_t a = 0; a < arcs.size(); ++a)
        for (const EpochPair& window : windows[a])
            rows.push_back({arcs[a].rows[window.first], arcs[a].rows[window.last]});
    return rows;
}

std::optional<double> difference(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return std::nullopt;
    return *a - *b;
}

std::optional<double> rms_error(const std::vector<MethodEpoch>& epochs,
                                const std::vector<MethodEpoch>& truth) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth.size(); ++i)
        if (const auto error = difference(epochs[i].speed_m_s, truth[i].speed_m_s))
            errors.push_back(*error);
    if (errors.empty()) return std::nullopt;
    return root_mean_square(errors);
}

/// What one profile's comparison rests on.
struct Task {
    const TrajectoryTable& trajectory;
    const ProfileWindows& windows;
    const std::vector<MethodEpoch>& truth;
    std::vector<RowPair> candidates;
    std::optional<RowPair> certified;

    double time_s(std::size_t row) const { return trajectory.rows[row].time.seconds(); }

    /// The speed of a window by a method, or by the truth; empty where a value is missing. A course
    /// is not compared.
    std::optional<double> speed_in(RowPair window, const std::vector<MethodEpoch>& epochs,
                                   SpeedDefinition by) const {
        if (by == SpeedDefinition::elapsed_time || epochs.empty()) return std::nullopt;
        constexpr double missing = std::numeric_limits<double>::quiet_NaN();
        const SpeedTrack track{
            [&](std::size_t i) -> Eigen::Vector2d {
                return epochs[i].position_m.value_or(Eigen::Vector2d::Constant(missing));
            },
            [&](std::size_t i) -> Eigen::Vector2d {
                return {epochs[i].speed_m_s.value_or(missing), 0.0};
            }};
        const double speed_m_s =
            speed_of(track, window, time_s(window.last) - time_s(window.first), {.definition = by});
        return std::isnan(speed_m_s) ? std::nullopt : std::optional(speed_m_s);
    }

    std::optional<double> truth_in(RowPair window) const {
        return speed_in(window, truth, windows.rule.definition);
    }
};

MethodResult result_of(const Task& task, const MethodTrack& track) {
    MethodResult result;
    result.name = track.name;
    result.window_speed = track.window_speed;
    for (const RowPair window : task.candidates) {
        const auto speed_m_s = task.speed_in(window, track.epochs, track.window_speed);
        if (!speed_m_s || (result.best_m_s && *speed_m_s <= *result.best_m_s)) continue;
        result.best_m_s = speed_m_s;
        result.best_start = task.trajectory.rows[window.first].time;
        result.best_error_m_s = difference(speed_m_s, task.truth_in(window));
    }
    if (task.certified) {
        result.certified_m_s = task.speed_in(*task.certified, track.epochs, track.window_speed);
        result.certified_error_m_s =
            difference(result.certified_m_s, task.truth_in(*task.certified));
    }
    result.rms_error_m_s = rms_error(track.epochs, task.truth);
    return result;
}

/// The speed that is certified, as another row.
MethodResult certified_result(const ProfileWindows& windows, std::optional<double> true_m_s) {
    MethodResult result;
    result.name = "certified";
    result.window_speed = windows.rule.definition;
    if (!windows.best) return result;
    result.best_start = windows.best->span.start;
    result.best_m_s = result.certified_m_s = windows.best->speed_m_s;
    result.certified_error_m_s = result.best_error_m_s = difference(result.best_m_s, true_m_s);
    return result;
}

/// The rows of the certified window; none where there is none.
std::optional<RowPair> certified_rows(const TrajectoryTable& trajectory,
                                      const ProfileWindows& windows) {
    if (!windows.best) return std::nullopt;
    const auto row_of = [&](std::int64_t number) {
        const auto found = std::ranges::find(trajectory.rows, number, &TrajectoryEpoch::epoch);
        if (found == trajectory.rows.end())
            throw Failure("5-windows of receiver " + trajectory.facts.receiver,
                          fmt::format("epoch {} of the window for {} is not in the trajectory",
                                      number, windows.profile),
                          "Certify the attempt again");
        return static_cast<std::size_t>(found - trajectory.rows.begin());
    };
    return RowPair{row_of(windows.best->span.first_epoch), row_of(windows.best->span.last_epoch)};
}

constexpr const char* truth_of_this_recording =
    "Give the truth of this recording, at its own epochs, in seconds from the first of them";

ProfileComparison compare_profile(const Task& task, const Methods& methods) {
    ProfileComparison comparison{.windows = task.windows,
                                 .candidates = std::ssize(task.candidates)};
    if (task.certified) comparison.true_m_s = task.truth_in(*task.certified);
    if (task.certified && !task.truth.empty() && !comparison.true_m_s)
        throw Failure("the truth file",
                      fmt::format("it does not tell the speed in the certified window for {}, "
                                  "{:.3f} s to {:.3f} s after the recording's first epoch",
                                  task.windows.profile, task.time_s(task.certified->first),
                                  task.time_s(task.certified->last)),
                      truth_of_this_recording);
    for (const MethodTrack& track : methods.tracks)
        comparison.methods.push_back(result_of(task, track));
    comparison.methods.push_back(certified_result(task.windows, comparison.true_m_s));
    return comparison;
}

/// Whether every method has a speed by that rule.
bool is_comparable(const WindowRule& rule) {
    return rule.kind == WindowKind::time && rule.dimension == Dimension::horizontal &&
           rule.source == SpeedSource::position && rule.ends == WindowEnds::epochs && !rule.exact;
}

}  // namespace

CompareConfig compare_config(const Attempt& attempt) {
    const SmoothParameters& smooth = attempt.parameters.smooth;
    CompareConfig config;
    config.fit.initial_jerk_density = smooth.jerk_density;
    config.fit.tau_min_s = smooth.error_time_min_s;
    config.fit.tau_max_s = smooth.error_time_max_s;
    config.fit.motion = motion_of(smooth.motion_model);
    config.duration_tolerance_s = attempt.parameters.window.duration_tolerance_s;
    return config;
}

Comparison compare_methods(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                           const Windows& windows, const CompareConfig& config,
                           const std::vector<MethodEpoch>& truth) {
    Comparison comparison;
    comparison.receiver = trajectory.facts.receiver;
    comparison.with_truth = !truth.empty();
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        if (!trajectory.rows[i].arc) continue;
        ++comparison.epochs;
        if (comparison.with_truth && truth[i].speed_m_s) ++comparison.epochs_with_truth;
    }
    if (comparison.with_truth && comparison.epochs_with_truth == 0)
        throw Failure("the truth file", "no epoch of it has the time of an epoch of the recording",
                      truth_of_this_recording);
    Methods methods = methods_of(screened, trajectory, config);
    comparison.notes = std::move(methods.notes);
    for (const ProfileWindows& entry : windows.profiles) {
        if (is_comparable(entry.rule))
            comparison.profiles.push_back(compare_profile(
                {.trajectory = trajectory,
                 .windows = entry,
                 .truth = truth,
                 .candidates =
                     candidate_rows(trajectory, entry.rule.duration_s, config.duration_tolerance_s),
                 .certified = certified_rows(trajectory, entry)},
                methods));
        else
            comparison.notes.push_back(fmt::format(
                "{} is left out: methods are compared by horizontal speeds over windows of time, "
                "from positions, between epochs",
                entry.profile));
    }
    for (const MethodTrack& track : methods.tracks)
        if (!track.unavailable.empty())
            comparison.notes.push_back(
                fmt::format("Not available: {}: {}", track.name, track.unavailable));
    return comparison;
}

}  // namespace runcert
