#include "stages/window/best_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/failure.h"
#include "stages/window/best_window_sums.h"

namespace runcert {
namespace {

bool is_mean(SpeedDefinition definition) {
    return definition == SpeedDefinition::mean_n_plus_1 || definition == SpeedDefinition::mean_n;
}

void refuse(std::string_view what) {
    throw Failure("the rule of a window", std::string(what), "Correct the profile's rule");
}

void check_rule(const WindowCriteria& rule) {
    const bool any = rule.ends == WindowEnds::any;
    const bool path = rule.definition == SpeedDefinition::path_length;
    if (rule.definition == SpeedDefinition::elapsed_time)
        refuse("elapsed_time is the speed over a course");
    switch (rule.kind) {
        case WindowKind::course:
            refuse("a window over a course is searched by its gates, not by its length");
            break;
        case WindowKind::time:
            if (any && is_mean(rule.definition))
                refuse("a mean of samples' speeds needs a window between epochs");
            if (!(rule.duration_s > 0.0)) refuse("a window's duration is not positive");
            break;
        case WindowKind::distance:
            if (is_mean(rule.definition))
                refuse("a window over a distance has no mean of samples' speeds");
            if (any && !path) refuse("at any instant a distance is one along the path");
            if (!(rule.distance_m > path_rounding_m)) refuse("a window's distance is not positive");
            break;
        case WindowKind::alpha:
            if (any || !path) refuse("an alpha is a path between epochs");
            if (!(rule.distance_m > path_rounding_m)) refuse("an alpha's distance is not positive");
            break;
    }
}

bool overlap(const FoundWindow& a, const FoundWindow& b) {
    return a.series == b.series && a.start < b.end && b.start < a.end;
}

void append(const WindowSearch& more, WindowSearch& all) {
    all.windows.insert(all.windows.end(), more.windows.begin(), more.windows.end());
    all.steps += more.steps;
}

std::vector<SummedSeries> summed_all(const std::vector<SampleSeries>& series) {
    std::vector<SummedSeries> sums;
    sums.reserve(series.size());
    for (std::size_t k = 0; k < series.size(); ++k)
        sums.push_back(summed(series[k], k));
    return sums;
}

/// Windows that begin or end where a found one ends or begins, and overlap none of those found.
WindowSearch free_beside(const std::vector<SummedSeries>& sums, const WindowCriteria& rule,
                         const std::vector<FoundWindow>& found) {
    WindowSearch beside = windows_beside(sums[found.back().series], rule, found.back());
    std::erase_if(beside.windows, [&](const FoundWindow& window) {
        return std::any_of(found.begin(), found.end(),
                           [&](const FoundWindow& one) { return overlap(one, window); });
    });
    return beside;
}

WindowSearch all_windows(const std::vector<SummedSeries>& sums, const WindowCriteria& rule) {
    WindowSearch all;
    for (const SummedSeries& series : sums)
        append(windows_in(series, rule), all);
    return all;
}

/// The fastest of the allowed windows (`left`).
WindowSearch fastest_of(WindowSearch left, const std::vector<SummedSeries>& sums,
                        const WindowCriteria& rule, std::size_t count,
                        const Allowance& allowance = {}) {
    std::vector<FoundWindow> found;
    while (found.size() < count && !left.windows.empty()) {
        left.steps += static_cast<std::int64_t>(left.windows.size());
        found.push_back(*std::min_element(left.windows.begin(), left.windows.end(), preferred));
        if (found.size() == count) break;
        std::erase_if(left.windows,
                      [&](const FoundWindow& window) { return overlap(window, found.back()); });
        if (rule.ends != WindowEnds::any) continue;
        WindowSearch beside = free_beside(sums, rule, found);
        make_allowances(beside.windows, allowance);
        append(beside, left);
    }
    return {found, left.steps};
}

}  // namespace

bool preferred(const FoundWindow& one, const FoundWindow& other) {
    if (one.assured_m_s() != other.assured_m_s()) return one.assured_m_s() > other.assured_m_s();
    return std::tie(one.series, one.start, one.end) <
           std::tie(other.series, other.start, other.end);
}

WindowSearch search_windows(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                            std::size_t count) {
    check_rule(rule);
    const std::vector<SummedSeries> sums = summed_all(series);
    return fastest_of(all_windows(sums, rule), sums, rule, count);
}

std::vector<FoundWindow> best_windows(const std::vector<SampleSeries>& series,
                                      const WindowCriteria& rule, std::size_t count) {
    return search_windows(series, rule, count).windows;
}

void make_allowances(std::vector<FoundWindow>& windows, const Allowance& allowance) {
    if (!allowance) return;
    for (FoundWindow& window : windows)
        window.allowance_m_s = allowance(window);
    std::erase_if(windows,
                  [](const FoundWindow& window) { return !std::isfinite(window.allowance_m_s); });
}

AllowedWindows allowed_and_best(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                                std::size_t count, const Allowance& allowance) {
    check_rule(rule);
    const std::vector<SummedSeries> sums = summed_all(series);
    AllowedWindows windows{.all = all_windows(sums, rule).windows, .best = {}};
    make_allowances(windows.all, allowance);
    // Avoids copying all windows if only one is requested.
    if (count == 1 && !windows.all.empty())
        windows.best = {*std::ranges::min_element(windows.all, preferred)};
    else
        windows.best = fastest_of({windows.all, 0}, sums, rule, count, allowance).windows;
    return windows;
}

}  // namespace runcert
