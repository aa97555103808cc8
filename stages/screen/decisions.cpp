#include "stages/screen/decisions.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace runcert {
namespace {

void record(ScreenedEpoch& row, const ScreeningDecision& decision, TestedAxes axes) {
    row.hypothesis = decision.hypothesis;
    row.tested_axes = axes;
    row.statistic = decision.statistic;
    row.threshold = decision.threshold;
    row.estimated = decision.estimated;
}

/// Leaves out a row. Returns whether it was usable before.
bool leave_out(ScreenedEpoch& row, const ScreeningDecision& decision, Reason reason,
               TestedAxes axes) {
    if (!row.usable) return false;
    row.usable = false;
    row.reason = reason;
    record(row, decision, axes);
    return true;
}

ArcBreak break_of(Hypothesis hypothesis) {
    if (hypothesis == Hypothesis::ramp) return ArcBreak::ramp;
    if (hypothesis == Hypothesis::time_shift) return ArcBreak::time_shift;
    return ArcBreak::step;
}

/// The rows of an arc.
struct ArcView {
    std::vector<ScreenedEpoch>& rows;
    std::span<const std::size_t> indices;

    std::size_t size() const { return indices.size(); }
    ScreenedEpoch& operator[](std::size_t k) const { return rows[indices[k]]; }
};

/// Epochs of an arc, both ends included.
struct EpochRange {
    std::size_t first = 0;
    std::size_t last = 0;
};

/// Ramps of an arc that belong together: all within a minute of the first.
struct Excursion {
    std::vector<const ScreeningDecision*> ramps;

    /// Whether the rates sum to zero, so that the drift has ended.
    bool ends() const {
        Eigen::Vector3d rate = Eigen::Vector3d::Zero();
        double variance = 0.0;
        for (const ScreeningDecision* ramp : ramps) {
            const EstimatedError& by = ramp->estimated;
            rate += Eigen::Vector3d(by.rate_east_m_s.value_or(0.0), by.rate_north_m_s.value_or(0.0),
                                    by.rate_up_m_s.value_or(0.0));
            variance += ramp->sigma_rate_m_s * ramp->sigma_rate_m_s;
        }
        constexpr double coverage = 5.0;
        return ramps.size() > 1 && rate.squaredNorm() < coverage * coverage * variance;
    }
};

std::vector<Excursion> excursions_of(const ArcView& arc, const ArcDecisions& decisions) {
    constexpr double longest_s = 60.0;
    std::vector<Excursion> excursions;
    double begun_s = 0.0;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto& decision = decisions.breaks[k];
        if (!decision || decision->hypothesis != Hypothesis::ramp) continue;
        const double time_s = arc[k].time.seconds();
        if (excursions.empty() || time_s - begun_s > longest_s || excursions.back().ends()) {
            excursions.emplace_back();
            begun_s = time_s;
        }
        excursions.back().ramps.push_back(&*decision);
    }
    return excursions;
}

/// The position along the tested axes, the others zero.
Eigen::Vector3d position_along(const ScreenedEpoch& row, TestedAxes axes) {
    if (axes == TestedAxes::vertical) return {0.0, 0.0, row.up_m.value_or(0.0)};
    return {row.east_m.value_or(0.0), row.north_m.value_or(0.0), 0.0};
}

/// The recorded velocity along the tested axes, the others zero.
std::optional<Eigen::Vector3d> recorded_velocity(const ScreenedEpoch& row, TestedAxes axes) {
    if (axes == TestedAxes::vertical && row.recorded_velocity_up_m_s)
        return Eigen::Vector3d(0.0, 0.0, *row.recorded_velocity_up_m_s);
    if (axes == TestedAxes::horizontal && row.recorded_velocity_east_m_s &&
        row.recorded_velocity_north_m_s)
        return Eigen::Vector3d(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s,
                               0.0);
    return std::nullopt;
}

