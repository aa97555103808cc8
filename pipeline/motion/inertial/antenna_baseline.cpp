#include "inertial/antenna_baseline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/angle.h"
#include "core/statistics.h"

namespace runcert {
namespace {

constexpr double least_across_m = 0.3;
constexpr double useful_heading_rad = 15.0 * radians_per_degree;

/// Of the difference of two receivers' positions, each with its own error.
double slow_sigma_m(const PositionErrorModel& error) {
    return std::numbers::sqrt2 * error.horizontal_m;
}

/// Whether the direction from antenna to antenna shows a heading: far enough apart, and their
/// heights no more than twice as far.
bool shows_heading(const AntennaBaseline& baseline) {
    const double across_m = baseline.body_m.head<2>().norm();
    return across_m >= std::max(least_across_m, 0.5 * std::abs(baseline.body_m.z()));
}

/// The mean of angles, also about the half turn, -pi to pi.
double mean_angle(const std::vector<double>& angles) {
    double sine = 0.0, cosine = 0.0;
    for (const double angle : angles) {
        sine += std::sin(angle);
        cosine += std::cos(angle);
    }
    return std::atan2(sine, cosine);
}

/// The variance of the mean of white errors of these variances.
double variance_of_mean(const std::vector<double>& variances) {
    const double count = static_cast<double>(variances.size());
    return std::reduce(variances.begin(), variances.end()) / (count * count);
}

/// The part of a Gauss-Markov error's variance that remains in its mean over a time.
double remaining(const PositionErrorModel& error, double duration_s) {
    const double spans = duration_s / error.time_s;
    return spans < 1e-6 ? 1.0 : 2.0 / spans * (1.0 + std::expm1(-spans) / spans);
}

double variance_along(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& unit) {
    return unit.dot(covariance * unit);
}

/// Level and at right angles to a vector, to the right of it.
Eigen::Vector3d right_of(const Eigen::Vector3d& vector) {
    return Eigen::Vector3d(vector.y(), -vector.x(), 0.0).normalized();
}

/// The mean of fixes, its standard deviation from side to side, and the length's.
struct MeanFix {
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    double across_sigma_m = 0.0;
    double up_sigma_m = 0.0;
    Estimated<double> length_m;
};

std::optional<MeanFix> mean_fix(std::span<const BaselineFix> fixes,
                                const PositionErrorModel& error) {
    if (fixes.empty()) return std::nullopt;
    MeanFix mean;
    const double count = static_cast<double>(fixes.size());
    std::vector<double> lengths;
    for (const BaselineFix& fix : fixes) {
        mean.enu_m += fix.enu_m / count;
        lengths.push_back(fix.enu_m.norm());
    }
    std::vector<double> across, up, along;
    for (const BaselineFix& fix : fixes) {
        across.push_back(variance_along(fix.covariance_m2, right_of(mean.enu_m)));
        up.push_back(fix.covariance_m2(2, 2));
        along.push_back(variance_along(fix.covariance_m2, mean.enu_m.normalized()));
    }
    const double part = remaining(error, fixes.back().time_s - fixes.front().time_s);
    const double slow_m = slow_sigma_m(error) * std::sqrt(part);
    const double slow_up_m = std::numbers::sqrt2 * error.vertical_m * std::sqrt(part);
    mean.across_sigma_m = std::hypot(std::sqrt(variance_of_mean(across)), slow_m);
    mean.up_sigma_m = std::hypot(std::sqrt(variance_of_mean(up)), slow_up_m);
    const double steep = std::abs(mean.enu_m.normalized().z());
    mean.length_m = {runcert::mean(lengths),
                     std::hypot(std::sqrt(variance_of_mean(along)),
                                slow_m * std::sqrt(1.0 - steep * steep), slow_up_m * steep)};
    return mean;
}

/// The heading by a fix beside the inertial one, by which the second antenna is `expected`.
BaselineHeading heading_at(const InertialEpoch& epoch, const BaselineFix& fix,
                           const Eigen::Vector3d& expected) {
    constexpr double turn = 2.0 * std::numbers::pi;
    const double difference_rad = std::remainder(
        std::atan2(fix.enu_m.x(), fix.enu_m.y()) - std::atan2(expected.x(), expected.y()), turn);
    const double heading = epoch.attitude.heading + difference_rad;
    return {.time_s = epoch.time_s,
            .heading_rad = heading - turn * std::floor(heading / turn),
            .sigma_rad = std::sqrt(variance_along(fix.covariance_m2, right_of(expected))) /
                         expected.head<2>().norm(),
            .difference_rad = difference_rad};
}

}  // namespace

bool is_stated_length(const AntennaBaseline& baseline, const Estimated<double>& length_m) {
    const double sigma_m = std::hypot(length_m.sigma, baseline.body_sigma_m);
    return std::abs(length_m.value - baseline.body_m.norm()) <= 3.0 * sigma_m;
}

std::optional<DirectionPair> direction_of(const AntennaBaseline& baseline, double from_s,
                                          double to_s, const DirectionPair& gravity,
                                          const PositionErrorModel& error) {
    const auto begin = std::ranges::lower_bound(baseline.fixes, from_s, {}, &BaselineFix::time_s);
    const auto end = std::ranges::upper_bound(baseline.fixes, to_s, {}, &BaselineFix::time_s);
    if (end <= begin || !shows_heading(baseline)) return std::nullopt;
    const auto fix = mean_fix({begin, end}, error);
    const double across_m = fix->enu_m.head<2>().norm();
    const double across_sigma_m = std::hypot(fix->across_sigma_m, baseline.body_sigma_m);
    if (across_m < least_across_m || !is_stated_length(baseline, fix->length_m) ||
        across_sigma_m >= useful_heading_rad * across_m)
        return std::nullopt;
    const double length_m = fix->length_m.value;
    const double up_sigma_rad = std::hypot(fix->up_sigma_m, baseline.body_sigma_m) / length_m;
    const double tilt_sigma_rad = std::sqrt(2.0 / gravity.information.trace());
    const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return std::atan2(a.cross(b).norm(), a.dot(b));
    };
    if (std::abs(angle(gravity.body, baseline.body_m) - angle(gravity.enu, fix->enu_m)) >
        3.0 * std::hypot(tilt_sigma_rad, up_sigma_rad))
        return std::nullopt;
    const Eigen::Vector3d right = right_of(fix->enu_m);
    return DirectionPair{baseline.body_m, fix->enu_m,
                         information_about(right.cross(fix->enu_m), across_sigma_m / length_m) +
                             information_about(right, up_sigma_rad)};
}

