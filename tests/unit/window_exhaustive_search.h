#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <set>

#include "window_search_support.h"

namespace runcert::test {

/// The search of windows written down as the rules are, with nothing clever: every pair of samples,
/// every sum anew.
class ExhaustiveSearch {
  public:
    ExhaustiveSearch(const SearchTrack& track, const WindowCriteria& rule)
        : track_(track), rule_(rule) {}

    std::vector<FoundWindow> best(std::size_t count) {
        std::vector<FoundWindow> all;
        if (rule_.ends == WindowEnds::epochs)
            for (std::size_t s = 0; s < track_.series.size(); ++s)
                for (std::size_t i = 0; i < track_.series[s].times.size(); ++i)
                    add_windows_from(s, i, all);
        std::vector<FoundWindow> found;
        while (found.size() < count) {
            if (rule_.ends == WindowEnds::any) all = windows_at_any_instant(found);
            std::optional<FoundWindow> fastest;
            for (const FoundWindow& one : all)
                if (!overlaps(one, found) && (!fastest || one.speed_m_s > fastest->speed_m_s))
                    fastest = one;
            if (!fastest) break;
            found.push_back(*fastest);
        }
        return found;
    }

    /// The window that begins at an instant (ns), by time or path, at any instant; empty where
    /// there is none.
    std::optional<FoundWindow> window_from(std::size_t s, long double start_ns) const {
        const SampleSeries& series = track_.series[s];
        long double end_ns = start_ns + rule_.duration_s * 1e9L;
        if (rule_.kind == WindowKind::distance) {
            const std::vector<long double>& path = paths(s);
            const long double goal = path_at(s, start_ns) + rule_.distance_m;
            const auto at = std::lower_bound(path.begin(), path.end(), goal) - path.begin();
            if (at == std::ssize(path)) return std::nullopt;
            end_ns = time_on_path(s, static_cast<std::size_t>(at), goal);
        }
        if (start_ns < time(series, 0) || end_ns > time(series, series.times.size() - 1))
            return std::nullopt;
        return window(s, start_ns, end_ns);
    }

    std::optional<FoundWindow> window_to(std::size_t s, long double end_ns) const {
        if (rule_.kind == WindowKind::time) return window_from(s, end_ns - rule_.duration_s * 1e9L);
        const std::vector<long double>& path = paths(s);
        const long double goal = path_at(s, end_ns) - rule_.distance_m;
        if (goal < 0.0L) return std::nullopt;
        const auto at = std::upper_bound(path.begin(), path.end(), goal) - path.begin();
        return window(s, time_on_path(s, static_cast<std::size_t>(at), goal), end_ns);
    }

    static bool overlaps(const FoundWindow& one, const std::vector<FoundWindow>& others) {
        return std::any_of(others.begin(), others.end(), [&](const FoundWindow& other) {
            return one.series == other.series && one.start < other.end && other.start < one.end;
        });
    }

  private:
    static long double time(const SampleSeries& series, std::size_t k) {
        return static_cast<long double>(series.times[k].nanoseconds);
    }

    static bool bounds(const SampleSeries& series, std::size_t k) {
        return series.bounds.empty() || series.bounds[k];
    }