/// Velocity of the positions between two rows of the arc, minus the mean of the velocities recorded
/// `lag` rows later. Empty if a value is missing, or there are too few rows.
std::optional<Eigen::Vector3d> unrecorded_velocity(const ArcView& arc, EpochRange part,
                                                   std::size_t lag, TestedAxes axes) {
    constexpr std::size_t fewest = 4;
    if (part.last < part.first + fewest || part.last + lag >= arc.size()) return std::nullopt;
    const auto position = [&](std::size_t k) { return position_along(arc[k], axes); };
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = part.first; k <= part.last; ++k) {
        const auto velocity = recorded_velocity(arc[k + lag], axes);
        if (!velocity) return std::nullopt;
        sum += *velocity;
    }
    const double elapsed_s = arc[part.last].time.seconds() - arc[part.first].time.seconds();
    return (position(part.last) - position(part.first)) / elapsed_s -
           sum / static_cast<double>(part.last - part.first + 1);
}

/// The two sides of a ramp's beginning on which recorded velocities are considered.
struct RampSides {
    EpochRange before;
    EpochRange after;
    TestedAxes axes = TestedAxes::horizontal;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
};

double away_s(const ArcView& arc, std::size_t k, std::size_t from) {
    return std::abs(arc[k].time.seconds() - arc[from].time.seconds());
}

/// The epochs on both sides of a given one within `reach_s` seconds.
EpochRange around(const ArcView& arc, std::size_t from, double reach_s) {
    EpochRange range{from, from};
    while (range.first > 0 && away_s(arc, range.first - 1, from) <= reach_s)
        --range.first;
    while (range.last + 1 < arc.size() && away_s(arc, range.last + 1, from) <= reach_s)
        ++range.last;
    return range;
}

/// On the ground, heights without recorded vertical velocities serve only as a witness of the
/// horizontal positions. Horizontal velocities are then considered instead.
RampSides ramp_sides_of(const ArcView& arc, const ScreeningDecision& ramp, TestedAxes tested,
                        bool on_the_ground) {
    constexpr double reach_s = 2.0;
    const bool level = tested == TestedAxes::vertical && on_the_ground &&
                       !arc[ramp.first].recorded_velocity_up_m_s;
    const EpochRange near = around(arc, ramp.first, reach_s);
    const EstimatedError& by = ramp.estimated;
    return {.before = {near.first, ramp.first},
            .after = {ramp.first, near.last},
            .axes = level ? TestedAxes::horizontal : tested,
            .rate = {by.rate_east_m_s.value_or(0.0), by.rate_north_m_s.value_or(0.0),
                     by.rate_up_m_s.value_or(0.0)}};
}

/// The least norm of a velocity that is compared at a lag, over the lags of the recorded velocities
/// of up to half a second. Infinite if it is nowhere known.
template <class AtLag>
double least_over_lags(const ArcView& arc, std::size_t from, const AtLag& velocity_at) {
    constexpr double longest_lag_s = 0.5;
    double least_m_s = std::numeric_limits<double>::infinity();
    for (std::size_t lag = 0;
         from + lag < arc.size() && away_s(arc, from + lag, from) <= longest_lag_s; ++lag)
        if (const std::optional<Eigen::Vector3d> velocity = velocity_at(lag))
            least_m_s = std::min(least_m_s, velocity->norm());
    return least_m_s;
}

/// Whether the recorded velocities change with the positions where these seem to begin to drift.
/// The craft then really moved so, harder than the class's motion model allows. The velocities
/// would not show a drift of the positions alone.
bool is_recorded_motion(const ArcView& arc, const ScreeningDecision& ramp, TestedAxes tested,
                        bool on_the_ground) {
    const RampSides sides = ramp_sides_of(arc, ramp, tested, on_the_ground);
    const auto change = [&](std::size_t lag) -> std::optional<Eigen::Vector3d> {
        const auto before = unrecorded_velocity(arc, sides.before, lag, sides.axes);
        const auto after = unrecorded_velocity(arc, sides.after, lag, sides.axes);
        if (!before || !after) return std::nullopt;
        return *after - *before;
    };
    return least_over_lags(arc, ramp.first, change) < 0.5 * sides.rate.norm();
}

