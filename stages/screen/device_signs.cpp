#include "stages/screen/device_signs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr std::size_t epochs_beside = 5;
constexpr double moving_m_s = 1.0;
/// A line straight in latitude and longitude is not straight to the last digit in the local frame.
constexpr double smallest_tolerance_m = 5e-5;

using Position = Eigen::Vector2d;

/// Consecutive positions at the recording's interval.
using Stretch = std::vector<Position>;

std::vector<Stretch> stretches_of(const std::vector<ScreenedEpoch>& rows,
                                  double nominal_interval_s) {
    constexpr double longest = 1.5;
    std::vector<Stretch> stretches;
    const ScreenedEpoch* before = nullptr;
    for (const ScreenedEpoch& row : rows) {
        if (!row.east_m || !row.north_m || row.reason == Reason::no_fix) continue;
        const double step_s =
            before ? static_cast<double>(row.time.nanoseconds - before->time.nanoseconds) * 1e-9
                   : 0.0;
        if (!before || step_s <= 0.0 || step_s > longest * nominal_interval_s)
            stretches.emplace_back();
        stretches.back().emplace_back(*row.east_m, *row.north_m);
        before = &row;
    }
    return stretches;
}

/// The probability that each coordinate of a difference with this scatter is zero to a tolerance.
double chance_of_zero(double scatter_m, double tolerance_m) {
    if (scatter_m <= tolerance_m) return 1.0;
    const double of_one = std::erf(tolerance_m / (std::numbers::sqrt2 * scatter_m));
    return of_one * of_one;
}

}  // namespace

DeviceSigns find_device_signs(const std::vector<ScreenedEpoch>& rows, double nominal_interval_s,
                              double position_resolution_m) {
    DeviceSigns signs;
    if (nominal_interval_s <= 0.0) return signs;
    // Coordinates rotated into the local frame are no longer whole steps, being rounded at both
    // ends.
    const double tolerance_m = std::max(smallest_tolerance_m, 0.5 * position_resolution_m);
    std::vector<double> third;
    // A row must be several coordinate steps away from the previous one.
    const double moved_m = 2.0 * static_cast<double>(epochs_beside) *
                           std::max(moving_m_s * nominal_interval_s, 3.0 * position_resolution_m);
    for (const Stretch& stretch : stretches_of(rows, nominal_interval_s)) {
        for (std::size_t k = epochs_beside; k + epochs_beside < stretch.size(); ++k) {
            if ((stretch[k + epochs_beside] - stretch[k - epochs_beside]).norm() < moved_m)
                continue;
            ++signs.moving;
            const Position step = stretch[k] - stretch[k - 1];
            if (step.cwiseAbs().maxCoeff() <= smallest_tolerance_m) {
                ++signs.held;
                continue;
            }
            const Position second = stretch[k + 1] - stretch[k] - step;
            const Position second_before = step - (stretch[k - 1] - stretch[k - 2]);
            const Position change = second - second_before;
            third.push_back(std::abs(change.x()));
            third.push_back(std::abs(change.y()));
            if (second.cwiseAbs().maxCoeff() <= 2.0 * tolerance_m ||
                change.cwiseAbs().maxCoeff() <= 3.0 * tolerance_m)
                ++signs.interpolated;
        }
    }
    if (third.empty()) return signs;
    // The median of the values that are not zero: the rows that are looked for have zeros.
    std::erase_if(third, [&](double one) { return one <= 3.0 * tolerance_m; });
    if (third.empty()) return signs;
    constexpr double median_of_normal = 0.6745;
    const double scatter_m = median(std::move(third)) / median_of_normal;
    // For errors independent from row to row, third differences scatter by sqrt(20 / 6) times as
    // much as second differences.
    const double chance = chance_of_zero(scatter_m, 3.0 * tolerance_m) +
                          chance_of_zero(scatter_m * std::sqrt(6.0 / 20.0), 2.0 * tolerance_m);
    signs.by_chance = std::min(1.0, chance) * static_cast<double>(signs.moving);
    return signs;
}

}  // namespace runcert