    /// Epochs: all windows that begin at a sample.
    void add_windows_from(std::size_t s, std::size_t i, std::vector<FoundWindow>& all) const {
        const SampleSeries& series = track_.series[s];
        if (!bounds(series, i)) return;
        double path = 0.0, speeds = series.speeds_m_s[i];
        for (std::size_t j = i + 1; j < series.times.size(); ++j) {
            if (track_.obstacle[s][j]) return;
            path += (series.positions[j] - series.positions[j - 1]).norm();
            speeds += series.speeds_m_s[j];
            const double time_s =
                static_cast<double>(series.times[j].nanoseconds - series.times[i].nanoseconds) *
                1e-9;
            const double straight = (series.positions[j] - series.positions[i]).norm();
            const bool by_path = rule_.definition == SpeedDefinition::path_length;
            bool last = false, counts = false;
            if (rule_.kind == WindowKind::time) {
                const double tolerance = rule_.duration_tolerance_s + 1e-10;
                last = time_s >= rule_.duration_s - tolerance;
                counts = last && (rule_.exact ? time_s <= rule_.duration_s + tolerance
                                              : time_s < rule_.duration_s +
                                                             rule_.nominal_interval_s - 1e-10);
            } else if (rule_.kind == WindowKind::distance) {
                counts = (by_path ? path : straight) >= rule_.distance_m - 1e-6;
                last = counts || path > 2.0 * rule_.distance_m;
            } else {
                last = path > rule_.distance_m + 1e-6;
                const bool long_enough = rule_.alpha == AlphaChoice::any
                                             ? path >= 2.0 * rule_.proximity_m - 1e-6
                                             : no_sample_earlier(s, i, path);
                counts = !last && long_enough && straight <= rule_.proximity_m && turned(s, i, j);
            }
            if (counts && bounds(series, j)) {
                const auto n = static_cast<double>(j - i);
                double speed = (by_path ? path : straight) / time_s;
                if (rule_.definition == SpeedDefinition::mean_n_plus_1) speed = speeds / (n + 1.0);
                if (rule_.definition == SpeedDefinition::mean_n)
                    speed = (speeds - series.speeds_m_s[i]) / n;
                all.push_back({s, i, j, series.times[i], series.times[j], speed * time_s, speed});
            }
            if (last) return;
        }
    }

    /// Whether an alpha from a sample, with this path, is too long from the sample before.
    bool no_sample_earlier(std::size_t s, std::size_t i, double path) const {
        const auto& positions = track_.series[s].positions;
        if (i == 0) return path >= rule_.distance_m - 1e-6;
        return path + (positions[i] - positions[i - 1]).norm() > rule_.distance_m + 1e-6;
    }

    Eigen::Vector3d direction(std::size_t s, std::size_t k) const {
        const auto& positions = track_.series[s].positions;
        std::size_t before = k, after = k;
        const double reach_m = rule_.alpha == AlphaChoice::any ? 5.0 : 0.1;
        for (double path = 0.0; before > 0 && path < reach_m; --before)
            path += (positions[before] - positions[before - 1]).norm();
        for (double path = 0.0; after + 1 < positions.size() && path < reach_m; ++after)
            path += (positions[after + 1] - positions[after]).norm();
        return positions[after] - positions[before];
    }

    bool turned(std::size_t s, std::size_t i, std::size_t j) const {
        if (directions_.size() <= s) directions_.resize(track_.series.size());
        auto& known = directions_[s];
        if (known.empty())
            for (std::size_t k = 0; k < track_.series[s].times.size(); ++k)
                known.push_back(direction(s, k));
        const Eigen::Vector3d &from = known[i], &to = known[j];
        if (from.norm() == 0.0 || to.norm() == 0.0) return false;
        const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
        return angle * 180.0 / std::numbers::pi >= rule_.turn_deg;
    }

    /// Any instant: windows that begin or end at a sample, or at an end of one that is taken.
    std::vector<FoundWindow> windows_at_any_instant(const std::vector<FoundWindow>& taken) const {
        std::vector<FoundWindow> all;
        const auto add = [&](const std::optional<FoundWindow>& one) {
            if (one) all.push_back(*one);
        };
        for (std::size_t s = 0; s < track_.series.size(); ++s)
            for (const ElapsedTime& at : track_.series[s].times) {
                add(window_from(s, static_cast<long double>(at.nanoseconds)));
                add(window_to(s, static_cast<long double>(at.nanoseconds)));
            }
        for (const FoundWindow& one : taken) {
            add(window_from(one.series, static_cast<long double>(one.end.nanoseconds)));
            add(window_to(one.series, static_cast<long double>(one.start.nanoseconds)));
        }
        return all;
    }

