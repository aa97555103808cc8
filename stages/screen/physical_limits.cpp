#include "stages/screen/physical_limits.h"

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/statistics.h"

namespace runcert {
namespace {

/// A figure of the motion with its standard uncertainty.
struct Figure {
    double value = 0.0;
    double sigma = 0.0;
};

struct Figures {
    Figure acceleration;  ///< m/s^2
    std::optional<Figure> jerk;
    std::optional<Figure> vertical_rate;
};

double sigma_along(const Eigen::Vector2d& vector, const Eigen::Matrix2d& covariance) {
    // A zero vector has no direction, and cannot exceed a limit.
    const Eigen::Vector2d direction = vector.normalized();
    return std::sqrt(std::max(0.0, direction.dot(covariance * direction)));
}

Figures figures_of(const EpochMotion& motion, const EpochMotion* before, double step_s) {
    Figures figures;
    figures.acceleration = {motion.acceleration.norm(),
                            sigma_along(motion.acceleration, motion.acceleration_covariance)};
    if (motion.vertical_rate_m_s)
        figures.vertical_rate = {std::abs(*motion.vertical_rate_m_s),
                                 motion.sigma_vertical_rate_m_s};
    if (!before || step_s <= 0.0) return figures;
    const Eigen::Vector2d change = motion.acceleration - before->acceleration;
    figures.jerk = {change.norm() / step_s, (sigma_along(change, motion.acceleration_covariance) +
                                             sigma_along(change, before->acceleration_covariance)) /
                                                step_s};
    return figures;
}

/// A limit that was exceeded.
struct Excess {
    Hypothesis hypothesis;
    double figure;
    double threshold;
};

std::optional<Excess> find_excess(const Figures& figures, const PhysicalLimits& limits,
                                  double coverage) {
    const auto test = [&](Hypothesis hypothesis, const std::optional<Figure>& figure,
                          double limit) -> std::optional<Excess> {
        if (!figure || limit <= 0.0) return std::nullopt;
        const double threshold = limit + coverage * figure->sigma;
        if (figure->value <= threshold) return std::nullopt;
        return Excess{hypothesis, figure->value, threshold};
    };
    if (const auto excess =
            test(Hypothesis::acceleration, figures.acceleration, limits.acceleration_m_s2))
        return excess;
    if (const auto excess = test(Hypothesis::jerk, figures.jerk, limits.jerk_m_s3)) return excess;
    return test(Hypothesis::vertical_rate, figures.vertical_rate, limits.vertical_rate_m_s);
}

void mark(ScreenedEpoch& row, const Excess& excess) {
    row.usable = false;
    row.reason = Reason::physical_limit;
    row.hypothesis = excess.hypothesis;
    row.statistic = excess.figure;
    row.threshold = excess.threshold;
    row.tested_axes = excess.hypothesis == Hypothesis::vertical_rate ? TestedAxes::vertical
                                                                     : TestedAxes::horizontal;
    // An error that an earlier test estimated for the row no longer explains the statistic.
    row.estimated = {};
}

void include(LimitComparison& comparison, const Figures& figures) {
    comparison.acceleration_m_s2 =
        std::max(comparison.acceleration_m_s2, figures.acceleration.value);
    if (figures.jerk) comparison.jerk_m_s3 = std::max(comparison.jerk_m_s3, figures.jerk->value);
    if (figures.vertical_rate)
        comparison.vertical_rate_m_s =
            std::max(comparison.vertical_rate_m_s, figures.vertical_rate->value);
}

}  // namespace

LimitComparison check_limits(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                             const PhysicalLimits& limits) {
    assert(motion.size() == rows.size());
    LimitComparison comparison{.acceleration_max_m_s2 = limits.acceleration_m_s2,
                               .jerk_max_m_s3 = limits.jerk_m_s3,
                               .vertical_rate_max_m_s = limits.vertical_rate_m_s};
    const double coverage = -normal_quantile(limits.test_size);
    std::optional<std::size_t> kept;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        ScreenedEpoch& row = rows[k];
        if (!row.usable || !row.arc || !motion[k]) continue;
        const bool follows = kept && rows[*kept].arc == row.arc;
        const double step_s =
            follows
                ? static_cast<double>(row.time.nanoseconds - rows[*kept].time.nanoseconds) * 1e-9
                : 0.0;
        const Figures figures = figures_of(*motion[k], follows ? &*motion[*kept] : nullptr, step_s);
        if (const std::optional<Excess> excess = find_excess(figures, limits, coverage)) {
            mark(row, *excess);
            ++comparison.rejected;
            continue;
        }
        include(comparison, figures);
        kept = k;
    }
    return comparison;
}

}  // namespace runcert
