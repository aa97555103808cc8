#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "reports/words/figures.h"
#include "schemas/observations/stated_covariance.h"
#include "stages/window/course_windows.h"
#include "stages/window/sample_series.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

/// Rows of one reason, and the first.
struct Refused {
    Reason reason = Reason::none;
    std::int64_t count = 0;
    const ScreenedEpoch* first = nullptr;
};

/// Breaks inside a window, by what they mean for it.
struct Breaks {
    std::int64_t steps = 0;    ///< positions, or their times, do not go on as they were
    std::int64_t bridged = 0;  ///< such a step whose offset the estimate takes out
    const ScreenedEpoch* first_step = nullptr;
};

void add_break(const ScreenedEpoch& row, Breaks& breaks) {
    switch (*row.break_before) {
        case ArcBreak::start:
        case ArcBreak::gap:
            break;
        case ArcBreak::innovation:
        case ArcBreak::step:
        case ArcBreak::ramp:
        case ArcBreak::time_shift:
            if (breaks.steps++ == 0) breaks.first_step = &row;
            break;
        case ArcBreak::bridged:
            ++breaks.bridged;
            break;
    }
}

/// The longest step of time in a window, and the row it leads to.
struct LongestStep {
    double length_s = 0.0;
    const ScreenedEpoch* after = nullptr;
};

LongestStep longest_step(const ScreenedTable& screened, std::size_t first, std::size_t last) {
    LongestStep longest;
    for (std::size_t i = first + 1; i <= last; ++i) {
        const double step_s = screened.rows[i].time.seconds() - screened.rows[i - 1].time.seconds();
        if (step_s > longest.length_s) longest = {step_s, &screened.rows[i]};
    }
    return longest;
}

/// Why a gap forbids the window: it is longer than what is bridged, or the rule asks for more.
std::string gap_refusal(const ScreenedTable& screened, const LongestStep& step,
                        const Profile& profile, const WindowConfig& config) {
    const double bridged_s =
        std::max(config.gap_max_s, config.gap_factor * screened.facts.nominal_interval_s);
    const std::string gap = fmt::format("a gap of {:.1f} s {}", step.length_s,
                                        instant_text(screened.facts.first_epoch, step.after->time));
    if (step.length_s > bridged_s)
        return fmt::format("{} (longer than screen.gap_max_s, {:g} s)", gap, config.gap_max_s);
    const auto longest_s = longest_step_of(profile, screened.facts.nominal_interval_s);
    if (longest_s && step.length_s > *longest_s)
        return fmt::format("{} (the rule asks for a step every {} s)", gap,
                           significant_text(*longest_s, 3));
    return {};
}

std::vector<std::string> refusals_of(const ScreenedTable& screened, std::size_t first,
                                     std::size_t last, const Profile& profile,
                                     const WindowConfig& config) {
    std::vector<Refused> reasons;
    std::vector<std::string> refusals;
    Breaks breaks;
    const auto instant = [&](const ScreenedEpoch& row) {
        return instant_text(screened.facts.first_epoch, row.time);
    };
    for (std::size_t i = first; i <= last; ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable) {
            auto known = std::ranges::find(reasons, row.reason, &Refused::reason);
            if (known == reasons.end()) {
                reasons.push_back({row.reason, 0, &row});
                known = reasons.end() - 1;
            }
            ++known->count;
        }
        if (i != first && row.break_before) add_break(row, breaks);
    }
    // What made most of it first.
    std::ranges::stable_sort(reasons, std::greater<>(), &Refused::count);
    for (const Refused& one : reasons)
        refusals.push_back(fmt::format("{} {} {} ({}{})", one.count,
                                       one.count == 1 ? "epoch" : "epochs", phrase_of(one.reason),
                                       one.count == 1 ? "" : "the first ", instant(*one.first)));
    if (breaks.steps > 0)
        refusals.push_back(fmt::format(
            "{} {} that the motion cannot explain ({}): positions before and "
            "after do not belong together",
            breaks.steps, breaks.steps == 1 ? "step" : "steps", instant(*breaks.first_step)));
    if (breaks.bridged > 0 && !profile.repaired_steps)
        refusals.push_back(
            fmt::format("{} repaired {}: the recorded positions before and after belong together "
                        "only by an estimated offset",
                        breaks.bridged, breaks.bridged == 1 ? "step" : "steps"));
    if (const LongestStep step = longest_step(screened, first, last); step.after != nullptr)
        if (std::string gap = gap_refusal(screened, step, profile, config); !gap.empty())
            refusals.push_back(std::move(gap));
    return refusals;
}

