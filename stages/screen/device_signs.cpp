#include "stages/screen/device_signs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/statistics.h"

namespace runcert {
namespace {

constexpr std::size_t epochs_each_side = 5;
constexpr double moving_m_s = 1.0;
/// A line straight in latitude and longitude is not straight to the last digit in the local frame.
constexpr double smallest_tolerance_m = 5e-5;

using Position = Eigen::Vector2d;

/// Consecutive positions at the recording's interval, from a row of that number on, counted in
/// intervals.
struct Stretch {
    std::int64_t first = 0;
    std::vector<Position> at;
};

std::vector<Stretch> stretches_of(const std::vector<ScreenedEpoch>& rows, double interval_s) {
    constexpr double longest = 1.5;
    std::vector<Stretch> stretches;
    const ScreenedEpoch* before = nullptr;
    for (const ScreenedEpoch& row : rows) {
        if (!row.east_m || !row.north_m || row.reason == Reason::no_fix) continue;
        const double step_s =
            before ? static_cast<double>(row.time.nanoseconds - before->time.nanoseconds) * 1e-9
                   : 0.0;
        if (!before || step_s <= 0.0 || step_s > longest * interval_s)
            stretches.push_back(
                {std::llround(static_cast<double>(row.time.nanoseconds) * 1e-9 / interval_s), {}});
        stretches.back().at.emplace_back(*row.east_m, *row.north_m);
        before = &row;
    }
    return stretches;
}

/// A fourth difference in motion: squared, of both coordinates, over the variance that rounding
/// gives it, and the number of its middle row.
struct FourthDifference {
    std::int64_t row = 0;
    double square = 0.0;
};

/// The value that `share` of them do not exceed; 0 of none.
double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() +
                        static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Rows from one knot to the next, where most rows lie on lines or cubics between others: between
/// knots the fourth differences are no larger than by rounding; they are at one row of each
/// `period` or at both beside it, as much before as behind (a step of the positions enlarges two
/// that follow one another). 0 where there is no such period.
std::int64_t rows_between_knots(const std::vector<FourthDifference>& differences) {
    constexpr std::int64_t shortest = 4, longest = 50;
    // Compared are the values that a fifth of the rows exceed, so that no outlier counts and a
    // straight run is no loss. Two coordinates of rounding have 2 ln 5 there.
    constexpr double share = 0.8, by_rounding = 3.2, margin = 1.5;
    constexpr double unequal = 0.5, least_ratio = 2.0, deviations = 6.0, deviation = 1.24;
    std::vector<double> all;
    for (const FourthDifference& one : differences)
        all.push_back(one.square);
    if (quantile(std::move(all), share / static_cast<double>(shortest)) > margin * by_rounding)
        return 0;
    std::int64_t found = 0;
    double clearest = 0.0;
    for (std::int64_t period = shortest; period <= longest; ++period) {
        const auto rows = static_cast<std::size_t>(period);
        std::vector<std::vector<double>> of_phase(rows);
        for (const FourthDifference& one : differences)
            of_phase[static_cast<std::size_t>((one.row % period + period) % period)].push_back(
                one.square);  // rows may lie before the first epoch
        std::size_t fewest = differences.size(), knot = 0;
        std::vector<double> size(rows);
        for (std::size_t phase = 0; phase < rows; ++phase) {
            fewest = std::min(fewest, of_phase[phase].size());
            size[phase] = quantile(of_phase[phase], share);
        }
        if (fewest < 20) break;
        const auto at = [&](std::size_t phase) { return size[phase % rows]; };
        const auto about = [&](std::size_t phase) {
            return at(phase + rows - 1) + at(phase) + at(phase + 1);
        };
        for (std::size_t phase = 1; phase < rows; ++phase)
            if (about(phase) > about(knot)) knot = phase;
        double between = 0.0;
        for (std::size_t phase = knot + 2; phase + 1 < knot + rows; ++phase)
            between = std::max(between, at(phase));
        const double before = at(knot + rows - 1), behind = at(knot + 1);
        const double there = std::max({before, at(knot), behind});
        const double needed = std::max(
            least_ratio, std::exp(deviations * deviation / std::sqrt(static_cast<double>(fewest))));
        if (between <= margin * by_rounding && there > needed * between &&
            std::abs(before - behind) < unequal * (there - between) && there / between > clearest) {
            clearest = there / between;
            found = period;
        }
    }
    return found;
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
    const double moved_m = 2.0 * static_cast<double>(epochs_each_side) *
                           std::max(moving_m_s * nominal_interval_s, 3.0 * position_resolution_m);
    std::vector<FourthDifference> fourth;
    const double by_rounding_m2 = 70.0 / 12.0 * 4.0 * tolerance_m * tolerance_m;
    for (const auto& [first, stretch] : stretches_of(rows, nominal_interval_s)) {
        for (std::size_t k = epochs_each_side; k + epochs_each_side < stretch.size(); ++k) {
            if ((stretch[k + epochs_each_side] - stretch[k - epochs_each_side]).norm() < moved_m)
                continue;
            ++signs.moving;
            const Position step = stretch[k] - stretch[k - 1];
            fourth.push_back({first + static_cast<std::int64_t>(k),
                              (stretch[k + 2] - 4.0 * stretch[k + 1] + 6.0 * stretch[k] -
                               4.0 * stretch[k - 1] + stretch[k - 2])
                                      .squaredNorm() /
                                  by_rounding_m2});
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
    if (const std::int64_t period = rows_between_knots(fourth); period > 0) {
        signs.interpolated = signs.moving - signs.moving / period;
        return signs;
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
