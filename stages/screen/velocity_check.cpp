#include "stages/screen/velocity_check.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/statistics.h"
#include "core/uncertainty.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"
#include "stages/screen/velocity_check_delays.h"
#include "stages/screen/witness_check.h"
#include "witness/copies.h"
#include "witness/recorded_velocities.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using namespace velocities;

/// Neighbours on either side that determine a local scale, and over which an outlier may have bent
/// the smoothed motion.
constexpr std::size_t neighbours = 10;
constexpr std::size_t least_neighbours = 8;
/// Upper limit of the error of recorded velocities from epoch to epoch (m/s, each axis). Receivers
/// of all types showed 0.02 to 0.18. Larger differences contradict the positions and are not taken
/// for noise of the velocities.
constexpr double largest_scale_m_s = 0.5;

/// A recorded velocity minus another one at a row (m/s), the known variance without the recorded
/// velocity's part, and the resulting test statistic.
struct Difference {
    std::size_t row = 0;
    std::int64_t arc = 0;
    Vector2d value = Vector2d::Zero();
    Matrix2d known = Matrix2d::Zero();
    double statistic = 0.0;
};
using Differences = std::vector<Difference>;

/// Data gathered from the tables. `comparisons` and `recorded` belong to the same rows.
struct Gathered {
    Knots smoothed;
    std::vector<Comparison> comparisons;
    Knots recorded;
};

/// The recorded velocity at a time in the arc, interpolated linearly between epochs.
std::optional<Vector2d> recorded_at(const Knots& recorded, std::size_t near, double time_s) {
    const auto before = knot_before(recorded, near, time_s);
    if (!before) return std::nullopt;
    const Knot &a = recorded[*before], &b = recorded[*before + 1];
    return a.velocity + (time_s - a.time_s) / (b.time_s - a.time_s) * (b.velocity - a.velocity);
}

/// The variance caused by an uncertain delay, from the change of the recorded velocity over it. An
/// undetermined delay counts as the largest. That costs little if the velocity hardly changes, as
/// is then usual. If it does change, the comparison loses weight by itself. The smoothed
/// acceleration is unsuitable: an outlier makes it large, and would excuse itself.
Matrix2d delay_variance(const Knots& recorded, std::size_t k, const Delay& delay) {
    const Knot& knot = recorded[k];
    const auto before = recorded_at(recorded, k, knot.time_s - delay.sigma_s);
    const auto after = recorded_at(recorded, k, knot.time_s + delay.sigma_s);
    const Vector2d change = 0.5 * (after.value_or(knot.velocity) - before.value_or(knot.velocity));
    return change * change.transpose();
}

/// Recorded minus smoothed velocities.
Differences smoothed_differences(const Gathered& gathered, const Delay& delay) {
    Differences differences;
    for (std::size_t k = 0; k < gathered.recorded.size(); ++k) {
        const Knot& recorded = gathered.recorded[k];
        const auto at = motion_at(gathered.smoothed, gathered.comparisons[k].knot,
                                  recorded.time_s - delay.delay_s.value_or(0.0));
        if (!at) continue;
        differences.push_back(
            {.row = recorded.row,
             .arc = recorded.arc,
             .value = recorded.velocity - at->velocity,
             .known = at->covariance + delay_variance(gathered.recorded, k, delay)});
    }
    return differences;
}

/// Mean recorded velocities minus displacement over interval, for each step between compared rows.
/// The mean is over both ends of the step, each taken a delay later. The row is the step's second.
Differences displacement_differences(const std::vector<ScreenedEpoch>& rows, const Knots& recorded,
                                     const Delay& delay) {
    Differences differences;
    const double delay_s = delay.delay_s.value_or(0.0);
    for (std::size_t k = 1; k < recorded.size(); ++k) {
        const Knot &a = recorded[k - 1], &b = recorded[k];
        const auto from = recorded_at(recorded, k - 1, a.time_s + delay_s);
        const auto to = recorded_at(recorded, k, b.time_s + delay_s);
        if (a.arc != b.arc || !from || !to) continue;
        const double dt_s = b.time_s - a.time_s;
        const Vector2d moved =
            measured_position<2>(rows[b.row]) - measured_position<2>(rows[a.row]);
        const Matrix2d stated =
            stated_covariance<2>(rows[a.row]) + stated_covariance<2>(rows[b.row]);
        differences.push_back(
            {.row = b.row,
             .arc = b.arc,
             .value = 0.5 * (*from + *to) - moved / dt_s,
             .known = stated / (dt_s * dt_s) + delay_variance(recorded, k, delay)});
    }
    return differences;
}

