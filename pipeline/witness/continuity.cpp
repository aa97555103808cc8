#include "witness/continuity.h"

#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

constexpr double coverage = 5.0;

bool is_located(const EnuEpoch& row) {
    return row.fix != FixType::none && row.east_m && row.north_m;
}

Eigen::Vector3d position(const EnuEpoch& row) {
    return {*row.east_m, *row.north_m, row.up_m.value_or(0.0)};
}

Eigen::Vector3d displacement(const EnuEpoch& from, const EnuEpoch& to) {
    Eigen::Vector3d moved = position(to) - position(from);
    if (!from.up_m || !to.up_m) moved.z() = 0.0;
    return moved;
}

double variance(const EnuEpoch& row) {
    double sum = 0.0;
    for (const OptionalReal& sigma : {row.sigma_east_m, row.sigma_north_m, row.sigma_up_m})
        sum += sigma ? *sigma * *sigma : 0.0;
    return sum;
}

/// How far (m) the step may miss the position that the velocities predict. Each velocity comes from
/// two positions one interval apart, so that their errors count as much as those of the step.
double allowed_m(const RecordedStep& step, double step_s, double way_m) {
    const double sigma_m = 2.0 * std::sqrt(variance(*step.from) + variance(*step.to));
    return coverage * sigma_m + craft_acceleration_m_s2 * step_s * step_s / 2.0 + way_m / 4.0;
}

Eigen::Vector3d mean_velocity(const RecordedStep& step) {
    if (!step.before) return *step.after;
    return step.after ? Eigen::Vector3d((*step.before + *step.after) / 2.0) : *step.before;
}

}  // namespace

double least_displacement_m(double speed_m_s, double time_s) {
    const double a = craft_acceleration_m_s2, within_s = std::abs(time_s);
    const bool can_stop = 2.0 * speed_m_s <= a * within_s;
    return can_stop ? speed_m_s * speed_m_s / a
                    : speed_m_s * within_s - a * within_s * within_s / 4.0;
}

double seconds_between(const EnuEpoch& earlier, const EnuEpoch& later) {
    // In integers the difference of stamps centuries apart would overflow.
    return (static_cast<double>(later.time.nanoseconds) -
            static_cast<double>(earlier.time.nanoseconds)) *
           1e-9;
}

std::optional<Eigen::Vector3d> velocity_between(const EnuEpoch& from, const EnuEpoch& to,
                                                double longest_s) {
    const double step_s = seconds_between(from, to);
    if (!is_located(from) || !is_located(to) || step_s <= 0.0 || step_s > longest_s)
        return std::nullopt;
    return displacement(from, to) / step_s;
}

bool continues(const RecordedStep& step, double step_s) {
    if (!is_located(*step.from) || !is_located(*step.to) || (!step.before && !step.after))
        return false;
    const Eigen::Vector3d way = mean_velocity(step) * step_s;
    return (displacement(*step.from, *step.to) - way).norm() <= allowed_m(step, step_s, way.norm());
}

bool clock_jumped(const RecordedStep& step, double stamped_s, double interval_s) {
    if (!step.before || !step.after || !continues(step, interval_s)) return false;
    const double noise_m = coverage * 2.0 * std::sqrt(variance(*step.from) + variance(*step.to));
    const double speed_m_s =
        std::min(step.before->norm(), step.after->norm()) - noise_m / interval_s;
    if (speed_m_s <= 0.0) return false;
    const double way_m = mean_velocity(step).norm() * interval_s;
    return least_displacement_m(speed_m_s, stamped_s) >
           way_m + 2.0 * (noise_m + craft_acceleration_m_s2 * interval_s * interval_s / 2.0);
}

}  // namespace runcert
