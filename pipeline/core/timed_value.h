#pragma once

#include <algorithm>
#include <optional>
#include <span>

namespace runcert {

/// A measured value at a time (s) after a recording's first epoch.
struct TimedValue {
    double time_s = 0.0;
    double value = 0.0;
};

/// The value at a time, by linear interpolation between samples in order of time. Empty outside the
/// samples and between two that are more than `longest_step_s` apart.
inline std::optional<double> value_at(std::span<const TimedValue> samples, double time_s,
                                      double longest_step_s) {
    const auto after = std::ranges::lower_bound(samples, time_s, {}, &TimedValue::time_s);
    if (after == samples.end()) return std::nullopt;
    if (after->time_s == time_s) return after->value;
    if (after == samples.begin()) return std::nullopt;
    const TimedValue& before = *(after - 1);
    if (after->time_s - before.time_s > longest_step_s) return std::nullopt;
    const double share = (time_s - before.time_s) / (after->time_s - before.time_s);
    return before.value + share * (after->value - before.value);
}

}  // namespace runcert