/// Scatter around a difference, from the steps between neighbours. A drift of the positions moves
/// many of them alike, and so cannot hide in it. It uses the upper quartile, because in a window at
/// the beginning of a run half of the epochs stand still.
double local_scale(const Differences& differences, std::size_t k) {
    std::vector<double> squares;
    const std::size_t last = std::min(differences.size() - 1, k + neighbours);
    for (std::size_t i = k - std::min(k, neighbours); i < last; ++i)
        if (differences[i].arc == differences[k].arc &&
            differences[i + 1].arc == differences[k].arc)
            squares.push_back(0.5 *
                              (differences[i + 1].value - differences[i].value).squaredNorm());
    if (squares.size() < least_neighbours) return 0.0;
    const auto quartile =
        squares.begin() + static_cast<std::ptrdiff_t>(3 * (squares.size() - 1) / 4);
    std::nth_element(squares.begin(), quartile, squares.end());
    return scale_of(*quartile, 0.75);
}

/// Fills in the statistics and returns the overall scale.
///
/// The variance is the known variance of the other side (larger near the ends of arcs and after
/// gaps), plus the recorded velocity's own: the square of the scale minus the typical known
/// variance. The scale is the larger of the whole recording's and the local one, because no
/// recording observed has a single scale.
///
/// Observed at 1 and 4 Hz: 7 to 8 mm/s standing against 18 to 60 mm/s moving, with tails far
/// heavier than normal. One difference in a hundred was beyond 0.13 m/s where the scale is
/// 0.017 m/s, up to 0.2 m/s alone and 0.3 m/s within a few scattered epochs. With one scale, and
/// without requiring a second epoch that agrees, 33 good epochs of 2187 would be marked. This way
/// none is.
double test_differences(Differences& differences) {
    if (differences.size() < least_comparisons) return 0.0;
    std::vector<double> squares, variances;
    for (const Difference& difference : differences) {
        squares.push_back(difference.value.squaredNorm());
        variances.push_back(0.5 * difference.known.trace());
    }
    const double scale = scale_of(median(std::move(squares)), 0.5);
    const double typical = median(std::move(variances));
    for (std::size_t k = 0; k < differences.size(); ++k) {
        Difference& d = differences[k];
        const double largest = std::min(std::max(scale, local_scale(differences, k)),
                                        std::hypot(largest_scale_m_s, std::sqrt(typical)));
        const double own = std::max(0.0, largest * largest - typical);
        const Matrix2d covariance = d.known + own * Matrix2d::Identity();
        d.statistic = d.value.dot(covariance.inverse() * d.value);
    }
    return scale;
}

/// Whether differences `k` and `k + 1` belong to one arc, both exceed the threshold, and point in
/// the same direction (or in opposite ones).
bool contradict(const Differences& differences, std::size_t k, double threshold, bool opposite) {
    const Difference &a = differences[k], &b = differences[k + 1];
    if (a.arc != b.arc || !(a.statistic > threshold && b.statistic > threshold)) return false;
    return (a.value.dot(b.value) < 0.0) == opposite;
}

void mark(ScreenedEpoch& row, double statistic, double threshold) {
    row.usable = false;
    row.reason = Reason::velocity;
    row.hypothesis = Hypothesis::velocity;
    row.tested_axes = TestedAxes::horizontal;
    row.statistic = statistic;
    row.threshold = threshold;
}

/// Marks the epochs between two displacements that contradict in opposite directions. Returns their
/// rows.
std::vector<std::size_t> mark_displaced(std::vector<ScreenedEpoch>& rows,
                                        const Differences& displacements, double threshold) {
    std::vector<std::size_t> marked;
    for (std::size_t k = 0; k + 1 < displacements.size(); ++k) {
        if (!contradict(displacements, k, threshold, true)) continue;
        const Difference &to = displacements[k], &from = displacements[k + 1];
        mark(rows[to.row], std::min(to.statistic, from.statistic), threshold);
        marked.push_back(to.row);
    }
    return marked;
}

