#include "stages/check/wind.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/angle.h"

namespace runcert {
namespace {

using Eigen::Vector2d;

Vector2d unit_towards(double direction_deg) {
    return {std::sin(direction_deg / degrees_per_radian),
            std::cos(direction_deg / degrees_per_radian)};
}

/// The velocity of the air or the water, m/s, east and north.
Vector2d velocity_of(const SeriesSample& sample, FlowKind kind) {
    return (kind == FlowKind::wind ? -1.0 : 1.0) * sample.value *
           unit_towards(sample.direction_deg);
}

struct FlowAt {
    double time_s = 0.0;
    Vector2d velocity_m_s;
};

FlowAt between(const SeriesSample& a, const SeriesSample& b, FlowKind kind, double time_s) {
    const double part = (time_s - a.time_s) / (b.time_s - a.time_s);
    return {time_s, (1.0 - part) * velocity_of(a, kind) + part * velocity_of(b, kind)};
}

/// Why the series does not cover the window. Empty if it does. `from` is the last sample at or
/// before the window's start, `to` the first at or after its end.
std::string gap_in(const MeasuredSeries& series, double start_s, double end_s, std::size_t from,
                   std::size_t to, double max_spacing_s) {
    const double longest_s = max_spacing_s + 1e-6;  // times are sums of binary fractions
    for (std::size_t i = from; i < to; ++i) {
        const double before_s = series.samples[i].time_s, after_s = series.samples[i + 1].time_s;
        // The instants of the window between the two samples that are farthest from one of them.
        if (std::min(after_s, end_s) - before_s > longest_s ||
            after_s - std::max(before_s, start_s) > longest_s)
            return fmt::format(
                "{} has no sample between {:.1f} s and {:.1f} s; the window is {:.1f} s to {:.1f} "
                "s, and every instant of it needs one at most {:.0f} s before and after",
                series.where, before_s, after_s, start_s, end_s, max_spacing_s);
    }
    return {};
}

/// The flow at the window's ends and at the samples between them.
std::vector<FlowAt> flow_over(const MeasuredSeries& series, FlowKind kind, double start_s,
                              double end_s, std::size_t from, std::size_t to) {
    const auto& samples = series.samples;
    const auto at = [&](std::size_t i) {
        return FlowAt{samples[i].time_s, velocity_of(samples[i], kind)};
    };
    if (from == to) return {at(from)};
    std::vector<FlowAt> flow = {between(samples[from], samples[from + 1], kind, start_s)};
    for (std::size_t i = from + 1; i < to; ++i)
        flow.push_back(at(i));
    flow.push_back(between(samples[to - 1], samples[to], kind, end_s));
    return flow;
}

Vector2d time_mean(const std::vector<FlowAt>& flow) {
    const double duration_s = flow.back().time_s - flow.front().time_s;
    if (duration_s == 0.0) return flow.front().velocity_m_s;
    Vector2d sum = Vector2d::Zero();
    for (std::size_t i = 1; i < flow.size(); ++i)
        sum += 0.5 * (flow[i].time_s - flow[i - 1].time_s) *
               (flow[i - 1].velocity_m_s + flow[i].velocity_m_s);
    return sum / duration_s;
}

/// The direction by which such a flow is named.
double direction_of(const Vector2d& velocity, FlowKind kind) {
    if (velocity.isZero(0.0)) return 0.0;
    const Vector2d named = kind == FlowKind::wind ? Vector2d(-velocity) : velocity;
    const double direction_deg = std::atan2(named.x(), named.y()) * degrees_per_radian;
    const double positive_deg = direction_deg < 0.0 ? direction_deg + 360.0 : direction_deg;
    return positive_deg < 360.0 ? positive_deg : 0.0;
}

}  // namespace

FlowInWindow flow_in_window(const MeasuredSeries& series, FlowKind kind, double start_s,
                            double end_s, double heading_deg, double max_spacing_s) {
    assert(start_s <= end_s);
    const auto& samples = series.samples;
    const auto after_start = std::ranges::upper_bound(samples, start_s, {}, &SeriesSample::time_s);
    const auto not_before_end = std::ranges::lower_bound(samples, end_s, {}, &SeriesSample::time_s);
    FlowInWindow result;
    if (after_start == samples.begin() || not_before_end == samples.end()) {
        result.missing =
            samples.empty()
                ? fmt::format("{} has no sample", series.where)
                : fmt::format(
                      "{} covers {:.1f} s to {:.1f} s from the recording's first epoch; "
                      "the window is {:.1f} s to {:.1f} s",
                      series.where, samples.front().time_s, samples.back().time_s, start_s, end_s);
        return result;
    }
    const auto from = static_cast<std::size_t>(after_start - samples.begin()) - 1;
    const auto to = static_cast<std::size_t>(not_before_end - samples.begin());
    result.missing = gap_in(series, start_s, end_s, from, to, max_spacing_s);
    if (!result.missing.empty()) return result;

    const std::vector<FlowAt> flow = flow_over(series, kind, start_s, end_s, from, to);
    for (const FlowAt& one : flow)
        result.gust_m_s = std::max(result.gust_m_s, one.velocity_m_s.norm());
    const Vector2d mean = time_mean(flow);
    const Vector2d ahead = unit_towards(heading_deg);
    result.mean_m_s = mean.norm();
    result.direction_deg = direction_of(mean, kind);
    result.along_m_s = mean.dot(ahead);
    result.across_m_s = mean.dot(Vector2d(ahead.y(), -ahead.x()));
    result.samples = std::ranges::count_if(samples, [&](const SeriesSample& sample) {
        return sample.time_s >= start_s && sample.time_s <= end_s;
    });
    return result;
}

}  // namespace runcert
