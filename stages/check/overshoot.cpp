#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.h"
#include "stages/check/course.h"

namespace runcert {
namespace {

struct Sample {
    double time_s = 0.0;
    double acceleration_m_s2 = 0.0;
    double sigma_m_s2 = 0.0;
};

/// The acceleration along the track, by stretches in which the craft is fast enough to have one.
std::vector<std::vector<Sample>> stretches_of(const std::vector<TrajectoryEpoch>& rows) {
    constexpr double slowest_m_s = 2.0;
    std::vector<std::vector<Sample>> stretches;
    const TrajectoryEpoch* before = nullptr;
    for (const TrajectoryEpoch& row : rows) {
        if (!row.arc || row.speed_m_s.value() < slowest_m_s) {
            before = nullptr;
            continue;
        }
        if (!before || before->arc != row.arc) stretches.emplace_back();
        const double along =
            (row.acceleration_east_m_s2.value() * row.velocity_east_m_s.value() +
             row.acceleration_north_m_s2.value() * row.velocity_north_m_s.value()) /
            row.speed_m_s.value();
        stretches.back().push_back({row.time.seconds(), along,
                                    std::hypot(row.sigma_acceleration_east_m_s2.value(),
                                               row.sigma_acceleration_north_m_s2.value())});
        before = &row;
    }
    return stretches;
}

/// The alternating maxima and minima of a series that exceed a threshold.
std::vector<std::size_t> turns_of(const std::vector<Sample>& series) {
    constexpr double coverage = 3.0;
    std::vector<std::size_t> turns{0};
    std::size_t extreme = 0;
    int direction = 0;
    for (std::size_t k = 1; k < series.size(); ++k) {
        const double least = std::max(0.1, coverage * series[k].sigma_m_s2);
        const double from_extreme = series[k].acceleration_m_s2 - series[extreme].acceleration_m_s2;
        if (direction == 0) {
            if (std::abs(from_extreme) > least) {
                direction = from_extreme > 0.0 ? 1 : -1;
                extreme = k;
            }
        } else if (direction * from_extreme > 0.0) {
            extreme = k;
        } else if (-direction * from_extreme > least) {
            turns.push_back(extreme);
            extreme = k;
            direction = -direction;
        }
    }
    return turns;
}

/// The time from one turn to the next, without that in which the series stays within a quarter of
/// the change of the first. A craft may stay long at a plateau before the change.
double change_time_s(const std::vector<Sample>& series, std::size_t from, std::size_t to) {
    const double begin = series[from].acceleration_m_s2;
    const double quarter = 0.25 * std::abs(series[to].acceleration_m_s2 - begin);
    std::size_t k = to;
    while (k > from && std::abs(series[k].acceleration_m_s2 - begin) > quarter)
        --k;
    return series[to].time_s - series[k].time_s;
}

/// Where the series swings farthest back after its second turn, within one and a half times the
/// time since the first. It also finds swings too small to be a turn of their own.
std::size_t swing_back(const std::vector<Sample>& series, std::size_t first, std::size_t second) {
    const double until_s =
        series[second].time_s + 1.5 * (series[second].time_s - series[first].time_s);
    const double turned = series[second].acceleration_m_s2;
    const double sign = series[first].acceleration_m_s2 > turned ? 1.0 : -1.0;
    std::size_t farthest = second;
    for (std::size_t k = second; k < series.size() && series[k].time_s <= until_s; ++k)
        if (sign * (series[k].acceleration_m_s2 - series[farthest].acceleration_m_s2) > 0.0)
            farthest = k;
    return farthest;
}

}  // namespace

Overshoot find_overshoot(const std::vector<TrajectoryEpoch>& rows) {
    constexpr double change_m_s2 = 1.0;
    constexpr double longest_change_s = 4.0;
    constexpr double least_part = 0.15;
    constexpr double largest_part = 0.75;
    constexpr double of_rhythm = 0.35;
    Overshoot overshoot;
    std::vector<double> periods;
    std::vector<double> parts;
    for (const std::vector<Sample>& series : stretches_of(rows)) {
        const std::vector<std::size_t> turns = turns_of(series);
        for (std::size_t i = 1; i < turns.size(); ++i) {
            const auto value = [&](std::size_t j) { return series[turns[j]].acceleration_m_s2; };
            const auto time_s = [&](std::size_t j) { return series[turns[j]].time_s; };
            const double change = std::abs(value(i) - value(i - 1));
            if (change < change_m_s2 ||
                change_time_s(series, turns[i - 1], turns[i]) > longest_change_s)
                continue;
            // A swing after a larger one belongs to that one.
            if (i > 1 && std::abs(value(i - 1) - value(i - 2)) > change) continue;
            ++overshoot.changes;
            if (i + 1 >= turns.size()) continue;
            const double first = std::abs(value(i + 1) - value(i));
            const double half_s = time_s(i + 1) - time_s(i);
            const std::size_t back = swing_back(series, turns[i], turns[i + 1]);
            const double second = std::abs(series[back].acceleration_m_s2 - value(i + 1));
            const double next_half_s = series[back].time_s - time_s(i + 1);
            const bool dies = first > least_part * change && first < largest_part * change &&
                              second > least_part * first && second < largest_part * first;
            if (!dies || std::abs(next_half_s / half_s - 1.0) > of_rhythm) continue;
            ++overshoot.swings;
            periods.push_back(half_s + next_half_s);
            parts.push_back(first / change);
        }
    }
    if (periods.empty()) return overshoot;
    overshoot.period_s = median(periods);
    overshoot.part = median(parts);
    // Only those with the same rhythm count. The others are motion of the craft.
    overshoot.swings = std::ranges::count_if(periods, [&](double period_s) {
        return std::abs(period_s / overshoot.period_s - 1.0) <= of_rhythm;
    });
    return overshoot;
}

}  // namespace runcert
