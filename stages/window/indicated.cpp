#include <fmt/format.h>

#include <map>

#include "stages/window/course_windows.h"
#include "stages/window/sample_series.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

std::string describe(Reason reason, std::int64_t count) {
    return fmt::format("{} {} {}", count, count == 1 ? "epoch" : "epochs", phrase_of(reason));
}

/// Breaks inside a window, by what they mean for it.
struct Breaks {
    std::int64_t gaps = 0;
    std::int64_t steps = 0;    ///< positions, or their times, do not go on as they were
    std::int64_t bridged = 0;  ///< such a step whose offset the estimate takes out
};

void add_break(ArcBreak arc_break, Breaks& breaks) {
    switch (arc_break) {
        case ArcBreak::start:
        case ArcBreak::gap:
            ++breaks.gaps;
            break;
        case ArcBreak::innovation:
        case ArcBreak::step:
        case ArcBreak::ramp:
        case ArcBreak::time_shift:
            ++breaks.steps;
            break;
        case ArcBreak::bridged:
            ++breaks.bridged;
            break;
    }
}

std::vector<std::string> refusals_of(const ScreenedTable& screened, std::size_t first,
                                     std::size_t last, BridgedSteps bridged) {
    std::map<Reason, std::int64_t> reasons;
    std::vector<std::string> refusals;
    Breaks breaks;
    for (std::size_t i = first; i <= last; ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable) ++reasons[row.reason];
        if (i != first && row.break_before) add_break(*row.break_before, breaks);
    }
    refusals.reserve(reasons.size() + 3);
    for (const auto& [reason, count] : reasons)
        refusals.push_back(describe(reason, count));
    if (breaks.steps > 0)
        refusals.push_back(
            fmt::format("{} {} that the motion cannot explain: positions before and "
                        "after do not belong together",
                        breaks.steps, breaks.steps == 1 ? "step" : "steps"));
    if (breaks.bridged > 0 && bridged == BridgedSteps::refused)
        refusals.push_back(
            fmt::format("{} repaired {}: the recorded positions before and after belong together "
                        "only by an estimated offset",
                        breaks.bridged, breaks.bridged == 1 ? "step" : "steps"));
    if (breaks.gaps > 0 && reasons.empty())
        refusals.push_back(
            fmt::format("{} {} in time", breaks.gaps, breaks.gaps == 1 ? "gap" : "gaps"));
    return refusals;
}

/// The windows of the recording as it is, fastest first.
std::vector<FoundWindow> windows_as_recorded(const std::vector<SampleSeries>& series,
                                             const Profile& profile, const WindowCriteria& rule,
                                             const std::optional<CourseGates>& gates) {
    if (rule.kind == WindowKind::course)
        return gates ? course_windows(series, *gates) : std::vector<FoundWindow>();
    return best_windows(series, rule, static_cast<std::size_t>(profile.windows));
}

}  // namespace

std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened,
                                                 const Profile& profile, const WindowConfig& config,
                                                 const std::optional<CourseGates>& gates) {
    const IndicatedSeries indicated = indicated_series(screened, profile);
    WindowCriteria rule =
        window_criteria(profile, config.duration_tolerance_s, screened.facts.nominal_interval_s);
    // Positions as recorded have no speeds to take the mean of.
    if (profile.speed_source == SpeedSource::position &&
        rule.definition != SpeedDefinition::path_length)
        rule.definition = SpeedDefinition::displacement;
    const std::vector<FoundWindow> found =
        windows_as_recorded(indicated.series, profile, rule, gates);
    if (found.empty()) return std::nullopt;
    const std::size_t first = indicated.rows[found.front().first];
    const std::size_t last = indicated.rows[found.front().last];
    IndicatedWindow window{
        .span = window_span(screened.facts, screened.rows[first].epoch, screened.rows[last].epoch,
                            found.front().start, found.front().end),
        .speed_m_s = found.front().speed_m_s,
        .mean_m_s = std::nullopt,
        .refusals =
            refusals_of(screened, first, last,
                        profile.repaired_steps ? BridgedSteps::allowed : BridgedSteps::refused)};
    if (profile.windows > 1 && std::ssize(found) == profile.windows) {
        double sum = 0.0;
        for (const FoundWindow& one : found)
            sum += one.speed_m_s;
        window.mean_m_s = sum / static_cast<double>(found.size());
    }
    return window;
}

}  // namespace runcert
