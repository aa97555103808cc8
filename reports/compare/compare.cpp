#include "reports/compare/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/statistics.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

using TruthRows = std::vector<std::optional<TruthEpoch>>;

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

/// Speeds of windows, of a method or of the truth.
class WindowSpeeds {
  public:
    WindowSpeeds(const TrajectoryTable& trajectory, const MethodTrack& track, SpeedDefinition by)
        : trajectory_(trajectory), track_(track), by_(by) {}

    /// Empty where a value is missing. A course is not compared.
    std::optional<double> operator()(RowPair window) const {
        if (by_ == SpeedDefinition::elapsed_time) return std::nullopt;
        constexpr double missing = std::numeric_limits<double>::quiet_NaN();
        const SpeedTrack track{
            [&](std::size_t i) -> Eigen::Vector2d {
                return track_.positions[i].value_or(Eigen::Vector2d::Constant(missing));
            },
            [&](std::size_t i) -> Eigen::Vector2d {
                return {track_.speeds_m_s[i].value_or(missing), 0.0};
            }};
        const double speed_m_s = speed_of(track, window,
                                          trajectory_.rows[window.last].time.seconds() -
                                              trajectory_.rows[window.first].time.seconds(),
                                          {.definition = by_});
        return std::isnan(speed_m_s) ? std::nullopt : std::optional(speed_m_s);
    }

  private:
    const TrajectoryTable& trajectory_;
    const MethodTrack& track_;
    SpeedDefinition by_;
};

MethodTrack track_of_truth(const TruthRows& truth) {
    MethodTrack track;
    for (const std::optional<TruthEpoch>& epoch : truth) {
        track.positions.push_back(epoch ? std::optional(epoch->position) : std::nullopt);
        track.speeds_m_s.push_back(epoch ? std::optional(epoch->speed_m_s) : std::nullopt);
    }
    return track;
}

std::optional<double> difference(std::optional<double> a, std::optional<double> b) {
    if (!a || !b) return std::nullopt;
    return *a - *b;
}

std::optional<double> rms_error(const MethodTrack& track, const MethodTrack& truth) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < track.speeds_m_s.size(); ++i)
        if (const auto error = difference(track.speeds_m_s[i], truth.speeds_m_s[i]))
            errors.push_back(*error);
    if (errors.empty()) return std::nullopt;
    return root_mean_square(errors);
}

/// What one profile's comparison rests on.
struct Task {
    const TrajectoryTable& trajectory;
    const ProfileWindows& windows;
    std::vector<RowPair> candidates;
    std::optional<RowPair> certified;
    const MethodTrack* truth = nullptr;

    std::optional<double> truth_in(RowPair window) const {
        if (!truth) return std::nullopt;
        return WindowSpeeds(trajectory, *truth, windows.rule.definition)(window);
    }
};

MethodResult result_of(const Task& task, const MethodTrack& track) {
    MethodResult result;
    result.name = track.name;
    result.window_speed = track.window_speed;
    const WindowSpeeds speed(task.trajectory, track, result.window_speed);
    std::optional<RowPair> best;
    for (const RowPair window : task.candidates) {
        const std::optional<double> speed_m_s = speed(window);
        if (!speed_m_s || (result.best_m_s && *speed_m_s <= *result.best_m_s)) continue;
        result.best_m_s = speed_m_s;
        best = window;
    }
    if (best) {
        result.best_start = task.trajectory.rows[best->first].time;
        result.best_error_m_s = difference(result.best_m_s, task.truth_in(*best));
    }
    if (task.certified) {
        result.certified_m_s = speed(*task.certified);
        result.certified_error_m_s =
            difference(result.certified_m_s, task.truth_in(*task.certified));
    }
    if (task.truth) result.rms_error_m_s = rms_error(track, *task.truth);
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
        const auto found =
            std::find_if(trajectory.rows.begin(), trajectory.rows.end(),
                         [&](const TrajectoryEpoch& row) { return row.epoch == number; });
        if (found == trajectory.rows.end())
            throw Failure("5-windows of receiver " + trajectory.facts.receiver,
                          fmt::format("epoch {} of the window for {} is not in the trajectory",
                                      number, windows.profile),
                          "Certify the attempt again");
        return static_cast<std::size_t>(found - trajectory.rows.begin());
    };
    return RowPair{row_of(windows.best->span.first_epoch), row_of(windows.best->span.last_epoch)};
}

