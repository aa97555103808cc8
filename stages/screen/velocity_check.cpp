#include "stages/screen/velocity_check.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "schemas/enu/measured_position.h"
#include "stages/screen/witness_check.h"
#include "witness/arcs.h"
#include "witness/copies.h"
#include "witness/recorded_velocities.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

using namespace velocities;

/// Upper limit of the error of recorded velocities from epoch to epoch (m/s, each axis). Receivers
/// of all types showed 0.02 to 0.18. Larger differences contradict the positions and are not taken
/// for noise of the velocities.
constexpr double largest_scale_m_s = 0.5;
/// A lasting error of the velocities too small to be a drift of the positions.
constexpr double lasting_m_s = 0.01;
/// Beyond the delay, the velocities are interpolated from one sample more.
constexpr double sample_s = 0.5;

/// The smoothed motion at the rows of the arcs, and the usable ones with a recorded velocity.
struct Gathered {
    Knots smoothed;
    std::vector<Comparison> comparisons;
};

Gathered gather(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                const Directions& directions, const std::vector<bool>& left_out) {
    Gathered gathered;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].arc || !motion[i]) continue;
        gathered.smoothed.push_back({.row = i,
                                     .arc = *rows[i].arc,
                                     .time_s = rows[i].time.seconds(),
                                     .velocity = motion[i]->velocity,
                                     .acceleration = motion[i]->acceleration});
        const auto recorded = recorded_velocity<2>(rows[i], directions[i]);
        if (rows[i].usable && recorded && !left_out[i])
            gathered.comparisons.push_back({gathered.smoothed.size() - 1, *recorded});
    }
    return gathered;
}

/// A recorded velocity beside the smoothed one of its moment, m/s.
struct BothVelocities {
    Eigen::Vector2d recorded, smoothed;
};

std::vector<BothVelocities> both_velocities(const Gathered& gathered, const Delay& delay) {
    std::vector<BothVelocities> both;
    for (const Comparison& one : gathered.comparisons) {
        const double time_s = gathered.smoothed[one.knot].time_s - delay.delay_s.value_or(0.0);
        if (const auto at = motion_at(gathered.smoothed, one.knot, time_s))
            both.push_back({one.recorded, at->velocity});
    }
    return both;
}

/// Scale of the differences of recorded and smoothed velocities, m/s on each axis.
double scale_of_differences(const std::vector<BothVelocities>& all) {
    std::vector<double> squares;
    for (const BothVelocities& both : all)
        squares.push_back((both.recorded - both.smoothed).squaredNorm());
    return scale_of(median(std::move(squares)), 0.5);
}

Directions directions_of(const Motion& motion) {
    Directions directions(motion.size());
    for (std::size_t i = 0; i < motion.size(); ++i)
        if (motion[i])
            directions[i] = direction_of(motion[i]->velocity, motion[i]->velocity_covariance);
    return directions;
}

/// Whether the velocities were computed from the positions recorded with them.
VelocityOrigin origin_of(const std::vector<ScreenedEpoch>& rows, const Directions& directions,
                         double position_resolution_m) {
    std::vector<TimedPosition<2>> positions;
    std::vector<TimedValue> speeds;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const ScreenedEpoch& row = rows[i];
        if (!row.east_m || !row.north_m || is_out_of_time(row)) continue;
        const double time_s = row.time.seconds();
        positions.push_back({.time_s = time_s, .position = measured_position<2>(row)});
        if (row.recorded_speed_m_s)
            speeds.push_back({time_s, *row.recorded_speed_m_s});
        else if (const auto velocity = recorded_velocity<2>(row, directions[i]))
            speeds.push_back({time_s, velocity->norm()});
    }
    return made_from(speeds, positions, 0.0, position_resolution_m);
}

