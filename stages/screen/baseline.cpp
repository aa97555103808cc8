#include "stages/screen/baseline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/statistics.h"
#include "schemas/enu/measured_position.h"
#include "stages/screen/adaptation.h"
#include "stages/screen/decisions.h"
#include "stages/screen/noise.h"
#include "witness/arcs.h"
#include "witness/copies.h"
#include "witness/position_pairs.h"

namespace runcert {
namespace {

using Eigen::Matrix2d, Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

/// An epoch common to both receivers.
struct ReceiverPair : PositionPair {
    std::optional<Eigen::Vector2d> track = {};  ///< direction of travel, where it shows the craft's
                                                ///< attitude
    double variance_of_direction = 0.0;         ///< rad^2
};

bool tells_direction(const EpochMotion& motion, double length_m) {
    constexpr double slowest_m_s = 1.0;
    constexpr double largest_turn = 0.05;
    const double speed_m_s = motion.velocity.norm();
    const double sigma_m_s = std::sqrt(motion.velocity_covariance.trace());
    if (!(speed_m_s > slowest_m_s && speed_m_s > 10.0 * sigma_m_s)) return false;
    const Vector2d &v = motion.velocity, &a = motion.acceleration;
    const double curvature = std::abs(v.x() * a.y() - v.y() * a.x()) / std::pow(speed_m_s, 3);
    return curvature * length_m <= largest_turn;
}

/// The pairs of `position_pairs`, with directions as `compare_receivers` describes.
std::vector<ReceiverPair> pairs_of(const ScreenedTable& first, const ScreenedTable& second,
                                   const Motion& motion_of_first) {
    std::vector<ReceiverPair> pairs;
    for (const PositionPair& both : position_pairs(first, second)) {
        ReceiverPair& pair = pairs.emplace_back(ReceiverPair{both});
        const auto& motion = motion_of_first[pair.rows[0]];
        if (!motion || !tells_direction(*motion, pair.difference.head<2>().norm())) continue;
        pair.track = motion->velocity.normalized();
        const Vector2d across(-pair.track->y(), pair.track->x());
        pair.variance_of_direction =
            across.dot(motion->velocity_covariance * across) / motion->velocity.squaredNorm();
    }
    return pairs;
}

std::vector<double> lengths_of(const std::vector<ReceiverPair>& pairs) {
    std::vector<double> lengths;
    for (const ReceiverPair& pair : pairs)
        lengths.push_back(pair.difference.norm());
    return lengths;
}

/// The rotation from east and north to along the track and across it to the right, and back.
Matrix2d track_axes(const Vector2d& track) {
    return (Matrix2d() << track.x(), track.y(), track.y(), -track.x()).finished();
}

/// Writes the tested quantity of a pair as a row's position: along and across (2), or the length
/// (1).
template <int Axes>
void fill_difference(const ReceiverPair& pair, ScreenedEpoch& row) {
    if constexpr (Axes == 1) {
        row.up_m = pair.difference.norm();
        // For antennas closer than their noise, the largest standard deviation.
        const Vector3d direction = pair.difference.stableNormalized();
        row.sigma_up_m = std::sqrt(*row.up_m > 0.0 ? direction.dot(pair.covariance * direction)
                                                   : pair.covariance.diagonal().maxCoeff());
    } else {
        const Matrix2d axes = track_axes(*pair.track);
        const Vector2d difference = axes * pair.difference.head<2>();
        const Vector2d turned(-difference.y(), difference.x());
        const Matrix2d covariance =
            axes * pair.covariance.topLeftCorner<2, 2>() * axes.transpose() +
            pair.variance_of_direction * turned * turned.transpose();
        row.east_m = difference.x();
        row.north_m = difference.y();
        row.sigma_east_m = std::sqrt(covariance(0, 0));
        row.sigma_north_m = std::sqrt(covariance(1, 1));
        row.correlation_east_north =
            covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
    }
}

/// For each row, the number of arcs that have begun up to it.
std::vector<std::int64_t> breaks_up_to(const std::vector<ScreenedEpoch>& rows) {
    std::vector<std::int64_t> breaks;
    for (const ScreenedEpoch& row : rows)
        breaks.push_back((breaks.empty() ? 0 : breaks.back()) + (row.break_before ? 1 : 0));
    return breaks;
}

/// The differences as a table.
struct Series {
    ScreenedTable table;
    std::vector<std::size_t> pairs;  ///< of each row, the index of its pair
};

/// Pairs still usable in both tables. Arcs end where an arc of either table does, or where more
/// than `longest_hole` pairs have no direction.
template <int Axes>
Series series_of(const std::vector<ReceiverPair>& pairs,
                 const std::array<const ScreenedTable*, 2>& receivers, const ScreenConfig& config) {
    Series series;
    series.table.facts.vertical_measured = Axes == 1;
    series.table.facts.nominal_interval_s =
        std::max(receivers[0]->facts.nominal_interval_s, receivers[1]->facts.nominal_interval_s);
    const std::array breaks{breaks_up_to(receivers[0]->rows), breaks_up_to(receivers[1]->rows)};
    std::int64_t arc = 0;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const ReceiverPair& pair = pairs[p];
        if (Axes == 2 && !pair.track) continue;
        bool usable = true;
        bool begins = series.pairs.empty() ||
                      static_cast<std::int64_t>(p - series.pairs.back()) > config.burst_epochs_max;
        for (const std::size_t r : {0U, 1U}) {
            usable = usable && receivers[r]->rows[pair.rows[r]].usable;
            begins =
                begins || breaks[r][pair.rows[r]] != breaks[r][pairs[series.pairs.back()].rows[r]];
        }
        if (!usable) continue;
        ScreenedEpoch& row = series.table.rows.emplace_back();
        row.time = pair.time;
        fill_difference<Axes>(pair, row);
        row.usable = true;
        if (begins) row.break_before = ++arc == 1 ? ArcBreak::start : ArcBreak::gap;
        row.arc = arc;
        series.pairs.push_back(p);
    }
    finish_arcs(series.table.rows, config.bridged_s(series.table.facts.nominal_interval_s),
                config.min_arc_epochs);
    return series;
}

/// The noise, fitted to the epochs that a first adaptation with the stated noise keeps. Without a
/// fit it is the stated noise.
template <int Axes>
EstimationModel estimate_model(const Series& series, double length_m, const TestPlan& plan,
                               ScreenConfig config) {
    constexpr TestedAxes axes = tested_axes<Axes>;
    // How fast the craft may turn relative to its track, rad s^-2.5, and how fast antennas may
    // sway.
    constexpr double angular_jerk_density = 0.1;
    constexpr double least_jerk_density = 0.05;
    config.jerk_density = std::max(least_jerk_density, angular_jerk_density * length_m);
    const bool fit = config.noise == NoiseChoice::fitted;
    config.noise = NoiseChoice::stated;
    const EstimationModel stated = estimate_screening_noise<Axes>(series.table, config).model;
    if (!fit) return stated;
    ScreenedTable first_look = series.table;
    for (const Arc<Axes>& arc : arcs_of<Axes>(series.table))
        mark_rows(first_look.rows, arc.rows, adapt<Axes>(arc.epochs, stated, plan), axes);
    finish_arcs(first_look.rows, config.bridged_s(first_look.facts.nominal_interval_s),
                config.min_arc_epochs);
    config.noise = NoiseChoice::fitted;
    const ScreeningNoise fitted = estimate_screening_noise<Axes>(first_look, config);
    return fitted.summary.noise == NoiseBasis::fitted ? fitted.model : stated;
}

/// Re-estimates the errors given all decisions, with a separate error for each epoch of a burst.
template <int Axes>
void estimate_errors(const Arc<Axes>& arc, const EstimationModel& model, ArcDecisions& decisions) {
    for (const TestedStretch<Axes>& stretch : stretches_of(arc.epochs, model, decisions)) {
        const Chain<Axes> diagnosis(stretch.epochs, model);
        for (std::size_t i = 0; i < stretch.epochs.size(); ++i) {
            const std::size_t k = stretch.first + i;
            if (auto& left_out = decisions.left_out[k])
                left_out->estimated =
                    estimated_error(diagnosis.left_out(i, arc.epochs[k].measurement.value()));
            if (stretch.epochs[i].step_before && decisions.breaks[k])
                decisions.breaks[k]->estimated = estimated_error(diagnosis.known_step(i));
        }
    }
}

/// An error along and across the track, or of the length, rotated to east, north and up. `sign` is
/// 1 for the second receiver and -1 for the first.
EstimatedError turned_back(const EstimatedError& error, const ReceiverPair& pair, double sign) {
    EstimatedError turned;
    if (error.up_m) {
        const Vector3d direction = sign * pair.difference.stableNormalized();
        turned.east_m = direction.x() * *error.up_m;
        turned.north_m = direction.y() * *error.up_m;
        if (pair.covariance(2, 2) > 0.0) turned.up_m = direction.z() * *error.up_m;
    } else if (error.east_m) {
        const Matrix2d axes = track_axes(*pair.track);
        const Vector2d value = sign * (axes.transpose() * Vector2d(*error.east_m, *error.north_m));
        const Vector2d sigma(error.sigma_east_m.value(), error.sigma_north_m.value());
        Matrix2d covariance = sigma.cwiseAbs2().asDiagonal();
        covariance(0, 1) = covariance(1, 0) =
            error.correlation_east_north.value() * sigma.x() * sigma.y();
        covariance = (axes.transpose() * covariance * axes).eval();
        turned.east_m = value.x();
        turned.north_m = value.y();
        turned.sigma_east_m = std::sqrt(covariance(0, 0));
        turned.sigma_north_m = std::sqrt(covariance(1, 1));
        turned.correlation_east_north =
            covariance(0, 1) / (*turned.sigma_east_m * *turned.sigma_north_m);
    }
    return turned;
}

/// Marks one receiver's rows.
class Marker {
  public:
    Marker(ScreenedTable& table, const std::vector<ReceiverPair>& pairs, std::size_t receiver)
        : rows_(table.rows), pairs_(pairs), receiver_(receiver) {}

