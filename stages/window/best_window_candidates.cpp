#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/angle.h"
#include "stages/window/best_window_sums.h"
#include "witness/certifiable.h"

namespace runcert {
namespace {

void add(const std::optional<FoundWindow>& window, WindowSearch& search) {
    ++search.steps;
    if (window) search.windows.push_back(*window);
}

WindowSearch over_time(const SummedSeries& series, const WindowCriteria& rule) {
    constexpr double nanosecond_s = 1e-9;  // the ends are searched below the limit, not up to it
    const double tolerance_s = rule.ends == WindowEnds::any ? 0.0 : rule.duration_tolerance_s;
    const auto ends =
        window_ends(series.samples->times, rule.duration_s, tolerance_s,
                    rule.exact || rule.ends == WindowEnds::any ? tolerance_s + nanosecond_s
                                                               : rule.nominal_interval_s);
    // One speed is no mean.
    const std::size_t least_steps = rule.definition == SpeedDefinition::mean_n ? 2 : 1;
    WindowSearch search;
    for (std::size_t first = 0; first < ends.size(); ++first)
        if (ends[first] && *ends[first] >= first + least_steps)
            add(window_between(series, first, *ends[first], rule.definition), search);
    search.steps += static_cast<std::int64_t>(series.size());
    return search;
}

/// The sample at which a window over the path ends, which is the first far enough along it. Empty
/// if there is none, or only one beyond the distance where that counts exactly.
std::optional<std::size_t> path_end(const SummedSeries& series, std::size_t first, std::size_t last,
                                    const WindowCriteria& rule) {
    if (last == series.size()) return std::nullopt;
    const bool longer =
        series.path_m()[last] - series.path_m()[first] > rule.distance_m + path_rounding_m;
    return rule.ends == WindowEnds::epochs || !longer ? std::optional(last) : std::nullopt;
}

/// The first sample from `last` on whose straight distance from `first` suffices, on up to twice as
/// much path.
std::optional<std::size_t> far_enough(const SummedSeries& series, std::size_t first,
                                      std::size_t last, double enough_m, std::int64_t& steps) {
    const std::vector<double>& path = series.path_m();
    const double longest_m = path[first] + 2.0 * (enough_m + path_rounding_m);
    while (last < path.size() && path[last] <= longest_m) {
        ++steps;
        const auto& positions = series.samples->positions;
        const double missing_m = enough_m - (positions[last] - positions[first]).norm();
        if (missing_m <= 0.0) return last;
        // At least that much path is needed to get there.
        const double next_m = path[last] + missing_m - path_rounding_m;
        const auto after = path.begin() + static_cast<std::ptrdiff_t>(last) + 1;
        last = static_cast<std::size_t>(std::lower_bound(after, path.end(), next_m) - path.begin());
    }
    return std::nullopt;
}

WindowSearch over_distance(const SummedSeries& series, const WindowCriteria& rule) {
    const double enough_m = rule.distance_m - path_rounding_m;
    const bool by_path = rule.definition == SpeedDefinition::path_length;
    WindowSearch search;
    std::size_t last = 0;
    for (std::size_t first = 0; first < series.size(); ++first) {
        while (last < series.size() && series.path_m()[last] - series.path_m()[first] < enough_m)
            ++last;
        const auto end = by_path ? path_end(series, first, last, rule)
                                 : far_enough(series, first, last, enough_m, search.steps);
        if (end) add(window_between(series, first, *end, rule.definition), search);
    }
    search.steps += static_cast<std::int64_t>(last);
    return search;
}

/// Direction of travel at each sample, a unit vector (`direction_reach_m`). At the ends of the
/// series it is one-sided. Zero where the craft turned round on the spot.
std::vector<Eigen::Vector3d> directions_along(const SummedSeries& series, double reach_m) {
    const std::vector<double>& path = series.path_m();
    const auto& positions = series.samples->positions;
    std::vector<Eigen::Vector3d> directions;
    directions.reserve(path.size());
    std::size_t before = 0;
    std::size_t after = 0;
    for (std::size_t k = 0; k < path.size(); ++k) {
        while (before + 1 < k && path[k] - path[before + 1] >= reach_m)
            ++before;
        while (after + 1 < path.size() && path[after] - path[k] < reach_m)
            ++after;
        const Eigen::Vector3d travel = positions[after] - positions[before];
        const double length_m = travel.norm();
        directions.emplace_back(length_m > 0.0 ? Eigen::Vector3d(travel / length_m)
                                               : Eigen::Vector3d::Zero());
    }
    return directions;
}

bool earlier(const FoundWindow& a, const FoundWindow& b) {
    return a.start != b.start ? a.start < b.start : a.end < b.end;
}

/// Whether two samples lie close enough for the ends of an alpha, in directions that differ enough.
class AlphaEnds {
  public:
    AlphaEnds(const SummedSeries& series, const WindowCriteria& rule, double reach_m)
        : positions_(series.samples->positions),
          directions_(directions_along(series, reach_m)),
          proximity_m_(rule.proximity_m),
          cosine_(std::cos(rule.turn_deg * radians_per_degree)) {}

