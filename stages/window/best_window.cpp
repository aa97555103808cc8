#include "stages/window/best_window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/failure.h"
#include "stages/window/best_window_sums.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

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

/// The series that a search goes through: at any instant, with the ends of windows as samples.
class SearchedSeries {
  public:
    SearchedSeries(const std::vector<SampleSeries>& series, const WindowCriteria& rule)
        : series_(series), rule_(rule), instants_(series.size()) {}

    WindowSearch windows() const {
        WindowSearch all;
        for (std::size_t s = 0; s < series_.size(); ++s) {
            const WindowSearch more = windows_of(s);
            all.windows.insert(all.windows.end(), more.windows.begin(), more.windows.end());
            all.steps += more.steps;
        }
        return all;
    }

    WindowSearch windows_of(std::size_t s) const {
        if (rule_.ends == WindowEnds::epochs) return windows_in(summed(series_[s], s), rule_);
        const SampleSeries dense = with_instants(series_[s], rule_, instants_[s]);
        WindowSearch search = windows_in(summed(dense, s), rule_);
        const auto& times = series_[s].times;
        for (FoundWindow& window : search.windows) {
            const auto after_start = std::ranges::upper_bound(times, window.start);
            window.first = static_cast<std::size_t>(after_start - times.begin()) - 1;
            window.last = static_cast<std::size_t>(std::ranges::lower_bound(times, window.end) -
                                                   times.begin());
        }
        search.steps += static_cast<std::int64_t>(dense.times.size());
        return search;
    }

    /// Lets windows begin and end where a found one does.
    void add_ends(const FoundWindow& found) {
        instants_[found.series].push_back(found.start);
        instants_[found.series].push_back(found.end);
    }

  private:
    const std::vector<SampleSeries>& series_;
    const WindowCriteria& rule_;
    std::vector<std::vector<ElapsedTime>> instants_;
};

/// The fastest of the allowed windows (`left`).
WindowSearch fastest_of(WindowSearch left, SearchedSeries series, const WindowCriteria& rule,
                        std::size_t count, const Allowance& allowance = {}) {
    std::vector<FoundWindow> found;
    while (found.size() < count && !left.windows.empty()) {
        left.steps += static_cast<std::int64_t>(left.windows.size());
        found.push_back(*std::min_element(left.windows.begin(), left.windows.end(), preferred));
        if (found.size() == count) break;
        if (rule.ends == WindowEnds::any) {
            series.add_ends(found.back());
            WindowSearch again = series.windows_of(found.back().series);
            make_allowances(again.windows, allowance);
            std::erase_if(left.windows, [&](const FoundWindow& window) {
                return window.series == found.back().series;
            });
            left.windows.insert(left.windows.end(), again.windows.begin(), again.windows.end());
            left.steps += again.steps;
        }
        std::erase_if(left.windows, [&](const FoundWindow& window) {
            return std::ranges::any_of(
                found, [&](const FoundWindow& one) { return overlap(one, window); });
        });
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
    const SearchedSeries searched(series, rule);
    return fastest_of(searched.windows(), searched, rule, count);
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
    const SearchedSeries searched(series, rule);
    AllowedWindows windows{.all = searched.windows().windows, .best = {}};
    make_allowances(windows.all, allowance);
    // Avoids copying all windows if only one is requested.
    if (count == 1 && !windows.all.empty())
        windows.best = {*std::ranges::min_element(windows.all, preferred)};
    else
        windows.best = fastest_of({windows.all, 0}, searched, rule, count, allowance).windows;
    return windows;
}

}  // namespace runcert