/// Marks both epochs of each pair that contradicts in the same direction, unless an outlier bent
/// the motion.
void mark_drifting(std::vector<ScreenedEpoch>& rows, const Differences& differences,
                   const std::vector<std::size_t>& displaced, double threshold) {
    std::vector<bool> bent(differences.size(), false);
    for (const std::size_t row : displaced)
        for (std::size_t k = 0; k < differences.size(); ++k)
            if (differences[k].row + neighbours >= row && differences[k].row <= row + neighbours)
                bent[k] = true;
    for (std::size_t k = 0; k + 1 < differences.size(); ++k) {
        if (!contradict(differences, k, threshold, false)) continue;
        for (const std::size_t i : {k, k + 1})
            if (!bent[i]) mark(rows[differences[i].row], differences[i].statistic, threshold);
    }
}

Gathered gather(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                const Directions& directions, const std::vector<bool>& left_out) {
    Gathered gathered;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!rows[i].arc || !motion[i]) continue;
        Knot knot{.row = i,
                  .arc = *rows[i].arc,
                  .time_s = rows[i].time.seconds(),
                  .velocity = motion[i]->velocity,
                  .acceleration = motion[i]->acceleration,
                  .covariance = motion[i]->velocity_covariance};
        gathered.smoothed.push_back(knot);
        const auto recorded = recorded_velocity<2>(rows[i], directions[i]);
        if (!rows[i].usable || !recorded || left_out[i]) continue;
        gathered.comparisons.push_back({gathered.smoothed.size() - 1, *recorded});
        knot.velocity = *recorded;
        gathered.recorded.push_back(knot);
    }
    return gathered;
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

/// The velocities as a witness, with only the delay in their errors. Empty if there are none.
template <int Axes>
std::optional<VelocityWitness<Axes>> undisturbed_witness(const std::vector<ScreenedEpoch>& rows,
                                                         const Directions& directions,
                                                         const Delay& delay,
                                                         const std::vector<bool>& left_out,
                                                         const VelocityCheckOptions& options) {
    auto samples = timed_velocities<Axes>(rows, directions, options.nominal_interval_s, left_out);
    if (samples.size() < least_comparisons) return std::nullopt;
    // Uncertainty of the delay. A filter's lag varies with the motion; an undetermined one may lie
    // anywhere in the range.
    constexpr double of_motion = 0.25;
    const double sigma_s = delay.delay_s ? std::hypot(delay.sigma_s, of_motion * *delay.delay_s)
                                         : rectangular_uncertainty(options.delay_max_s);
    VelocityErrorModel delay_alone;
    delay_alone.delay_s = delay.delay_s.value_or(0.0);
    delay_alone.sigma_delay_s = sigma_s;
    delay_alone.density = 0.0;
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
    errors.axes = Axes == 1 ? TestedAxes::vertical : TestedAxes::horizontal;
    errors.speed_only = Axes == 2 && is_speed_only(rows);
    errors.delay_s = model.delay_s;
    errors.sigma_delay_s = model.sigma_delay_s;
    if (std::isfinite(model.density)) errors.density = model.density;
    if (model.stated_m_s) errors.stated_m_s = *model.stated_m_s;
    errors.shown_m_s = model.shown_m_s;
    errors.correlation_time_s = model.correlation_time_s;
    for (const DisplacementSpread& one : estimated.spreads)
        errors.spreads.push_back({.span_s = one.span_s,
                                  .spans = one.spans,
                                  .sd_m = one.sd_m,
                                  .sd_upper_m = one.sd_upper_m});
    return errors;
}

struct Ratio {
    double value = 1.0;
    double standard_uncertainty = 0.0;
};