    bool meet(std::size_t first, std::size_t last) const {
        const Eigen::Vector3d &from = directions_[first], &to = directions_[last];
        return (positions_[last] - positions_[first]).norm() <= proximity_m_ && !from.isZero(0.0) &&
               !to.isZero(0.0) && from.dot(to) <= cosine_;
    }

  private:
    const std::vector<Eigen::Vector3d>& positions_;
    std::vector<Eigen::Vector3d> directions_;
    double proximity_m_, cosine_;
};

WindowSearch longest_alphas(const SummedSeries& series, const WindowCriteria& rule) {
    const std::vector<double>& path = series.path_m();
    const AlphaEnds ends(series, rule, direction_reach_m);
    WindowSearch search;
    std::size_t first = 0;
    for (std::size_t last = 1; last < series.size(); ++last) {
        while (path[last] - path[first] > rule.distance_m + path_rounding_m)
            ++first;
        const bool whole = path[last] - path.front() >= rule.distance_m - path_rounding_m;
        if (whole && ends.meet(first, last))
            add(window_between(series, first, last, rule.definition), search);
    }
    search.steps += static_cast<std::int64_t>(series.size() + first);
    return search;
}

/// Longer alphas (s) are slower than half of the fastest of these.
double longest_time_s(const std::vector<FoundWindow>& alphas, double distance_m) {
    double fastest_m_s = 0.0;
    for (const FoundWindow& alpha : alphas)
        fastest_m_s = std::max(fastest_m_s, alpha.speed_m_s);
    return fastest_m_s > 0.0 ? 2.0 * distance_m / fastest_m_s
                             : std::numeric_limits<double>::infinity();
}

WindowSearch alphas_of_any_length(const SummedSeries& series, const WindowCriteria& rule) {
    const std::vector<double>& path = series.path_m();
    const auto& times = series.samples->times;
    const AlphaEnds ends(series, rule, any_direction_reach_m);
    WindowSearch search = longest_alphas(series, rule);
    const std::vector<FoundWindow> longest = std::move(search.windows);
    search.windows.clear();
    const double limit_s = longest_time_s(longest, rule.distance_m);
    const double shortest_m = 2.0 * rule.proximity_m - path_rounding_m;
    auto of_end = longest.begin();
    for (std::size_t last = 1; last < series.size(); ++last) {
        std::optional<FoundWindow> fastest;
        for (std::size_t first = last; first-- > 0; ++search.steps) {
            const double length_m = path[last] - path[first];
            if (length_m > rule.distance_m + path_rounding_m ||
                times[last].seconds() - times[first].seconds() > limit_s)
                break;
            if (length_m < shortest_m || !ends.meet(first, last)) continue;
            const auto window = window_between(series, first, last, rule.definition);
            if (window && (!fastest || preferred(*window, *fastest))) fastest = window;
        }
        while (of_end != longest.end() && of_end->last < last)
            ++of_end;
        if (!fastest && of_end != longest.end() && of_end->last == last) fastest = *of_end;
        if (fastest) search.windows.push_back(*fastest);
    }
    std::ranges::sort(search.windows, earlier);
    return search;
}

WindowSearch alphas(const SummedSeries& series, const WindowCriteria& rule) {
    return rule.alpha == AlphaChoice::any ? alphas_of_any_length(series, rule)
                                          : longest_alphas(series, rule);
}

}  // namespace

WindowSearch windows_in(const SummedSeries& series, const WindowCriteria& rule) {
    if (series.size() < 2) return {};
    if (rule.kind == WindowKind::time) return over_time(series, rule);
    if (rule.kind == WindowKind::alpha) return alphas(series, rule);
    return over_distance(series, rule);
}

}  // namespace runcert