/// Expanded uncertainty (k = 2, m/s) of a window's speed by what its ends state of themselves.
double stated_uncertainty(const ScreenedTable& screened, const std::vector<std::size_t>& rows,
                          const Profile& profile, const FoundWindow& found) {
    const auto variance = [&](std::size_t k) {
        const ScreenedEpoch& row = screened.rows[rows[k]];
        if (profile.speed_source == SpeedSource::velocity) {
            const auto speed = recorded_speed(row, profile.dimension);
            const double sigma = speed ? speed->standard_uncertainty_m_s.value_or(0.0) : 0.0;
            return 0.5 * sigma * sigma;
        }
        const double level = 0.5 * stated_covariance<2>(row).trace();
        const double upright = stated_covariance<1>(row).trace();
        const double of_position = profile.dimension == Dimension::horizontal ? level
                                   : profile.dimension == Dimension::vertical ? upright
                                                                              : level + upright;
        const double duration_s = found.end.seconds() - found.start.seconds();
        return of_position / (duration_s * duration_s);
    };
    return 2.0 * std::sqrt(variance(found.first) + variance(found.last));
}

/// The windows of the recording as it is, those that show most first.
std::vector<FoundWindow> windows_as_recorded(const std::vector<SampleSeries>& series,
                                             const Profile& profile, const WindowCriteria& rule,
                                             const std::optional<CourseGates>& gates,
                                             const Allowance& allowance) {
    if (rule.kind != WindowKind::course)
        return allowed_and_best(series, rule, static_cast<std::size_t>(profile.windows), allowance)
            .best;
    if (!gates) return {};
    std::vector<FoundWindow> windows = course_windows(series, *gates);
    make_allowances(windows, allowance);
    std::ranges::stable_sort(windows, preferred);
    return windows;
}

/// The windows that show most by one source of speeds, and the series that they are in.
struct Shown {
    IndicatedSeries series;
    std::vector<FoundWindow> windows;
    SpeedSource source = SpeedSource::position;
};

Shown shown_by(const ScreenedTable& screened, Profile profile, SpeedSource source,
               const WindowConfig& config, const std::optional<CourseGates>& gates) {
    profile.speed_source = source;
    Shown shown{.series = indicated_series(screened, profile), .windows = {}, .source = source};
    WindowCriteria rule =
        window_criteria(profile, config.duration_tolerance_s, screened.facts.nominal_interval_s);
    // Positions as recorded have no speeds to take the mean of; of speeds, their path is what there
    // is.
    if (source == SpeedSource::position && rule.definition != SpeedDefinition::path_length)
        rule.definition = SpeedDefinition::displacement;
    const Allowance stated = [&](const FoundWindow& window) {
        return stated_uncertainty(screened, shown.series.rows, profile, window);
    };
    shown.windows = windows_as_recorded(shown.series.series, profile, rule, gates, stated);
    return shown;
}

/// Whether the recorded velocities may show more than the positions: over a time, by a rule that
/// takes positions.
bool velocities_may_show_more(const ScreenedTable& screened, const Profile& profile) {
    return profile.speed_source == SpeedSource::position &&
           profile.window_kind == WindowKind::time &&
           std::ranges::any_of(screened.rows, [&](const ScreenedEpoch& row) {
               return recorded_speed(row, profile.dimension).has_value();
           });
}

Shown most_shown(const ScreenedTable& screened, const Profile& profile, const WindowConfig& config,
                 const std::optional<CourseGates>& gates) {
    Shown shown = shown_by(screened, profile, profile.speed_source, config, gates);
    if (!velocities_may_show_more(screened, profile)) return shown;
    Profile by_path = profile;
    by_path.definition = SpeedDefinition::path_length;
    Shown by_velocity = shown_by(screened, by_path, SpeedSource::velocity, config, gates);
    const bool more = !by_velocity.windows.empty() &&
                      (shown.windows.empty() ||
                       by_velocity.windows.front().claim_m_s() > shown.windows.front().claim_m_s());
    return more ? by_velocity : shown;
}

}  // namespace

std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened,
                                                 const Profile& profile, const WindowConfig& config,
                                                 const std::optional<CourseGates>& gates) {
    const Shown shown = most_shown(screened, profile, config, gates);
    const std::vector<FoundWindow>& found = shown.windows;
    if (found.empty()) return std::nullopt;
    const std::size_t first = shown.series.rows[found.front().first];
    const std::size_t last = shown.series.rows[found.front().last];
    IndicatedWindow window{
        .span = window_span(screened.facts, screened.rows[first].epoch, screened.rows[last].epoch,
                            found.front().start, found.front().end),
        .source = shown.source,
        .speed_m_s = found.front().speed_m_s,
        .stated_expanded_uncertainty_m_s = found.front().allowance_m_s,
        .mean_m_s = std::nullopt,
        .refusals = refusals_of(screened, first, last, profile, config)};
    if (profile.windows > 1 && std::ssize(found) == profile.windows) {
        double sum = 0.0;
        for (const FoundWindow& one : found)
            sum += one.speed_m_s;
        window.mean_m_s = sum / static_cast<double>(found.size());
    }
    return window;
}

}  // namespace runcert
