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

/// The windows that can be certified, in order, by their first and last rows.
std::vector<EpochPair> candidate_rows(const TrajectoryTable& trajectory, double duration_s,
                                      double duration_tolerance_s) {
    const std::vector<ArcRows> arcs = arcs_in(trajectory);
    const auto windows = certifiable_windows(trajectory, arcs, duration_s, duration_tolerance_s);
    std::vector<EpochPair> rows;
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

/// The speed of a window by a method; empty where a value is missing. A course is not compared.
std::optional<double> speed_in(const TrajectoryTable& trajectory, EpochPair window,
                               const MethodTrack& by) {
    if (by.window_speed == SpeedDefinition::elapsed_time || by.epochs.empty()) return std::nullopt;
    constexpr double missing = std::numeric_limits<double>::quiet_NaN();
    const SpeedTrack track{
        [&](std::size_t i) -> Eigen::Vector2d {
            return by.epochs[i].position_m.value_or(Eigen::Vector2d::Constant(missing));
        },
        [&](std::size_t i) -> Eigen::Vector2d {
            return {by.epochs[i].speed_m_s.value_or(missing), 0.0};
        }};
    const auto time_s = [&](std::size_t row) { return trajectory.rows[row].time.seconds(); };
    const double speed_m_s = speed_of(track, window, time_s(window.last) - time_s(window.first),
                                      {.definition = by.window_speed});
    return std::isnan(speed_m_s) ? std::nullopt : std::optional(speed_m_s);
}

/// The rows of the certified window; none where there is none.
std::optional<EpochPair> certified_rows(const TrajectoryTable& trajectory,
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
    return EpochPair{row_of(windows.best->span.first_epoch), row_of(windows.best->span.last_epoch)};
}

constexpr const char* truth_of_this_recording =
    "Give the truth of this recording, at its own epochs, in seconds from the first of them";

ProfileComparison compare_profile(const TrajectoryTable& trajectory, const ProfileWindows& windows,
                                  const std::vector<MethodTrack>& tracks,
                                  const std::vector<MethodEpoch>& true_epochs,
                                  double duration_tolerance_s) {
    const auto candidates =
        candidate_rows(trajectory, windows.rule.duration_s, duration_tolerance_s);
    const auto certified = certified_rows(trajectory, windows);
    const MethodTrack truth{.window_speed = windows.rule.definition, .epochs = true_epochs};
    ProfileComparison comparison{.windows = windows, .candidates = std::ssize(candidates)};
    if (certified) comparison.true_m_s = speed_in(trajectory, *certified, truth);
    if (certified && !true_epochs.empty() && !comparison.true_m_s)
        throw Failure("the truth file",
                      fmt::format("it does not tell the speed in the certified window for {}, "
                                  "{:.3f} s to {:.3f} s after the recording's first epoch",
                                  windows.profile, trajectory.rows[certified->first].time.seconds(),
                                  trajectory.rows[certified->last].time.seconds()),
                      truth_of_this_recording);
    for (const MethodTrack& track : tracks) {
        MethodResult& result = comparison.methods.emplace_back(
            MethodResult{.name = track.name, .window_speed = track.window_speed});
        for (const EpochPair window : candidates) {
            const auto speed_m_s = speed_in(trajectory, window, track);
            if (!speed_m_s || (result.best_m_s && *speed_m_s <= *result.best_m_s)) continue;
            result.best_m_s = speed_m_s;
            result.best_start = trajectory.rows[window.first].time;
            result.best_error_m_s = difference(speed_m_s, speed_in(trajectory, window, truth));
        }
        if (certified) result.certified_m_s = speed_in(trajectory, *certified, track);
        result.certified_error_m_s = difference(result.certified_m_s, comparison.true_m_s);
        result.rms_error_m_s = rms_error(track.epochs, true_epochs);
    }
    // The speed that is certified, as another row.
    MethodResult& last = comparison.methods.emplace_back(
        MethodResult{.name = "certified", .window_speed = windows.rule.definition});
    if (!windows.best) return comparison;
    last.best_start = windows.best->span.start;
    last.best_m_s = last.certified_m_s = windows.best->speed_m_s;
    last.best_error_m_s = last.certified_error_m_s = difference(last.best_m_s, comparison.true_m_s);
    return comparison;
}

/// Whether every method has a speed by that rule.
bool is_comparable(const WindowRule& rule) {
    return rule.kind == WindowKind::time && rule.dimension == Dimension::horizontal &&
           rule.source == SpeedSource::position && rule.ends == WindowEnds::epochs && !rule.exact;
}

}  // namespace

CompareConfig compare_config(const Attempt& attempt) {
    return {.fit = fit_options(attempt.parameters.smooth),
            .duration_tolerance_s = attempt.parameters.window.duration_tolerance_s};
}

Comparison compare_methods(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                           const Windows& windows, const CompareConfig& config,
                           const std::vector<MethodEpoch>& truth) {
    Comparison comparison{.receiver = trajectory.facts.receiver, .with_truth = !truth.empty()};
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
    for (const ProfileWindows& entry : windows.profiles)
        if (is_comparable(entry.rule))
            comparison.profiles.push_back(compare_profile(trajectory, entry, methods.tracks, truth,
                                                          config.duration_tolerance_s));
        else
            comparison.notes.push_back(fmt::format(
                "{} is left out: methods are compared by horizontal speeds over windows of time, "
                "from positions, between epochs",
                entry.profile));
    for (const MethodTrack& track : methods.tracks)
        if (!track.unavailable.empty())
            comparison.notes.push_back(
                fmt::format("Not available: {}: {}", track.name, track.unavailable));
    return comparison;
}

}  // namespace runcert