/// Ratio of the recorded velocities to the smoothed ones, along the motion, where the craft moves
/// at half the speed of its fastest tenth or more. Empty if too few rows do.
std::optional<Ratio> ratio_of(const Gathered& gathered, const Delay& delay) {
    std::vector<double> speeds, ratios;
    for (const Comparison& one : gathered.comparisons)
        speeds.push_back(gathered.smoothed[one.knot].velocity.norm());
    if (speeds.empty()) return std::nullopt;
    const auto tenth = speeds.begin() + std::ssize(speeds) * 9 / 10;
    std::ranges::nth_element(speeds, tenth);
    const double least_m_s = std::max(1.0, 0.5 * *tenth);
    for (std::size_t k = 0; k < gathered.recorded.size(); ++k) {
        const Knot& recorded = gathered.recorded[k];
        const auto at = motion_at(gathered.smoothed, gathered.comparisons[k].knot,
                                  recorded.time_s - delay.delay_s.value_or(0.0));
        if (at && at->velocity.norm() >= least_m_s)
            ratios.push_back(recorded.velocity.dot(at->velocity) / at->velocity.squaredNorm());
    }
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

/// Marks slow drifts and steps, and ends the arc after them.
void mark_drifts(std::vector<ScreenedEpoch>& rows, const VelocityWitness<2>& witness,
                 const VelocityErrors& errors, double threshold) {
    constexpr double longest_s = 10.0;
    constexpr double lasting_m_s = 0.01;
    constexpr double beyond_delay_s = 0.5;
    const UsablePositions usable = usable_positions(rows);
    std::vector<ContradictedSpan> contradicted;
    for (const VelocitySpread& spread : errors.spreads) {
        if (spread.span_s > longest_s) break;
        const auto spans =
            contradicted_spans(usable.positions, witness,
                               {.span_s = spread.span_s,
                                .spread_m = spread.sd_upper_m,
                                .lasting_m_s = lasting_m_s,
                                // The witness is used at the delay, and one sample beyond.
                                .ahead_s = std::max(0.0, witness.errors().delay_s) + beyond_delay_s,
                                .threshold = threshold});
        contradicted.insert(contradicted.end(), spans.begin(), spans.end());
    }
    mark_spans(rows, usable, contradicted, witness_entry(WitnessKind::velocities).screening.value(),
               threshold);
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
    Differences differences = smoothed_differences(gathered, delay);
    if (differences.size() < least_comparisons) return findings;
    const auto undisturbed = undisturbed_witness<2>(rows, directions, delay, left_out, options);
    if (undisturbed && made_from(*undisturbed, rounding_m_s(rows), options.nominal_interval_s,
                                 timed_positions<2>(rows))) {
        comparison.origin = VelocityOrigin::positions;
        comparison.unfit = false;
        return findings;
    }
    Differences displacements;
    if (const auto ratio = ratio_of(gathered, delay)) {
        comparison.ratio = ratio->value;
        comparison.sigma_ratio = ratio->standard_uncertainty;
    }
    comparison.compared = static_cast<std::int64_t>(differences.size());
    comparison.delay_s = delay.delay_s;
    if (delay.delay_s) comparison.sigma_delay_s = delay.sigma_s;
    do_together([&] { comparison.scale_m_s = test_differences(differences); },
                [&] {
                    displacements = displacement_differences(rows, gathered.recorded, delay);
                    test_differences(displacements);
                });

    const double threshold = chi_squared_upper_quantile(options.test_size, 2);
    const auto displaced = mark_displaced(rows, displacements, threshold);
    mark_drifting(rows, differences, displaced, threshold);
    // Repeated, because marked epochs no longer count.
    if (const auto witness = undisturbed_witness<2>(rows, directions, delay, left_out, options))
        if (auto errors = errors_of<2>(*witness, rows, comparison.scale_m_s)) {
            if (displaced.empty()) mark_drifts(rows, *witness, *errors, threshold);
            findings.errors.push_back(std::move(*errors));
        }
    if (options.vertical_measured)
        if (const auto witness = undisturbed_witness<1>(rows, directions, delay, left_out, options))
            if (auto errors = errors_of<1>(*witness, rows, comparison.scale_m_s))
                findings.errors.push_back(std::move(*errors));
    comparison.rejected = std::ranges::count_if(
        gathered.recorded, [&](const Knot& knot) { return !rows[knot.row].usable; });
    left_out = velocities_of_other_moments(rows, comparison);
    judge();
    if (of_other_moments > options.share_max) findings.errors.clear();
    return findings;
}

}  // namespace runcert
