#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/figures.h"
#include "schemas/observations/stated_covariance.h"
#include "schemas/screened/witness_text.h"
#include "stages/window/course_windows.h"
#include "stages/window/sample_series.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

/// The number of rows with one reason, and the first of them.
struct Refused {
    Reason reason = Reason::none;
    std::int64_t count = 0;
    const ScreenedEpoch* first = nullptr;
};

/// Breaks inside a window, by type.
struct Breaks {
    std::int64_t steps = 0;  ///< positions, or their times, do not continue
    std::int64_t gaps = 0;   ///< the recording is not joined across them
    const ScreenedEpoch* first_step = nullptr;
};

/// Rows of a window, and the clock jumps among them.
struct WindowRows {
    std::vector<const ScreenedEpoch*> rows;
    std::vector<std::size_t> jumps;  ///< indices into `rows`
};

void add_break(const ScreenedEpoch& row, Breaks& breaks) {
    switch (*row.break_before) {
        case ArcBreak::start:
            break;
        case ArcBreak::gap:
            ++breaks.gaps;
            break;
        case ArcBreak::innovation:
        case ArcBreak::step:
        case ArcBreak::ramp:
        case ArcBreak::time_shift:
            if (breaks.steps++ == 0) breaks.first_step = &row;
            break;
    }
}

/// The longest time step in a window, and the row at its end.
struct LongestStep {
    double length_s = 0.0;
    const ScreenedEpoch* after = nullptr;
};

LongestStep longest_step(const std::vector<const ScreenedEpoch*>& rows) {
    LongestStep longest;
    const ScreenedEpoch* before = nullptr;
    for (const ScreenedEpoch* const row : rows) {
        if (is_out_of_time(*row)) continue;
        const double step_s = before ? row->time.seconds() - before->time.seconds() : 0.0;
        if (step_s > longest.length_s) longest = {step_s, row};
        before = row;
    }
    return longest;
}

/// Why a gap rules the window out: it is longer than what is bridged, or the rule requires shorter
/// steps.
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

/// Why recorded speeds inside belong to another moment.
std::string late_refusal(const ScreenedTable& screened, const WindowRows& window) {
    const auto& velocity = screened.basis.velocity;
    if (!velocity) return {};
    const auto [first, last] =
        std::ranges::minmax(window.rows, {}, [](const ScreenedEpoch* row) { return row->epoch; });
    for (const VelocityDelay& one : velocity->delays)
        if (one.beyond && one.first_epoch <= last->epoch && one.last_epoch >= first->epoch)
            return "recorded speeds that are " + delay_words(one.delay_s) + " the positions";
    return {};
}

/// The recorded speeds that their tests refuse, named by the one that is farthest off.
std::string refused_speeds(const ScreenedTable& screened, const WindowRows& window,
                           Dimension dimension) {
    const ScreenedEpoch* worst = nullptr;
    std::int64_t refused = 0;
    const auto error_m_s = [](const ScreenedEpoch& row) {
        return row.speed_test.error_m_s.value_or(0.0);
    };
    for (const ScreenedEpoch* const row : window.rows) {
        const SpeedTest& test = row->speed_test;
        if (!test.refused ||
            (dimension == Dimension::horizontal && test.axes == TestedAxes::vertical))
            continue;
        ++refused;
        if (!worst || std::abs(error_m_s(*row)) > std::abs(error_m_s(*worst))) worst = row;
    }
    if (!worst) return {};
    return fmt::format(
        "{} recorded {} that {} neighbours contradict ({}epoch {}, {}: {:+.2f} m/s, statistic "
        "{:.0f}, threshold {:.0f})",
        refused, refused == 1 ? "speed" : "speeds", refused == 1 ? "its" : "their",
        refused == 1 ? "" : "the worst at ", worst->epoch,
        instant_text(screened.facts.first_epoch, worst->time), error_m_s(*worst),
        worst->speed_test.statistic.value_or(0.0), worst->speed_test.threshold.value_or(0.0));
}

