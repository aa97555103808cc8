#include "stages/window/best_window_sums.h"

#include <cassert>
#include <cmath>

namespace runcert {
namespace {

double step_s(const SummedSeries& series, std::size_t after) {
    const auto& times = series.samples->times;
    return static_cast<double>(times[after + 1].nanoseconds - times[after].nanoseconds) * 1e-9;
}

double elapsed_s(const SummedSeries& series, SeriesInstant start, SeriesInstant end) {
    const auto& times = series.samples->times;
    double elapsed = times[end.after].seconds() - times[start.after].seconds();
    if (end.fraction > 0.0) elapsed += end.fraction * step_s(series, end.after);
    if (start.fraction > 0.0) elapsed -= start.fraction * step_s(series, start.after);
    return elapsed;
}

Eigen::Vector3d position_at(const SummedSeries& series, SeriesInstant instant) {
    const auto& positions = series.samples->positions;
    const Eigen::Vector3d& before = positions[instant.after];
    if (instant.fraction == 0.0) return before;
    return before + instant.fraction * (positions[instant.after + 1] - before);
}

/// Length and speed of a window between two instants.
struct Measured {
    double length_m = 0.0;
    double speed_m_s = 0.0;
};

Measured mean_speed(const SummedSeries& series, std::size_t first, std::size_t last, double time_s,
                    SpeedDefinition definition) {
    const auto steps = static_cast<double>(last - first);
    const double later_speeds = series.speed_sum[last] - series.speed_sum[first];
    const double speed_m_s =
        definition == SpeedDefinition::mean_n
            ? later_speeds / steps
            : (later_speeds + series.samples->speeds_m_s[first]) / (steps + 1.0);
    return {speed_m_s * time_s, speed_m_s};
}

Measured measure(const SummedSeries& series, SeriesInstant start, SeriesInstant end,
                 SpeedDefinition definition) {
    const double time_s = elapsed_s(series, start, end);
    double length_m = 0.0;
    switch (definition) {
        case SpeedDefinition::displacement:
            length_m = distance_between(position_at(series, start), position_at(series, end));
            break;
        case SpeedDefinition::path_length:
            length_m = path_at(series, end) - path_at(series, start);
            break;
        case SpeedDefinition::mean_n_plus_1:
        case SpeedDefinition::mean_n:
            return mean_speed(series, start.after, end.after, time_s, definition);
        case SpeedDefinition::elapsed_time:  // over a course, for which there is no search
            break;
    }
    return {length_m, length_m / time_s};
}

bool may_bound(const SampleSeries& series, std::size_t sample) {
    return series.bounds.empty() || series.bounds[sample];
}

}  // namespace

bool window_allowed(const SampleSeries& series, std::size_t first, std::size_t last) {
    return may_bound(series, first) && may_bound(series, last) &&
           (series.obstacles.empty() || series.obstacles[first] == series.obstacles[last]);
}

SummedSeries summed(const SampleSeries& series, std::size_t index) {
    assert(series.positions.size() == series.times.size());
    assert(series.speeds_m_s.empty() || series.speeds_m_s.size() == series.times.size());
    assert(series.obstacles.empty() || series.obstacles.size() == series.times.size());
    assert(series.bounds.empty() || series.bounds.size() == series.times.size());
    SummedSeries sums{&series, index, {}, {}};
    sums.path_m.reserve(series.times.size());
    double path_m = 0.0;
    for (std::size_t k = 0; k < series.times.size(); ++k) {
        assert(k == 0 || series.times[k - 1] < series.times[k]);
        if (!series.path_m.empty())
            path_m = series.path_m[k];
        else if (k > 0)
            path_m += distance_between(series.positions[k - 1], series.positions[k]);
        sums.path_m.push_back(path_m);
    }
    sums.speed_sum.reserve(series.speeds_m_s.size());
    double speed = 0.0;
    for (const double speed_m_s : series.speeds_m_s)
        sums.speed_sum.push_back(speed += speed_m_s);
    return sums;
}

double distance_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::hypot(std::hypot(b.x() - a.x(), b.y() - a.y()), b.z() - a.z());
}

SeriesInstant instant_at_time(const SummedSeries& series, std::int64_t time_ns, std::size_t from) {
    const auto& times = series.samples->times;
    std::size_t after = from;
    while (after + 1 < times.size() && times[after + 1].nanoseconds <= time_ns)
        ++after;
    const std::int64_t beyond_ns = time_ns - times[after].nanoseconds;
    if (beyond_ns == 0 || after + 1 == times.size()) return {after, 0.0};
    return {after, static_cast<double>(beyond_ns) * 1e-9 / step_s(series, after)};
}

SeriesInstant last_instant_at_path(const SummedSeries& series, double path_m, std::size_t from) {
    const std::vector<double>& path = series.path_m;
    std::size_t after = from;
    while (after + 1 < path.size() && path[after + 1] <= path_m)
        ++after;
    if (after + 1 == path.size()) return {after, 0.0};
    return {after, (path_m - path[after]) / (path[after + 1] - path[after])};
}

SeriesInstant first_instant_at_path(const SummedSeries& series, double path_m, std::size_t from) {
    const std::vector<double>& path = series.path_m;
    std::size_t next = from;
    while (next + 1 < path.size() && path[next] < path_m)
        ++next;
    if (next == 0 || path[next] <= path_m) return {next, 0.0};
    return {next - 1, (path_m - path[next - 1]) / (path[next] - path[next - 1])};
}

std::int64_t time_of(const SummedSeries& series, SeriesInstant instant) {
    const std::int64_t before_ns = series.samples->times[instant.after].nanoseconds;
    if (instant.fraction == 0.0) return before_ns;
    return before_ns + std::llround(instant.fraction * step_s(series, instant.after) * 1e9);
}

double path_at(const SummedSeries& series, SeriesInstant instant) {
    const double before_m = series.path_m[instant.after];
    if (instant.fraction == 0.0) return before_m;
    return before_m + instant.fraction * (series.path_m[instant.after + 1] - before_m);
}

std::optional<FoundWindow> window_between(const SummedSeries& series, SeriesInstant start,
                                          SeriesInstant end, SpeedDefinition definition) {
    const SampleSeries& samples = *series.samples;
    const ElapsedTime from{time_of(series, start)};
    const ElapsedTime to{time_of(series, end)};
    // An end that rounds to a sample is at that sample, even if the sums place it on the other
    // side.
    const bool starts_at_next = start.fraction > 0.0 && from == samples.times[start.after + 1];
    const bool ends_at_sample = end.fraction == 0.0 || to == samples.times[end.after];
    const std::size_t first = start.after + (starts_at_next ? 1 : 0);
    const std::size_t last = end.after + (ends_at_sample ? 0 : 1);
    if (last <= first || from >= to || !window_allowed(samples, first, last)) return std::nullopt;
    if (from > samples.times[first] && !may_bound(samples, first + 1)) return std::nullopt;
    if (to < samples.times[last] && !may_bound(samples, last - 1)) return std::nullopt;
    const Measured measured = measure(series, start, end, definition);
    return FoundWindow{series.index, first, last, from, to, measured.length_m, measured.speed_m_s};
}

std::optional<FoundWindow> window_between(const SummedSeries& series, std::size_t first,
                                          std::size_t last, SpeedDefinition definition) {
    return window_between(series, SeriesInstant{first, 0.0}, SeriesInstant{last, 0.0}, definition);
}

}  // namespace runcert