/// The side of a ramp that the recorded velocities confirm.
enum class VouchedSide { neither, before, after };

/// The velocities confirm a side whose positions move as they say, if those of the other side do
/// not: to a quarter of the rate against three quarters. Each side uses the lag of up to half a
/// second that suits it best. The positions' stated noise must be low enough to decide this.
VouchedSide vouched_side(const ArcView& arc, const ScreeningDecision& ramp,
                         const RampSides& sides) {
    constexpr double apart_s = 2.0;
    const double rate = sides.rate.norm();
    const ScreenedEpoch& at = arc[ramp.first];
    const double sigma_m = (sides.axes == TestedAxes::vertical ? at.sigma_up_m : at.sigma_east_m)
                               .value_or(std::numeric_limits<double>::infinity());
    if (std::numbers::sqrt2 * sigma_m / apart_s > 0.25 * rate) return VouchedSide::neither;
    const auto least = [&](EpochRange side) {
        return least_over_lags(arc, ramp.first, [&](std::size_t lag) {
            return unrecorded_velocity(arc, side, lag, sides.axes);
        });
    };
    const double before = least(sides.before);
    const double after = least(sides.after);
    if (!std::isfinite(before) || !std::isfinite(after)) return VouchedSide::neither;
    if (before < 0.25 * rate && after > 0.75 * rate) return VouchedSide::before;
    if (after < 0.25 * rate && before > 0.75 * rate) return VouchedSide::after;
    return VouchedSide::neither;
}

/// Whether the positions stand still for some seconds from an epoch on, in the direction of the arc
/// or against it: they move by less than a tenth of the rate. Drifting positions do not.
bool stands_still(const ArcView& arc, std::size_t from, int direction, const RampSides& sides) {
    constexpr double long_s = 10.0;
    const auto position = [&](std::size_t k) { return position_along(arc[k], sides.axes); };
    const double allowed_m_s = 0.1 * sides.rate.norm();
    std::size_t k = from;
    while (away_s(arc, k, from) < long_s) {
        if (direction > 0 ? k + 1 == arc.size() : k == 0) return false;
        k = direction > 0 ? k + 1 : k - 1;
        if ((position(k) - position(from)).norm() > allowed_m_s * long_s) return false;
    }
    return (position(k) - position(from)).norm() <= allowed_m_s * away_s(arc, k, from);
}

/// Whether most epochs of a range have a velocity, or a speed, along the axes.
bool has_velocities(const ArcView& arc, EpochRange range, TestedAxes axes) {
    std::size_t recorded = 0;
    for (std::size_t k = range.first; k <= range.last; ++k) {
        const ScreenedEpoch& row = arc[k];
        const bool level = row.recorded_velocity_east_m_s || row.recorded_speed_m_s;
        const bool upright = row.recorded_velocity_up_m_s.has_value();
        recorded += (axes == TestedAxes::vertical ? upright : level) ? 1 : 0;
    }
    return 2 * recorded > range.last - range.first + 1;
}

