#include "stages/screen/epoch_checks.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "witness/continuity.h"

namespace runcert {
namespace {

/// m; the extent that a local frame serves
constexpr double farthest_m = 100'000.0;

struct Finding {
    Reason reason;
    std::optional<double> statistic;
    std::optional<double> threshold;
};

std::optional<Finding> check_fix(const ScreenedEpoch& row, const ScreenConfig& config) {
    if (row.fix == FixType::none) return Finding{Reason::no_fix, {}, {}};
    if (config.counted_fixes.contains(counted_as(row.fix))) return std::nullopt;
    return Finding{
        row.fix == FixType::float_ambiguities ? Reason::float_ambiguities : Reason::other_fix,
        {},
        {}};
}

double median_of(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

/// East and north of the median of all positions.
Eigen::Vector2d middle_of(const std::vector<ScreenedEpoch>& rows) {
    std::vector<double> east, north;
    for (const ScreenedEpoch& row : rows) {
        if (!row.east_m || !row.north_m || row.fix == FixType::none) continue;
        east.push_back(*row.east_m);
        north.push_back(*row.north_m);
    }
    if (east.empty()) return Eigen::Vector2d::Zero();
    return Eigen::Vector2d(median_of(std::move(east)), median_of(std::move(north)));
}

/// A position half the Earth away would lose all digits in the tests below.
std::optional<Finding> check_place(const ScreenedEpoch& row, const Eigen::Vector2d& place) {
    const double distance_m = (Eigen::Vector2d(*row.east_m, *row.north_m) - place).norm();
    if (distance_m <= farthest_m) return std::nullopt;
    return Finding{Reason::far_position, distance_m, farthest_m};
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
    // No error has a correlation matrix that is not positive definite.
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

/// The solution's own quality figures other than its standard deviations. Zero means that the field
/// was not filled.
std::optional<Finding> check_witnesses(const ScreenedEpoch& row, const ScreenConfig& config) {
    if (row.satellites && *row.satellites > 0 && *row.satellites < config.satellites_min)
        return Finding{Reason::few_satellites, static_cast<double>(*row.satellites),
                       static_cast<double>(config.satellites_min)};
    if (row.fix == FixType::fixed && row.ratio && *row.ratio > 0.0 && *row.ratio < config.ratio_min)
        return Finding{Reason::low_ratio, *row.ratio, config.ratio_min};
    if (row.age_s && std::abs(*row.age_s) > config.correction_age_max_s)
        return Finding{Reason::old_corrections, *row.age_s, config.correction_age_max_s};
    return std::nullopt;
}

std::optional<Finding> check_time(TimeStanding standing, std::optional<double> step_s) {
    switch (standing) {
        case TimeStanding::in_order:
            return std::nullopt;
        case TimeStanding::repeated:
            return Finding{Reason::repeated, {}, {}};
        case TimeStanding::same_time:
            return Finding{Reason::duplicate_time, 0.0, 0.0};
        case TimeStanding::out_of_order:
            break;
    }
    return Finding{Reason::backward_time, step_s, 0.0};
}

}  // namespace

void check_epochs(std::vector<ScreenedEpoch>& rows, const std::vector<TimeStanding>& standing,
                  bool vertical, const ScreenConfig& config,
                  const std::optional<FrameOrigin>& origin) {
    const Eigen::Vector2d middle = origin ? Eigen::Vector2d::Zero() : middle_of(rows);
    const auto place_of = [&](const ScreenedEpoch& row) -> Eigen::Vector2d {
        if (!origin) return middle;
        const FramePlace place = origin->place_at(row.time);
        return {place.east_m, place.north_m};
    };
    const ScreenedEpoch* in_order = nullptr;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        ScreenedEpoch& row = rows[i];
        std::optional<double> step_s;
        if (in_order != nullptr) step_s = seconds_between(*in_order, row);
        if (standing[i] == TimeStanding::in_order) in_order = &row;
        std::optional<Finding> finding = check_time(standing[i], step_s);
        if (!finding) finding = check_fix(row, config);
        if (!finding && (!row.east_m || !row.north_m || (vertical && !row.up_m)))
            finding = Finding{Reason::no_position, {}, {}};
        if (!finding) finding = check_place(row, place_of(row));
        if (!finding) finding = check_accuracy(row, vertical, config);
        if (!finding) finding = check_witnesses(row, config);
        row.usable = !finding;
        row.reason = finding ? finding->reason : Reason::none;
        row.statistic = finding ? finding->statistic : std::nullopt;
        row.threshold = finding ? finding->threshold : std::nullopt;
    }
}

void number_arcs(std::vector<ScreenedEpoch>& rows, const std::vector<bool>& seam,
                 double nominal_interval_s, const ScreenConfig& config) {
    const double longest_step_s = config.bridged_s(nominal_interval_s);
    const ScreenedEpoch* previous = nullptr;
    bool apart = false;
    int out_of_order = 0;
    std::int64_t arc = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        ScreenedEpoch& row = rows[i];
        row.arc.reset();
        row.break_before.reset();
        apart = apart || seam[i];
        if (row.reason == Reason::backward_time) ++out_of_order;
        if (!row.usable) continue;
        if (!previous) {
            row.break_before = ArcBreak::start;
        } else {
            const double step_s = seconds_between(*previous, row);
            // Where more was recorded out of order than there is room for, the stamps do not
            // determine how long that took.
            const bool no_room =
                out_of_order > 1 && step_s < (out_of_order + 0.5) * nominal_interval_s;
            if (step_s > longest_step_s || no_room || apart) row.break_before = ArcBreak::gap;
        }
        if (row.break_before) ++arc;
        row.arc = arc;
        previous = &row;
        out_of_order = 0;
        apart = false;
    }
}

}  // namespace runcert