std::optional<BaselineJudgement> judge_baseline(const InertialSolution& solution,
                                                const AntennaBaseline& baseline,
                                                const PositionErrorModel& error) {
    const auto measured = mean_fix(baseline.fixes, error);
    if (!measured || !shows_heading(baseline)) return std::nullopt;
    BaselineJudgement judgement{.length_m = measured->length_m};
    std::vector<double> differences, variances, inertial, across;
    auto fix = baseline.fixes.begin();
    for (const InertialEpoch& epoch : solution.epochs) {
        constexpr double same_instant_s = 1e-6;
        while (fix != baseline.fixes.end() && fix->time_s < epoch.time_s - same_instant_s)
            ++fix;
        if (fix == baseline.fixes.end()) break;
        if (fix->time_s > epoch.time_s + same_instant_s) continue;
        const Eigen::Vector3d expected = epoch.enu_from_body * baseline.body_m;
        const double across_m = expected.head<2>().norm();
        if (across_m < 0.5 * least_across_m) continue;
        const BaselineHeading& one =
            judgement.headings.emplace_back(heading_at(epoch, *fix, expected));
        differences.push_back(one.difference_rad);
        variances.push_back(one.sigma_rad * one.sigma_rad);
        across.push_back(across_m);
        const double tilt = std::hypot(epoch.attitude_sigma.roll, epoch.attitude_sigma.pitch);
        inertial.push_back(
            std::hypot(epoch.attitude_sigma.heading, tilt * expected.z() / across_m));
    }
    if (differences.empty()) return std::nullopt;
    const double duration_s = judgement.headings.back().time_s - judgement.headings.front().time_s;
    const double systematic_m = std::hypot(
        slow_sigma_m(error) * std::sqrt(remaining(error, duration_s)), baseline.body_sigma_m);
    judgement.difference_rad = {mean_angle(differences),
                                std::hypot(std::sqrt(variance_of_mean(variances)),
                                           systematic_m / mean(across), mean(inertial))};
    judgement.agrees =
        std::abs(judgement.difference_rad.value) <= 2.0 * judgement.difference_rad.sigma;
    return judgement;
}

}  // namespace runcert