/// Standard deviation of the rounding of the recorded velocities, seen in their lengths or parts.
double rounding_m_s(const std::vector<ScreenedEpoch>& rows) {
    std::vector<TimedValue> lengths, parts;
    for (const ScreenedEpoch& row : rows) {
        const double time_s = row.time.seconds();
        if (const auto speed = recorded_speed(row, true, false))
            lengths.push_back({time_s, speed->speed_m_s});
        for (const auto& part : {row.recorded_velocity_east_m_s, row.recorded_velocity_north_m_s})
            if (part) parts.push_back({time_s, *part});
    }
    return rectangular_uncertainty(0.5 * std::max(resolution_m_s(lengths), resolution_m_s(parts)));
}

bool is_speed_only(const std::vector<ScreenedEpoch>& rows) {
    return std::ranges::none_of(
        rows, [](const ScreenedEpoch& row) { return row.recorded_velocity_east_m_s.has_value(); });
}

/// The delay as it is over spans of seconds: a filter's lag varies with the motion.
Delay over_spans(Delay delay) {
    constexpr double of_motion = 0.25;
    delay.sigma_s = std::hypot(delay.sigma_s, of_motion * delay.delay_s.value_or(0.0));
    return delay;
}

/// The velocities as a witness, with only the delay and what lasts in their errors. Empty if there
/// are none.
template <int Axes>
std::optional<VelocityWitness<Axes>> undisturbed_witness(const std::vector<ScreenedEpoch>& rows,
                                                         const Directions& directions,
                                                         const Delay& delay,
                                                         const std::vector<bool>& left_out,
                                                         const VelocityCheckOptions& options) {
    auto samples = timed_velocities<Axes>(rows, directions, options.nominal_interval_s, left_out);
    if (samples.size() < least_comparisons) return std::nullopt;
    VelocityErrorModel delay_alone;
    delay_alone.delay_s = delay.delay_s.value_or(0.0);
    delay_alone.sigma_delay_s = delay.sigma_s;
    delay_alone.density = 0.0;
    delay_alone.shown_m_s = lasting_m_s;
    return VelocityWitness<Axes>(std::move(samples), delay_alone, options.jerk_density);
}

/// `scale_m_s` is that of the differences from the smoothed velocities, on each horizontal axis.
/// Where nothing else limits the errors, they are assumed to be all of it, and to last.
template <int Axes>
std::optional<VelocityErrors> errors_of(const VelocityWitness<Axes>& witness,
                                        const std::vector<ScreenedEpoch>& rows, double scale_m_s) {
    const EstimatedVelocityErrors<Axes> estimated = estimate_velocity_errors<Axes>(
        witness, timed_positions<Axes>(rows), stated_velocity_sigma<Axes>(rows));
    VelocityErrorModel model = estimated.model;
    // Satellites determine vertical velocity half as well.
    constexpr double upwards = 2.0;
    if (!model.is_known() && scale_m_s > 0.0 && scale_m_s <= largest_scale_m_s)
        model.stated_m_s = Axes == 1 ? upwards * scale_m_s : scale_m_s;
    if (!model.is_known()) return std::nullopt;
    VelocityErrors errors;
    errors.axes = tested_axes<Axes>;
    errors.speed_only = Axes == 2 && is_speed_only(rows);
    errors.delay_s = model.delay_s;
    errors.sigma_delay_s = model.sigma_delay_s;
    if (std::isfinite(model.density)) errors.density = model.density;
    if (model.stated_m_s) errors.stated_m_s = *model.stated_m_s;
    errors.shown_m_s = model.shown_m_s;
    errors.correlation_time_s = model.correlation_time_s;
    errors.spreads.assign(estimated.spreads.begin(), estimated.spreads.end());
    return errors;
}

/// Whether the motion has a similar speed within a second and a half of a row.
bool motion_has(const std::vector<ScreenedEpoch>& rows, const Motion& motion, std::size_t at,
                double speed_m_s) {
    constexpr double near_s = 1.5;
    constexpr double largest_error_m_s = 1.0;  // twice what receivers showed
    constexpr double coverage = 3.0;
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    const auto add_epoch = [&](std::size_t i) {
        if (std::abs(rows[i].time.seconds() - rows[at].time.seconds()) > near_s) return false;
        if (!rows[i].arc || !motion[i]) return true;
        const double by_positions = motion[i]->velocity.norm();
        const double error =
            largest_error_m_s + coverage * std::sqrt(motion[i]->velocity_covariance.trace());
        least = std::min(least, by_positions - error);
        most = std::max(most, by_positions + error);
        return true;
    };
    for (std::size_t i = at; i < rows.size() && add_epoch(i); ++i) {
    }
    for (std::size_t i = at; i-- > 0 && add_epoch(i);) {
    }
    return speed_m_s >= least && speed_m_s <= most;
}

