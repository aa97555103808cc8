#include "estimation/same_origin.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"

namespace runcert {
namespace {

using velocities::SpeedBesidePosition;
using Rows = std::span<const SpeedBesidePosition>;

constexpr std::size_t least_rows = 30;

double median_step_s(Rows rows) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < rows.size(); ++i)
        steps.push_back(rows[i].time_s - rows[i - 1].time_s);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// The second's positions less the first's, where the first has neighbours without a gap.
std::vector<SpeedBesidePosition> differences_of(Rows first, Rows second, double offset_s) {
    constexpr double gap_factor = 1.5;
    const double longest_s = gap_factor * median_step_s(first);
    std::vector<SpeedBesidePosition> differences;
    for (const SpeedBesidePosition& row : second) {
        const double time_s = row.time_s + offset_s;
        const auto after =
            std::ranges::lower_bound(first, time_s, {}, &SpeedBesidePosition::time_s);
        if (after == first.end()) break;
        if (after == first.begin() && after->time_s > time_s) continue;
        const auto before = after == first.begin() ? after : after - 1;
        const double between_s = after->time_s - before->time_s;
        if (between_s > longest_s) continue;
        const double part = between_s > 0.0 ? (time_s - before->time_s) / between_s : 0.0;
        differences.push_back({.time_s = time_s,
                               .position_m = row.position_m - before->position_m -
                                             part * (after->position_m - before->position_m)});
    }
    return differences;
}

}  // namespace

bool share_errors(Rows first, Rows second, double offset_s) {
    constexpr double share = 0.5;
    const std::vector<SpeedBesidePosition> differences = differences_of(first, second, offset_s);
    if (differences.size() < least_rows) return false;
    const double noise_m =
        std::min(velocities::white_noise_m(first), velocities::white_noise_m(second));
    return velocities::white_noise_m(differences) < share * noise_m;
}

bool keep_to_positions(std::span<const DisplacementSpread> spreads, bool of_code) {
    constexpr double least_span_s = 10.0;
    constexpr double least_density = 0.003;  // m s^-1/2
    constexpr double code_span_s = 100.0;
    constexpr double least_of_code_m = 0.1;
    return std::ranges::any_of(spreads, [&](const DisplacementSpread& one) {
        if (one.span_s < least_span_s) return false;
        return one.sd_m < least_density * std::sqrt(one.span_s) ||
               (of_code && one.span_s >= code_span_s && one.sd_m < least_of_code_m);
    });
}

bool agree_too_well(std::span<const double> normalised_differences) {
    constexpr double by_chance = 0.01;
    double sum = 0.0;
    for (const double one : normalised_differences)
        sum += one * one;
    return !normalised_differences.empty() &&
           sum < chi_squared_upper_quantile(1.0 - by_chance,
                                            static_cast<int>(normalised_differences.size()));
}

}  // namespace runcert