    bool any() const { return any_; }

    /// Leaves out the row of a compared pair.
    void leave_out(std::size_t pair, const ScreeningDecision& decision) {
        leave_out_row(row_of(pair), decision, own_error(pair, decision));
    }

    /// Leaves out usable rows between two pairs.
    void leave_out_between(std::size_t before, std::size_t after,
                           const ScreeningDecision& decision) {
        for (std::size_t row = row_of(before) + 1; row < row_of(after); ++row)
            leave_out_row(row, decision, {});
    }

    void break_before(std::size_t pair, const ScreeningDecision& decision) {
        ScreenedEpoch& row = rows_[row_of(pair)];
        if (row.break_before) return;
        any_ = true;
        row.break_before =
            decision.hypothesis == Hypothesis::ramp ? ArcBreak::ramp : ArcBreak::step;
        if (row.usable) record(row, decision, own_error(pair, decision));
    }

  private:
    std::size_t row_of(std::size_t pair) const { return pairs_[pair].rows[receiver_]; }

    EstimatedError own_error(std::size_t pair, const ScreeningDecision& decision) const {
        return turned_back(decision.estimated, pairs_[pair], receiver_ == 1 ? 1.0 : -1.0);
    }

    static void record(ScreenedEpoch& row, const ScreeningDecision& decision,
                       const EstimatedError& error) {
        row.hypothesis = Hypothesis::baseline;
        row.tested_axes = TestedAxes::horizontal;
        row.statistic = decision.statistic;
        row.threshold = decision.threshold;
        row.estimated = error;
    }