/// The delays along the recording of the recorded speeds, with or without a course, relative to the
/// smoothed motion (`velocities::delays_along`). Each says whether it is beyond `delay_max_s`, or
/// one second if that is longer. `motion` has one element for each row.
std::vector<VelocityDelay> velocity_delays(const std::vector<ScreenedEpoch>& rows,
                                           const Motion& motion, double delay_max_s) {
    std::vector<SpeedPair> pairs;
    std::vector<std::int64_t> epochs;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const ScreenedEpoch& row = rows[i];
        if (is_out_of_time(row)) continue;
        SpeedPair& pair = pairs.emplace_back();
        pair.time_s = row.time.seconds();
        if (const auto speed = recorded_speed(row, true, false))
            pair.recorded_m_s = speed->speed_m_s;
        if (row.arc && motion[i]) pair.by_positions_m_s = motion[i]->velocity.norm();
        epochs.push_back(row.epoch);
    }
    // However small the delay to be removed, one of up to a second does not count as another
    // moment.
    const double limit_s = std::max(delay_max_s, 1.0);
    std::vector<VelocityDelay> delays;
    for (const DelayStretch& one : delays_along(pairs, limit_s))
        delays.push_back({.first_epoch = epochs[one.first],
                          .last_epoch = epochs[one.last],
                          .delay_s = one.delay_s,
                          .sigma_s = one.sigma_s,
                          .difference_m_s = one.difference_m_s,
                          .difference_within_m_s = one.difference_within_m_s,
                          .beyond = one.is_beyond(limit_s)});
    return delays;
}

/// Fraction of the rows with a recorded velocity that are chosen. 0 if there are none.
double share_of(const std::vector<ScreenedEpoch>& rows, const std::vector<bool>& chosen) {
    double all = 0.0, those = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!recorded_speed(rows[i], true, false)) continue;
        all += 1.0;
        those += chosen[i] ? 1.0 : 0.0;
    }
    return all > 0.0 ? those / all : 0.0;
}

/// Fraction of the rows with a recorded velocity that contradict the motion. Rows of other moments
/// and rows marked for their velocity do. So do rows whose speed lies outside the range of the
/// smoothed speeds within 1.5 s. That range is widened by 3 standard deviations and by twice what
/// receivers showed. Rows without known motion count only if they contradict it.
double contradicted_share(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                          const std::vector<bool>& of_other_moments) {
    double all = 0.0, contradicted = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto speed = recorded_speed(rows[i], true, false);
        const bool found = of_other_moments[i] || rows[i].reason == Reason::velocity;
        if (!speed || !(found || (rows[i].arc && motion[i]))) continue;
        all += 1.0;
        contradicted += found || !motion_has(rows, motion, i, speed->speed_m_s) ? 1.0 : 0.0;
    }
    return all > 0.0 ? contradicted / all : 0.0;
}

struct Ratio {
    double value = 1.0;
    double standard_uncertainty = 0.0;
};

/// Ratio of the recorded velocities to the smoothed ones, along the motion, where the craft moves
/// at half the speed of its fastest tenth or more. Empty if too few rows do.
std::optional<Ratio> ratio_of(const std::vector<BothVelocities>& all) {
    std::vector<double> speeds, ratios;
    for (const BothVelocities& both : all)
        speeds.push_back(both.smoothed.norm());
    const double least_m_s = std::max(1.0, half_of_fastest_tenth(std::move(speeds)));
    for (const BothVelocities& both : all)
        if (both.smoothed.norm() >= least_m_s)
            ratios.push_back(both.recorded.dot(both.smoothed) / both.smoothed.squaredNorm());
    if (ratios.size() < least_comparisons) return std::nullopt;
    const double ratio = median(ratios);
    for (double& one : ratios)
        one = std::abs(one - ratio);
    // Errors of neighbours are alike, so only every tenth counts as independent.
    const double independent = static_cast<double>(ratios.size()) / 10.0;
    return Ratio{.value = ratio,
                 .standard_uncertainty = 1.2533 * median(std::move(ratios)) /
                                         normal_quantile(0.75) / std::sqrt(independent)};
}

}  // namespace