void require_truth(const Task& task) {
    if (!task.truth || !task.certified || task.truth_in(*task.certified)) return;
    throw Failure(
        "the truth file",
        fmt::format("it does not tell the speed in the certified window for {}, {:.3f} s to "
                    "{:.3f} s after the recording's first epoch",
                    task.windows.profile,
                    task.trajectory.rows[task.certified->first].time.seconds(),
                    task.trajectory.rows[task.certified->last].time.seconds()),
        "Give the truth of this recording, at its own epochs, in seconds from the first of them");
}

ProfileComparison compare_profile(const Task& task, const Methods& methods) {
    const ProfileWindows& windows = task.windows;
    require_truth(task);
    ProfileComparison comparison;
    comparison.profile = windows.profile;
    comparison.duration_s = windows.rule.duration_s;
    comparison.definition = windows.rule.definition;
    comparison.candidates = static_cast<std::int64_t>(task.candidates.size());
    if (windows.best) {
        comparison.certified_start = windows.best->span.start;
        comparison.certified_duration = windows.best->span.duration;
        comparison.expanded_uncertainty_m_s = expanded_uncertainty_m_s(*windows.best, 2.0);
        comparison.true_m_s = task.truth_in(*task.certified);
    }
    for (const MethodTrack& track : methods.tracks)
        comparison.methods.push_back(result_of(task, track));
    comparison.methods.push_back(certified_result(windows, comparison.true_m_s));
    return comparison;
}

/// Whether every method has a speed by that rule.
bool is_comparable(const WindowRule& rule) {
    return rule.kind == WindowKind::time && rule.dimension == Dimension::horizontal &&
           rule.source == SpeedSource::position && rule.ends == WindowEnds::epochs && !rule.exact;
}

void count_truth(const TrajectoryTable& trajectory, const TruthRows* truth,
                 Comparison& comparison) {
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        if (!trajectory.rows[i].arc) continue;
        ++comparison.epochs;
        if (truth && (*truth)[i]) ++comparison.epochs_with_truth;
    }
    if (truth && comparison.epochs_with_truth == 0)
        throw Failure("the truth file", "no epoch of it has the time of an epoch of the recording",
                      "Give the truth of this recording, at its own epochs, in seconds from the "
                      "first of them");
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
                           const TruthRows* truth) {
    Comparison comparison;
    comparison.receiver = trajectory.facts.receiver;
    comparison.with_truth = truth != nullptr;
    count_truth(trajectory, truth, comparison);
    std::optional<MethodTrack> true_track;
    if (truth) true_track = track_of_truth(*truth);
    Methods methods = methods_of(screened, trajectory, config);
    std::vector<std::string> left_out;
    for (const ProfileWindows& entry : windows.profiles) {
        if (!is_comparable(entry.rule)) {
            left_out.push_back(fmt::format(
                "{} is left out: methods are compared by horizontal speeds over windows of time, "
                "from positions, between epochs",
                entry.profile));
            continue;
        }
        comparison.profiles.push_back(compare_profile(
            {.trajectory = trajectory,
             .windows = entry,
             .candidates =
                 candidate_rows(trajectory, entry.rule.duration_s, config.duration_tolerance_s),
             .certified = certified_rows(trajectory, entry),
             .truth = true_track ? &*true_track : nullptr},
            methods));
    }
    comparison.notes = std::move(methods.notes);
    comparison.notes.insert(comparison.notes.end(), left_out.begin(), left_out.end());
    for (const MethodTrack& track : methods.tracks)
        if (!track.unavailable.empty())
            comparison.notes.push_back(
                fmt::format("Not available: {}: {}", track.name, track.unavailable));
    return comparison;
}

}  // namespace runcert
