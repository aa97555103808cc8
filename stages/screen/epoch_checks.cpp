#include "stages/screen/epoch_checks.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

namespace runcert {
namespace {

struct Finding {
    Reason reason;
    std::optional<double> statistic;
    std::optional<double> threshold;
};

std::optional<Finding> check_fix(const ScreenedEpoch& row, const ScreenConfig& config) {
    if (row.fix == FixKind::none) return Finding{Reason::no_fix, {}, {}};
    if (config.allowed_fixes.contains(row.fix)) return std::nullopt;
    return Finding{
        row.fix == FixKind::float_ambiguities ? Reason::float_ambiguities : Reason::other_fix,
        {},
        {}};
}

std::optional<Finding> check_accuracy(const ScreenedEpoch& row, bool vertical,
                                      const ScreenConfig& config) {
    if (!row.sigma_east_m || !row.sigma_north_m || (vertical && !row.sigma_up_m))
        return Finding{Reason::accuracy_missing, {}, {}};
    std::vector<double> sigmas{*row.sigma_east_m, *row.sigma_north_m};
    if (vertical) sigmas.push_back(*row.sigma_up_m);
    const auto [smallest, largest] = std::minmax_element(sigmas.begin(), sigmas.end());
    if (*smallest < config.accuracy_min_m)
        return Finding{Reason::accuracy_absurd, *smallest, config.accuracy_min_m};
    if (*largest > config.accuracy_max_m)
        return Finding{Reason::accuracy_absurd, *largest, config.accuracy_max_m};
    // A correlation matrix that is not positive definite belongs to no error.
    Eigen::Matrix3d correlation = Eigen::Matrix3d::Identity();
    correlation(1, 0) = row.correlation_east_north.value_or(0.0);
    if (vertical) {
        correlation(2, 0) = row.correlation_east_up.value_or(0.0);
        correlation(2, 1) = row.correlation_north_up.value_or(0.0);
    }
    const double determinant_limit = 1e-9;
    const Eigen::LLT<Eigen::Matrix3d> factor(correlation);
    const double determinant =
        factor.info() == Eigen::Success ? std::pow(factor.matrixLLT().diagonal().prod(), 2) : 0.0;
    if (determinant < determinant_limit)
        return Finding{Reason::accuracy_absurd, determinant, determinant_limit};
    return std::nullopt;
}

}  // namespace

void check_epochs(std::vector<ScreenedEpoch>& rows, bool vertical, const ScreenConfig& config) {
    std::optional<ElapsedTime> latest;
    for (ScreenedEpoch& row : rows) {
        std::optional<Finding> finding;
        if (latest && row.time <= *latest)
            finding = Finding{row.time == *latest ? Reason::duplicate_time : Reason::backward_time,
                              row.time.seconds() - latest->seconds(), 0.0};
        else
            latest = row.time;
        if (!finding) finding = check_fix(row, config);
        if (!finding && (!row.east_m || !row.north_m || (vertical && !row.up_m)))
            finding = Finding{Reason::no_position, {}, {}};
        if (!finding) finding = check_accuracy(row, vertical, config);
        row.usable = !finding;
        row.reason = finding ? finding->reason : Reason::none;
        row.statistic = finding ? finding->statistic : std::nullopt;
        row.threshold = finding ? finding->threshold : std::nullopt;
    }
}

void number_arcs(std::vector<ScreenedEpoch>& rows, double nominal_interval_s,
                 const ScreenConfig& config) {
    const double longest_step_s = config.gap_factor * nominal_interval_s;
    const ScreenedEpoch* previous = nullptr;
    std::int64_t arc = 0;
    for (ScreenedEpoch& row : rows) {
        row.arc.reset();
        row.break_before.reset();
        if (!row.usable) continue;
        if (!previous)
            row.break_before = ArcBreak::start;
        else if (row.time.seconds() - previous->time.seconds() > longest_step_s)
            row.break_before = ArcBreak::gap;
        if (row.break_before) ++arc;
        row.arc = arc;
        previous = &row;
    }
}

}  // namespace runcert