/// How far a drift that begins or ends at a ramp can reach: epochs first to last - 1. It does not
/// extend past another break, nor to a side that the recorded velocities confirm.
EpochRange reach_of(const ArcView& arc, const ArcDecisions& decisions,
                    const ScreeningDecision& ramp, TestedAxes axes, bool on_the_ground) {
    // Solutions that lost track reached 150 m in simulations. No receiver goes further unnoticed.
    constexpr double largest_error_m = 1000.0;
    const RampSides sides = ramp_sides_of(arc, ramp, axes, on_the_ground);
    const double rate = sides.rate.norm();
    // Recorded velocities, where they exist, test positions further away, and each window by
    // itself.
    constexpr double reach_of_velocities_s = 10.0;
    const bool witnessed = has_velocities(arc, sides.before, sides.axes) &&
                           has_velocities(arc, sides.after, sides.axes);
    const double reach_s = witnessed    ? reach_of_velocities_s
                           : rate > 0.0 ? largest_error_m / rate
                                        : std::numeric_limits<double>::infinity();
    const VouchedSide vouched = vouched_side(arc, ramp, sides);
    const auto continues = [&](std::size_t k, int direction) {
        return away_s(arc, k, ramp.first) <= reach_s && !stands_still(arc, k, direction, sides);
    };
    EpochRange reach{ramp.first, ramp.first};
    if (vouched != VouchedSide::before) {
        while (reach.first > 0 && !decisions.breaks[reach.first - 1] &&
               continues(reach.first - 1, -1))
            --reach.first;
        if (reach.first > 0 && decisions.breaks[reach.first - 1]) --reach.first;
    }
    if (vouched != VouchedSide::after)
        while (++reach.last < arc.size() && !decisions.breaks[reach.last] &&
               continues(reach.last, 1)) {
        }
    return reach;
}

/// The epochs that a decision left out, in the terms of the table's header.
class Losses {
  public:
    explicit Losses(TestedAxes axes) : axes_(axes) {}

    void add(const ScreeningDecision& decision, const ScreenedEpoch& first,
             const ScreenedEpoch& last, std::int64_t epochs) {
        if (epochs == 0 || (largest_ && largest_->epochs >= epochs)) return;
        LargestDecision& largest = largest_.emplace();
        largest.hypothesis = decision.hypothesis;
        largest.axes = axes_;
        largest.first_epoch = first.epoch;
        largest.last_epoch = last.epoch;
        largest.time_s = first.time.seconds();
        largest.epochs = epochs;
        largest.statistic = decision.statistic;
        largest.threshold = decision.threshold;
    }
    std::optional<LargestDecision> largest() const { return largest_; }

  private:
    TestedAxes axes_;
    std::optional<LargestDecision> largest_;
};

/// Leaves out epochs first to last - 1 of the arc.
void leave_out_range(const ArcView& arc, EpochRange range, const ScreeningDecision& decision,
                     TestedAxes axes, Losses& losses) {
    std::int64_t lost = 0;
    for (std::size_t k = range.first; k < range.last; ++k)
        lost += leave_out(arc[k], decision, Reason::model, axes) ? 1 : 0;
    if (range.last > range.first) losses.add(decision, arc[range.first], arc[range.last - 1], lost);
}

void leave_out_drifting(const ArcView& arc, const ArcDecisions& decisions, TestedAxes axes,
                        bool on_the_ground, Losses& losses) {
    for (const Excursion& excursion : excursions_of(arc, decisions)) {
        if (std::ranges::all_of(excursion.ramps, [&](const ScreeningDecision* ramp) {
                return is_recorded_motion(arc, *ramp, axes, on_the_ground);
            }))
            continue;
        const ScreeningDecision& first = *excursion.ramps.front();
        const ScreeningDecision& last = *excursion.ramps.back();
        leave_out_range(arc, {first.first, last.first}, first, axes, losses);
        if (excursion.ends()) continue;
        for (const ScreeningDecision* ramp : excursion.ramps)
            leave_out_range(arc, reach_of(arc, decisions, *ramp, axes, on_the_ground), *ramp, axes,
                            losses);
    }
}

}  // namespace

