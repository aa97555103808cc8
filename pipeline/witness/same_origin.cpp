#include "witness/same_origin.h"

#include <Eigen/Core>
#include <Eigen/QR>
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

/// The second's positions minus the first's, interpolated where the first has neighbours without a
/// gap.
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

/// Speeds and the displacements around them, per second and along the direction of travel.
struct Regression {
    Eigen::MatrixXd displacements;  ///< one row for each speed
    Eigen::VectorXd speeds;
};

bool without_gap(Rows rows, std::size_t first, std::size_t last, double longest_s) {
    for (std::size_t i = first + 1; i <= last; ++i)
        if (rows[i].time_s - rows[i - 1].time_s > longest_s) return false;
    return true;
}

/// The regression over at most `most` of the rows that are fast enough.
Regression regression_of(Rows rows, std::size_t either_side, double least_m_s, std::size_t most) {
    constexpr double gap_factor = 1.5;
    const double step_s = median_step_s(rows);
    const auto width = static_cast<Eigen::Index>(2 * either_side);
    std::vector<Eigen::VectorXd> found;
    std::vector<double> speeds;
    for (std::size_t k = either_side; k + either_side < rows.size() && speeds.size() < most; ++k) {
        const std::size_t first = k - either_side, last = k + either_side;
        const Eigen::Vector2d way = rows[last].position_m - rows[first].position_m;
        if (!rows[k].speed_m_s || *rows[k].speed_m_s < least_m_s || !(way.norm() > 0.0) ||
            !without_gap(rows, first, last, gap_factor * step_s))
            continue;
        Eigen::VectorXd& along = found.emplace_back(width);
        for (Eigen::Index j = 0; j < width; ++j) {
            const std::size_t i = first + static_cast<std::size_t>(j);
            along[j] = (rows[i + 1].position_m - rows[i].position_m).dot(way.normalized()) / step_s;
        }
        speeds.push_back(*rows[k].speed_m_s);
    }
    Regression regression{.displacements = Eigen::MatrixXd(std::ssize(found), width),
                          .speeds = Eigen::VectorXd(std::ssize(found))};
    for (std::size_t i = 0; i < found.size(); ++i) {
        regression.displacements.row(static_cast<Eigen::Index>(i)) = found[i].transpose();
        regression.speeds[static_cast<Eigen::Index>(i)] = speeds[i];
    }
    return regression;
}

/// Robust scatter that the best weights leave in the speeds. Distant outliers are dropped.
double least_residual_m_s(const Regression& all) {
    constexpr int rounds = 3;
    constexpr double far_off = 5.0;
    Eigen::VectorXd counts = Eigen::VectorXd::Ones(all.speeds.size());
    double scatter = 0.0;
    for (int round = 0; round < rounds; ++round) {
        const Eigen::VectorXd weights = (counts.asDiagonal() * all.displacements)
                                            .householderQr()
                                            .solve(counts.cwiseProduct(all.speeds));
        const Eigen::VectorXd residuals = (all.speeds - all.displacements * weights).cwiseAbs();
        scatter =
            median(std::vector<double>(residuals.begin(), residuals.end())) / normal_quantile(0.75);
        counts = (residuals.array() <= far_off * scatter).cast<double>().matrix();
    }
    return scatter;
}

/// The white noise of the speeds, from their differences as for positions.
double white_noise_of_speeds(Rows rows) {
    std::vector<SpeedBesidePosition> speeds;
    for (const SpeedBesidePosition& row : rows)
        if (row.speed_m_s)
            speeds.push_back(
                {.time_s = row.time_s, .position_m = {*row.speed_m_s, *row.speed_m_s}});
    return velocities::white_noise_m(speeds);
}

double half_of_fastest_tenth(Rows rows) {
    constexpr double slowest_m_s = 1.0;
    std::vector<double> speeds;
    for (const SpeedBesidePosition& row : rows)
        if (row.speed_m_s) speeds.push_back(*row.speed_m_s);
    if (speeds.empty()) return slowest_m_s;
    const auto tenth = speeds.begin() + std::ssize(speeds) * 9 / 10;
    std::ranges::nth_element(speeds, tenth);
    return std::max(slowest_m_s, 0.5 * *tenth);
}

}  // namespace

bool are_filtered_positions(Rows rows) {
    constexpr double share = 0.2;
    constexpr std::size_t most = 4000;
    constexpr std::size_t rows_for_each_weight = 5;
    const double noise_m_s = white_noise_of_speeds(rows);
    const double least_m_s = half_of_fastest_tenth(rows);
    for (const std::size_t either_side : {8U, 32U}) {
        const Regression regression = regression_of(rows, either_side, least_m_s, most);
        const auto enough = static_cast<Eigen::Index>(rows_for_each_weight * 2 * either_side);
        if (regression.speeds.size() >= enough &&
            least_residual_m_s(regression) < share * noise_m_s)
            return true;
    }
    return false;
}

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