    void leave_out_row(std::size_t index, const ScreeningDecision& decision,
                       const EstimatedError& error) {
        ScreenedEpoch& row = rows_[index];
        if (!row.usable) return;
        any_ = true;
        row.usable = false;
        row.reason = Reason::baseline;
        record(row, decision, error);
    }

    std::vector<ScreenedEpoch>& rows_;
    const std::vector<ReceiverPair>& pairs_;
    std::size_t receiver_;
    bool any_ = false;
};

/// Marks the decisions on an arc. `arc_pairs` are the pairs of its epochs.
void mark_decisions(const ArcDecisions& decisions, const std::vector<std::size_t>& arc_pairs,
                    Marker& marker) {
    const std::size_t last = arc_pairs.size() - 1;
    for (std::size_t k = 0; k <= last; ++k)
        if (const auto& decision = decisions.left_out[k]) marker.leave_out(arc_pairs[k], *decision);
    for (std::size_t k = 0; k <= last; ++k) {
        const std::size_t pair = arc_pairs[k];
        if (const auto& decision = decisions.left_out[k]) {
            if (k > 0) marker.leave_out_between(pair - 1, pair, *decision);
            if (k < last) marker.leave_out_between(pair, pair + 1, *decision);
        }
        if (const auto& decision = decisions.breaks[k]; decision && k > 0) {
            marker.leave_out_between(arc_pairs[k - 1], pair, *decision);
            marker.break_before(pair, *decision);
        }
    }
}

template <int Axes>
void test_differences(const std::vector<ReceiverPair>& pairs, double length_m,
                      const std::array<const ScreenedTable*, 2>& receivers,
                      std::array<Marker, 2>& markers, const TestPlan& plan,
                      const ScreenConfig& config) {
    const Series series = series_of<Axes>(pairs, receivers, config);
    const std::vector<Arc<Axes>> arcs = arcs_of<Axes>(series.table);
    if (arcs.empty()) return;
    // A manoeuvre of the craft does not change the vector between two antennas.
    const TestPlan own = plan.with_manoeuvres(0.0);
    const EstimationModel model = estimate_model<Axes>(series, length_m, own, config);
    for (const Arc<Axes>& arc : arcs) {
        ArcDecisions decisions = adapt<Axes>(arc.epochs, model, own);
        estimate_errors(arc, model, decisions);
        std::vector<std::size_t> arc_pairs;
        for (const std::size_t row : arc.rows)
            arc_pairs.push_back(series.pairs[row]);
        for (Marker& marker : markers)
            mark_decisions(decisions, arc_pairs, marker);
    }
}

BaselineComparison comparison_of(const ScreenedTable& table, const std::string& other,
                                 const std::vector<ReceiverPair>& pairs, bool same_errors) {
    BaselineComparison comparison{.receiver = other, .compared = std::ssize(pairs)};
    if (!pairs.empty()) {
        std::vector<double> lengths = lengths_of(pairs);
        comparison.length_m = median(lengths);
        for (double& length : lengths)
            length = std::abs(length - comparison.length_m);
        comparison.sd_m = median(std::move(lengths)) / normal_quantile(0.75);
    }
    comparison.same_errors = same_errors;
    comparison.rejected = std::ranges::count(table.rows, Reason::baseline, &ScreenedEpoch::reason);
    return comparison;
}

/// The recorded positions, usable or not, because a copy also has the errors that screening finds.
std::vector<TimedPosition<2>> recorded_positions(const ScreenedTable& table) {
    std::vector<TimedPosition<2>> positions;
    for (const ScreenedEpoch& row : table.rows) {
        if (!row.east_m || !row.north_m) continue;
        const double time_s = row.time.seconds();
        if (!positions.empty() && positions.back().time_s >= time_s) continue;
        positions.push_back({.time_s = time_s, .position = measured_position<2>(row)});
    }
    return positions;
}

bool have_same_errors(const ScreenedTable& first, const ScreenedTable& second) {
    const auto &of_first = first.facts.first_epoch, &of_second = second.facts.first_epoch;
    if (of_first.has_value() != of_second.has_value()) return false;
    return made_from(recorded_positions(second), recorded_positions(first),
                     of_first ? of_second->seconds_since(*of_first) : 0.0);
}

}  // namespace

bool compare_receivers(ScreenedTable& first, ScreenedTable& second, const Motion& motion_of_first,
                       const TestPlan& plan, const ScreenConfig& config) {
    const std::vector<ReceiverPair> pairs = pairs_of(first, second, motion_of_first);
    std::array markers{Marker(first, pairs, 0), Marker(second, pairs, 1)};
    if (!pairs.empty()) {
        const double length_m = median(lengths_of(pairs));
        const std::array<const ScreenedTable*, 2> receivers{&first, &second};
        test_differences<2>(pairs, length_m, receivers, markers, plan, config);
        test_differences<1>(pairs, length_m, receivers, markers, plan, config);
    }
    const bool same_errors = have_same_errors(first, second);
    for (auto [table, other] : {std::pair{&first, &second}, {&second, &first}})
        table->basis.baseline = comparison_of(*table, other->facts.receiver, pairs, same_errors);
    return markers[0].any() || markers[1].any();
}

}  // namespace runcert