    const std::vector<long double>& paths(std::size_t s) const {
        if (paths_.size() <= s) paths_.resize(track_.series.size());
        const auto& positions = track_.series[s].positions;
        if (paths_[s].empty())
            for (std::size_t k = 0; k < positions.size(); ++k)
                paths_[s].push_back(
                    k == 0 ? 0.0L : paths_[s].back() + (positions[k] - positions[k - 1]).norm());
        return paths_[s];
    }

    /// The time at which the path has a length that it reaches in the step before sample `k`.
    long double time_on_path(std::size_t s, std::size_t k, long double goal) const {
        const SampleSeries& series = track_.series[s];
        if (k == 0 || k == series.times.size()) return time(series, k == 0 ? 0 : k - 1);
        const long double from = paths(s)[k - 1], to = paths(s)[k];
        const long double before = time(series, k - 1);
        return before + (goal - from) / (to - from) * (time(series, k) - before);
    }

    /// The sample at or before an instant.
    std::size_t sample_before(std::size_t s, long double at_ns) const {
        const auto& times = track_.series[s].times;
        const auto after = std::upper_bound(
            times.begin(), times.end(), at_ns, [](long double at, const ElapsedTime& one) {
                return at < static_cast<long double>(one.nanoseconds);
            });
        return static_cast<std::size_t>(after - times.begin()) - 1;
    }

    double fraction(std::size_t s, std::size_t k, long double at_ns) const {
        const SampleSeries& series = track_.series[s];
        if (k + 1 == series.times.size()) return 0.0;
        return static_cast<double>((at_ns - time(series, k)) /
                                   (time(series, k + 1) - time(series, k)));
    }

    long double path_at(std::size_t s, long double at_ns) const {
        const std::size_t k = sample_before(s, at_ns);
        const long double part = fraction(s, k, at_ns);
        return part == 0.0L ? paths(s)[k] : paths(s)[k] + part * (paths(s)[k + 1] - paths(s)[k]);
    }

    Eigen::Vector3d position_at(std::size_t s, long double at_ns) const {
        const auto& positions = track_.series[s].positions;
        const std::size_t k = sample_before(s, at_ns);
        const double part = fraction(s, k, at_ns);
        if (part == 0.0) return positions[k];
        return (1.0 - part) * positions[k] + part * positions[k + 1];
    }

    std::optional<FoundWindow> window(std::size_t s, long double start, long double end) const {
        const SampleSeries& series = track_.series[s];
        const ElapsedTime from{std::llround(start)}, to{std::llround(end)};
        std::set<std::size_t> ends;  // samples that enclose the ends
        for (const ElapsedTime& at : {from, to}) {
            const auto whole = static_cast<long double>(at.nanoseconds);
            const std::size_t k = sample_before(s, whole);
            ends.insert(k);
            if (time(series, k) != whole) ends.insert(k + 1);
        }
        const std::size_t first = *ends.begin(), last = *ends.rbegin();
        for (const std::size_t k : ends)
            if (!bounds(series, k)) return std::nullopt;
        for (std::size_t k = first + 1; k <= last; ++k)
            if (track_.obstacle[s][k]) return std::nullopt;
        const auto time_s = static_cast<double>((end - start) * 1e-9L);
        const double length = rule_.definition == SpeedDefinition::displacement
                                  ? (position_at(s, end) - position_at(s, start)).norm()
                                  : static_cast<double>(path_at(s, end) - path_at(s, start));
        return FoundWindow{s, first, last, from, to, length, length / time_s};
    }

    const SearchTrack& track_;
    WindowCriteria rule_;
    mutable std::vector<std::vector<long double>> paths_;
    mutable std::vector<std::vector<Eigen::Vector3d>> directions_;
};

}  // namespace runcert::test