std::vector<std::string> refusals_of(const ScreenedTable& screened, const WindowRows& window,
                                     const Profile& profile, const WindowConfig& config) {
    std::vector<Refused> reasons;
    std::vector<std::string> refusals;
    Breaks breaks;
    const auto instant = [&](const ScreenedEpoch& row) {
        return instant_text(screened.facts.first_epoch, row.time);
    };
    for (const ScreenedEpoch* const one : window.rows) {
        const ScreenedEpoch& row = *one;
        if (!row.usable && row.reason != Reason::repeated) {
            auto known = std::ranges::find(reasons, row.reason, &Refused::reason);
            if (known == reasons.end()) {
                reasons.push_back({row.reason, 0, &row});
                known = reasons.end() - 1;
            }
            ++known->count;
        }
        if (one != window.rows.front() && row.break_before) add_break(row, breaks);
    }
    const auto add_reasons = [&](bool out_of_time) {
        for (const Refused& one : reasons)
            if (out_of_time == is_out_of_time(*one.first))
                refusals.push_back(
                    fmt::format("{} {} {} ({}{})", one.count, one.count == 1 ? "epoch" : "epochs",
                                phrase_of(one.reason), one.count == 1 ? "" : "the first ",
                                instant(*one.first)));
    };
    // The most frequent reasons come first.
    std::ranges::stable_sort(reasons, std::greater<>(), &Refused::count);
    add_reasons(false);
    if (breaks.steps > 0)
        refusals.push_back(fmt::format(
            "{} {} that the motion cannot explain ({}): positions before and "
            "after do not belong together",
            breaks.steps, breaks.steps == 1 ? "step" : "steps", instant(*breaks.first_step)));
    if (!window.jumps.empty())
        refusals.push_back(fmt::format("{} of the clock while the positions go on ({})",
                                       window.jumps.size() == 1
                                           ? std::string("a jump")
                                           : fmt::format("{} jumps", window.jumps.size()),
                                       instant(*window.rows[window.jumps.front()])));
    if (profile.speed_source == SpeedSource::velocity)
        for (const std::string& refusal :
             {refused_speeds(screened, window, profile.dimension), late_refusal(screened, window)})
            if (!refusal.empty()) refusals.push_back(refusal);
    if (const LongestStep step = longest_step(window.rows); step.after != nullptr)
        if (std::string gap = gap_refusal(screened, step, profile, config); !gap.empty())
            refusals.push_back(std::move(gap));
    if (refusals.empty() && breaks.gaps > 0)
        refusals.emplace_back("a passage from one part of the recording to another");
    // Epochs out of time count as missing: they explain why there is a gap.
    if (!refusals.empty()) add_reasons(true);
    return refusals;
}

/// Expanded uncertainty (k = 2, m/s) of a window's speed, from the standard deviations stated at
/// its ends.
double stated_uncertainty(const ScreenedTable& screened,
                          const std::vector<std::vector<std::size_t>>& rows, const Profile& profile,
                          const FoundWindow& found) {
    const auto variance = [&](std::size_t k) {
        const ScreenedEpoch& row = screened.rows[rows[found.series][k]];
        // An absurd standard deviation says nothing about the error of the speed.
        if (row.reason == Reason::accuracy_absurd) return 0.0;
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
        return of_position / (found.duration_s() * found.duration_s());
    };
    return 2.0 * std::sqrt(variance(found.first) + variance(found.last));
}