VelocityFindings check_velocities(std::vector<ScreenedEpoch>& rows, const Motion& motion,
                                  const VelocityCheckOptions& options) {
    assert(rows.size() == motion.size());
    const Directions directions = directions_of(motion);
    VelocityFindings findings;
    const auto recorded = std::ranges::count_if(rows, [](const ScreenedEpoch& row) {
        return recorded_speed(row, true, false).has_value();
    });
    if (recorded < static_cast<std::ptrdiff_t>(least_comparisons)) return findings;
    VelocityComparison& comparison = findings.comparison.emplace();
    std::vector<bool> left_out(rows.size(), false);
    const auto judge = [&] {
        comparison.contradicted_share = contradicted_share(rows, motion, left_out);
        comparison.unfit = comparison.contradicted_share > options.share_max;
    };
    judge();
    if (!recorded_velocities_change(rows)) return findings;
    comparison.origin = origin_of(rows, directions, options.position_resolution_m);
    if (comparison.origin == VelocityOrigin::positions) {
        comparison.unfit = false;
        return findings;
    }

    comparison.delays = velocity_delays(rows, motion, options.delay_max_s);
    left_out = velocities_of_other_moments(rows, comparison);
    const double of_other_moments = share_of(rows, left_out);
    judge();
    left_out = velocities_left_out(rows, comparison, false);
    const Gathered gathered = gather(rows, motion, directions, left_out);
    const Delay delay = estimate_delay(gathered.smoothed, motion, gathered.comparisons,
                                       options.delay_max_s, options.nominal_interval_s);
    const std::vector<BothVelocities> compared = both_velocities(gathered, delay);
    if (compared.size() < least_comparisons) return findings;
    const Delay wandering = over_spans(delay);
    const auto steady = undisturbed_witness<2>(rows, directions, delay, left_out, options);
    const auto undisturbed = undisturbed_witness<2>(rows, directions, wandering, left_out, options);
    if (undisturbed && made_from(*undisturbed, rounding_m_s(rows), options.nominal_interval_s,
                                 timed_positions<2>(rows))) {
        comparison.origin = VelocityOrigin::positions;
        comparison.unfit = false;
        return findings;
    }
    if (const auto ratio = ratio_of(compared)) {
        comparison.ratio = ratio->value;
        comparison.sigma_ratio = ratio->standard_uncertainty;
    }
    comparison.compared = std::ssize(compared);
    comparison.scale_m_s = scale_of_differences(compared);
    comparison.delay_s = delay.delay_s;
    if (delay.delay_s) comparison.sigma_delay_s = delay.sigma_s;
    const double delay_s = delay.delay_s.value_or(0.0);
    if (undisturbed) {
        comparison.rejected =
            check_displacements(rows,
                                {.kind = WitnessKind::velocities,
                                 .witness = &*undisturbed,
                                 .over_intervals = &*steady,
                                 .motion = &motion,
                                 .lag_s = delay_s + std::copysign(sample_s, delay_s),
                                 .adds_stated = true},
                                options.nominal_interval_s, options.test_size)
                .rejected;
        if (auto errors = errors_of<2>(*undisturbed, rows, comparison.scale_m_s))
            findings.errors.push_back(std::move(*errors));
    }
    if (options.vertical_measured)
        if (const auto witness =
                undisturbed_witness<1>(rows, directions, wandering, left_out, options))
            if (auto errors = errors_of<1>(*witness, rows, comparison.scale_m_s))
                findings.errors.push_back(std::move(*errors));
    left_out = velocities_of_other_moments(rows, comparison);
    judge();
    if (of_other_moments > options.share_max) findings.errors.clear();
    return findings;
}

}  // namespace runcert