std::optional<LargestDecision> mark_rows(std::vector<ScreenedEpoch>& rows,
                                         std::span<const std::size_t> arc_rows,
                                         const ArcDecisions& decisions, TestedAxes axes,
                                         bool on_the_ground) {
    const ArcView arc{rows, arc_rows};
    Losses losses(axes);
    leave_out_drifting(arc, decisions, axes, on_the_ground, losses);
    std::int64_t lost = 0;
    std::size_t begun = arc.size();  // first epoch of the decision being counted
    for (std::size_t k = 0; k < arc.size(); ++k) {
        ScreenedEpoch& row = arc[k];
        const auto& decision = decisions.left_out[k];
        if (!decision) continue;
        const Reason reason = decision->hypothesis == Hypothesis::outlier ? Reason::outlier
                              : decision->hypothesis == Hypothesis::burst ? Reason::burst
                                                                          : Reason::model;
        // Epochs of a span with an earlier decision are counted there.
        if (decision->first != begun) lost = 0;
        begun = decision->first;
        lost += leave_out(row, *decision, reason, axes) ? 1 : 0;
        losses.add(*decision, arc[decision->first], row, lost);
    }
    const auto manoeuvre = axes == TestedAxes::vertical ? &ScreenedEpoch::manoeuvre_up_m_s2
                                                        : &ScreenedEpoch::manoeuvre_m_s2;
    for (std::size_t k = 0; k < arc.size(); ++k)
        if (decisions.manoeuvres_m_s2[k] > 0.0) arc[k].*manoeuvre = decisions.manoeuvres_m_s2[k];
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto& decision = decisions.breaks[k];
        if (!decision) continue;
        // Where that epoch is left out, the break takes effect at the next usable one.
        std::size_t at = k;
        while (at < arc.size() && !arc[at].usable)
            ++at;
        if (at == arc.size()) continue;
        ScreenedEpoch& row = arc[at];
        // The beginning of the arc, or a break found on the other axes, suffices.
        if (row.break_before) continue;
        row.break_before = break_of(decision->hypothesis);
        record(row, *decision, axes);
    }
    return losses.largest();
}

void finish_arcs(std::vector<ScreenedEpoch>& rows, double longest_hole_s,
                 std::int64_t min_arc_epochs) {
    constexpr double rounding_s = 1e-6;
    struct Stretch {
        std::vector<ScreenedEpoch*> members;
        std::int64_t usable = 0;
    };
    std::vector<Stretch> stretches;
    std::optional<ArcBreak> pending;
    std::vector<ScreenedEpoch*> hole;       // left out since the last usable row
    const ScreenedEpoch* usable = nullptr;  // the last usable row
    for (ScreenedEpoch& row : rows) {
        if (!row.arc) continue;
        if (!pending) pending = row.break_before;
        row.break_before.reset();
        row.arc.reset();
        if (!row.usable) {
            hole.push_back(&row);
            continue;
        }
        const bool long_hole =
            usable && !hole.empty() &&
            row.time.seconds() - usable->time.seconds() > longest_hole_s + rounding_s;
        usable = &row;
        if (long_hole && !pending) pending = ArcBreak::gap;
        if (stretches.empty() && !pending) pending = ArcBreak::start;
        if (pending)
            stretches.emplace_back();
        else
            stretches.back().members.insert(stretches.back().members.end(), hole.begin(),
                                            hole.end());
        hole.clear();
        row.break_before = pending;
        pending.reset();
        stretches.back().members.push_back(&row);
        ++stretches.back().usable;
    }
    std::int64_t number = 0;
    for (Stretch& stretch : stretches) {
        const bool kept = stretch.usable >= min_arc_epochs;
        if (kept) ++number;
        for (ScreenedEpoch* row : stretch.members) {
            if (kept) {
                row->arc = number;
                continue;
            }
            row->break_before.reset();
            if (!row->usable) continue;
            row->usable = false;
            row->reason = Reason::short_arc;
            row->statistic = static_cast<double>(stretch.usable);
            row->threshold = static_cast<double>(min_arc_epochs);
            row->hypothesis.reset();
            row->tested_axes.reset();
            row->estimated = {};
        }
    }
}

}  // namespace runcert