/// The windows of the unscreened recording, those that show most first.
std::vector<FoundWindow> windows_as_recorded(const std::vector<SampleSeries>& series,
                                             const Profile& profile, const WindowCriteria& rule,
                                             const std::optional<SurveyedCourse>& gates,
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

/// How epochs are ordered: by time, or as recorded.
enum class Order { time, recording };

/// The windows that show most by one source of speeds, and the series they lie in.
struct Shown {
    IndicatedSeries series;
    std::vector<FoundWindow> windows;
    SpeedSource source = SpeedSource::position;
    Order order = Order::time;
};

/// What limits the search in addition to the recording.
struct SearchLimits {
    const std::optional<SurveyedCourse>& gates;
    const std::optional<WindowPart>& part;
};

Shown shown_by(const ScreenedTable& screened, Profile profile, SpeedSource source, Order order,
               const WindowConfig& config, const SearchLimits& limits) {
    profile.speed_source = source;
    Shown shown{.series = order == Order::time
                              ? indicated_series(screened, profile, config.gap_factor)
                              : indicated_by_pace(screened, profile, config.gap_factor),
                .windows = {},
                .source = source,
                .order = order};
    if (shown.series.series.empty()) return shown;
    if (limits.part) restrict_to(limits.part, screened, shown.series);
    WindowCriteria rule =
        window_criteria(profile, config.duration_tolerance_s, screened.facts.nominal_interval_s);
    // Unsmoothed positions have no speeds to average. For recorded speeds, the path is available.
    if (source == SpeedSource::position && rule.definition != SpeedDefinition::path_length)
        rule.definition = SpeedDefinition::displacement;
    const Allowance stated = [&](const FoundWindow& window) {
        return stated_uncertainty(screened, shown.series.rows, profile, window);
    };
    shown.windows = windows_as_recorded(shown.series.series, profile, rule, limits.gates, stated);
    return shown;
}

/// Whether the recorded velocities may show more than the positions: over a time, under a rule that
/// uses positions.
bool velocities_may_show_more(const ScreenedTable& screened, const Profile& profile) {
    return profile.speed_source == SpeedSource::position &&
           profile.window_kind == WindowKind::time &&
           std::ranges::any_of(screened.rows, [&](const ScreenedEpoch& row) {
               return recorded_speed(row, profile.dimension).has_value();
           });
}

Shown most_shown(const ScreenedTable& screened, const Profile& profile, const WindowConfig& config,
                 const SearchLimits& limits) {
    Shown most = shown_by(screened, profile, profile.speed_source, Order::time, config, limits);
    const auto take_more = [&](Shown shown) {
        const bool more = !shown.windows.empty() &&
                          (most.windows.empty() || shown.windows.front().assured_m_s() >
                                                       most.windows.front().assured_m_s());
        if (more) most = std::move(shown);
    };
    take_more(shown_by(screened, profile, profile.speed_source, Order::recording, config, limits));
    if (!velocities_may_show_more(screened, profile)) return most;
    Profile by_path = profile;
    by_path.definition = SpeedDefinition::path_length;
    for (const Order order : {Order::time, Order::recording})
        take_more(shown_by(screened, by_path, SpeedSource::velocity, order, config, limits));
    return most;
}

/// The rows from the first to the last of a window, in its order, including those that show
/// nothing.
WindowRows rows_of(const ScreenedTable& screened, const Shown& shown, std::size_t first,
                   std::size_t last) {
    WindowRows window;
    if (shown.order == Order::time) {
        for (std::size_t i = first; i <= last; ++i)
            window.rows.push_back(&screened.rows[i]);
        return window;
    }
    const auto in_window = [&](const ScreenedEpoch& row) {
        return row.epoch >= screened.rows[first].epoch && row.epoch <= screened.rows[last].epoch;
    };
    for (const ScreenedEpoch& row : screened.rows)
        if (in_window(row)) window.rows.push_back(&row);
    std::ranges::sort(window.rows, {}, &ScreenedEpoch::epoch);
    for (const std::size_t jump : shown.series.jumps)
        if (screened.rows[jump].epoch != screened.rows[first].epoch &&
            in_window(screened.rows[jump]))
            window.jumps.push_back(
                static_cast<std::size_t>(screened.rows[jump].epoch - window.rows.front()->epoch));
    return window;
}

}  // namespace

std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened,
                                                 const Profile& profile, const WindowConfig& config,
                                                 const std::optional<SurveyedCourse>& gates,
                                                 const std::optional<WindowPart>& part) {
    const Shown shown = most_shown(screened, profile, config, {.gates = gates, .part = part});
    const std::vector<FoundWindow>& found = shown.windows;
    if (found.empty()) return std::nullopt;
    const std::vector<std::size_t>& rows = shown.series.rows[found.front().series];
    const std::size_t first = rows[found.front().first];
    const std::size_t last = rows[found.front().last];
    IndicatedWindow window{
        .span = window_span(screened.facts, screened.rows[first].epoch, screened.rows[last].epoch,
                            found.front().start, found.front().end),
        .source = shown.source,
        .speed_m_s = found.front().speed_m_s,
        .stated_expanded_uncertainty_m_s = found.front().allowance_m_s,
        .mean_m_s = std::nullopt,
        .refusals = refusals_of(screened, rows_of(screened, shown, first, last), profile, config)};
    if (profile.windows > 1 && std::ssize(found) == profile.windows) {
        double sum = 0.0;
        for (const FoundWindow& one : found)
            sum += one.speed_m_s;
        window.mean_m_s = sum / static_cast<double>(found.size());
    }
    return window;
}

}  // namespace runcert
