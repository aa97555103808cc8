#include "stages/check/overshoot.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/statistics.h"

namespace runcert {
namespace {

struct Sample {
    double time_s = 0.0;
    double acceleration_mps2 = 0.0;
    double sigma_mps2 = 0.0;
};

/// The acceleration along the track, of each stretch of an arc in which the craft is fast enough to
/// have a direction.
std::vector<std::vector<Sample>> stretches_of(const std::vector<TrajectoryEpoch>& rows) {
    constexpr double slowest_mps = 2.0;
    std::vector<std::vector<Sample>> stretches;
    const TrajectoryEpoch* before = nullptr;
    for (const TrajectoryEpoch& row : rows) {
        if (!row.arc || *row.speed_mps < slowest_mps) {
            before = nullptr;
            continue;
        }
        if (!before || before->arc != row.arc) stretches.emplace_back();
        const double along = (*row.acceleration_east_mps2 * *row.velocity_east_mps +
                              *row.acceleration_north_mps2 * *row.velocity_north_mps) /
                             *row.speed_mps;
        stretches.back().push_back({row.time.seconds(), along,
                                    std::hypot(*row.sigma_acceleration_east_mps2,
                                               *row.sigma_acceleration_north_mps2)});
        before = &row;
    }
    return stretches;
}

/// The places where a series turns by more than a threshold: its highs and lows in turn.
std::vector<std::size_t> turns_of(const std::vector<Sample>& series) {
    constexpr double coverage = 3.0;
    std::vector<std::size_t> turns{0};
    std::size_t extreme = 0;
    int direction = 0;
    for (std::size_t k = 1; k < series.size(); ++k) {
        const double least = std::max(0.1, coverage * series[k].sigma_mps2);
        const double from_extreme =
            series[k].acceleration_mps2 - series[extreme].acceleration_mps2;
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

}  // namespace

Overshoot find_overshoot(const std::vector<TrajectoryEpoch>& rows) {
    constexpr double change_mps2 = 1.0;
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
            const auto value = [&](std::size_t j) {
                return series[turns[j]].acceleration_mps2;
            };
            const auto time_s = [&](std::size_t j) { return series[turns[j]].time_s; };
            const double change = std::abs(value(i) - value(i - 1));
            if (change < change_mps2 || time_s(i) - time_s(i - 1) > longest_change_s) continue;
            // A swing that follows a larger one belongs to it.
            if (i > 1 && std::abs(value(i - 1) - value(i - 2)) > change) continue;
            ++overshoot.changes;
            if (i + 2 >= turns.size()) continue;
            const double first = std::abs(value(i + 1) - value(i));
            const double second = std::abs(value(i + 2) - value(i + 1));
            const double half_s = time_s(i + 1) - time_s(i);
            const double next_half_s = time_s(i + 2) - time_s(i + 1);
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
    // In the same rhythm: those that are not are motion of the craft.
    overshoot.swings = std::ranges::count_if(periods, [&](double period_s) {
        return std::abs(period_s / overshoot.period_s - 1.0) <= of_rhythm;
    });
    return overshoot;
}

}  // namespace runcert
