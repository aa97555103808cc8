#include "stages/screen/decisions.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

void record(ScreenedEpoch& row, const ScreeningDecision& decision, TestedAxes axes) {
    row.hypothesis = decision.hypothesis;
    row.tested_axes = axes;
    row.statistic = decision.statistic;
    row.threshold = decision.threshold;
    row.estimated = decision.estimated;
}

void leave_out(ScreenedEpoch& row, const ScreeningDecision& decision, Reason reason,
               TestedAxes axes) {
    if (!row.usable) return;
    row.usable = false;
    row.reason = reason;
    record(row, decision, axes);
}

ArcBreak break_of(Hypothesis hypothesis, bool bridge_steps) {
    if (hypothesis == Hypothesis::ramp) return ArcBreak::ramp;
    if (hypothesis == Hypothesis::time_shift) return ArcBreak::time_shift;
    return bridge_steps ? ArcBreak::bridged : ArcBreak::step;
}

/// Epochs of an arc, both ends included.
struct EpochRange {
    std::size_t first = 0;
    std::size_t last = 0;
};

/// Ramps of an arc that belong together: they follow one another within a minute.
struct Excursion {
    std::vector<const ScreeningDecision*> ramps;

    /// Whether the rates add up to none: what drifted has come to an end.
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

std::vector<Excursion> excursions_of(const std::vector<ScreenedEpoch>& rows,
                                     std::span<const std::size_t> arc_rows,
                                     const ArcDecisions& decisions) {
    constexpr double longest_s = 60.0;
    std::vector<Excursion> excursions;
    double latest_s = 0.0;
    for (std::size_t k = 0; k < arc_rows.size(); ++k) {
        const auto& decision = decisions.breaks[k];
        if (!decision || decision->hypothesis != Hypothesis::ramp) continue;
        const double time_s = rows[arc_rows[k]].time.seconds();
        if (excursions.empty() || time_s - latest_s > longest_s || excursions.back().ends())
            excursions.emplace_back();
        excursions.back().ramps.push_back(&*decision);
        latest_s = time_s;
    }
    return excursions;
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

/// Velocity of the positions from one row of the arc to another less the mean of the velocities
/// recorded `lag` rows later; empty where a value is missing, or there are but few rows.
std::optional<Eigen::Vector3d> unrecorded_velocity(const std::vector<ScreenedEpoch>& rows,
                                                   std::span<const std::size_t> arc_rows,
                                                   EpochRange part, std::size_t lag,
                                                   TestedAxes axes) {
    constexpr std::size_t fewest = 4;
    if (part.last < part.first + fewest || part.last + lag >= arc_rows.size()) return std::nullopt;
    const auto position = [&](std::size_t k) -> Eigen::Vector3d {
        const ScreenedEpoch& row = rows[arc_rows[k]];
        if (axes == TestedAxes::vertical) return {0.0, 0.0, row.up_m.value_or(0.0)};
        return {row.east_m.value_or(0.0), row.north_m.value_or(0.0), 0.0};
    };
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = part.first; k <= part.last; ++k) {
        const auto velocity = recorded_velocity(rows[arc_rows[k + lag]], axes);
        if (!velocity) return std::nullopt;
        sum += *velocity;
    }
    const double elapsed_s =
        rows[arc_rows[part.last]].time.seconds() - rows[arc_rows[part.first]].time.seconds();
    return (position(part.last) - position(part.first)) / elapsed_s -
           sum / static_cast<double>(part.last - part.first + 1);
}

/// Whether the recorded velocities change with the positions where these seem to begin to drift:
/// the craft then moved so, harder than the class's motion has it. A drift of the positions alone
/// would be missing from them. They may lag behind by up to half a second. Heights of a craft on
/// the ground that the recording has no vertical velocities for are a witness of the horizontal
/// positions, and so are asked about these.
bool is_recorded_motion(const std::vector<ScreenedEpoch>& rows,
                        std::span<const std::size_t> arc_rows, const ScreeningDecision& ramp,
                        TestedAxes tested, bool on_the_ground) {
    constexpr double reach_s = 2.0;
    constexpr double longest_lag_s = 0.5;
    const bool level = tested == TestedAxes::vertical && on_the_ground &&
                       !rows[arc_rows[ramp.first]].recorded_velocity_up_m_s;
    const TestedAxes axes = level ? TestedAxes::horizontal : tested;
    const auto away_s = [&](std::size_t k) {
        return std::abs(rows[arc_rows[k]].time.seconds() -
                        rows[arc_rows[ramp.first]].time.seconds());
    };
    std::size_t begin = ramp.first;
    while (begin > 0 && away_s(begin - 1) <= reach_s)
        --begin;
    std::size_t end = ramp.first;
    while (end + 1 < arc_rows.size() && away_s(end + 1) <= reach_s)
        ++end;
    const EstimatedError& by = ramp.estimated;
    const Eigen::Vector3d rate(by.rate_east_m_s.value_or(0.0), by.rate_north_m_s.value_or(0.0),
                               by.rate_up_m_s.value_or(0.0));
    for (std::size_t lag = 0;
         ramp.first + lag < arc_rows.size() && away_s(ramp.first + lag) <= longest_lag_s; ++lag) {
        const auto before = unrecorded_velocity(rows, arc_rows, {begin, ramp.first}, lag, axes);
        const auto after = unrecorded_velocity(rows, arc_rows, {ramp.first, end}, lag, axes);
        if (before && after && (*after - *before).norm() < 0.5 * rate.norm()) return true;
    }
    return false;
}

void leave_out_drifting(std::vector<ScreenedEpoch>& rows, std::span<const std::size_t> arc_rows,
                        const ArcDecisions& decisions, TestedAxes axes, bool on_the_ground) {
    for (const Excursion& excursion : excursions_of(rows, arc_rows, decisions)) {
        std::size_t first = excursion.ramps.front()->first;
        std::size_t last = excursion.ramps.back()->first;
        if (std::ranges::all_of(excursion.ramps, [&](const ScreeningDecision* ramp) {
                return is_recorded_motion(rows, arc_rows, *ramp, axes, on_the_ground);
            }))
            continue;
        if (!excursion.ends()) {
            while (first > 0 && !decisions.breaks[first - 1])
                --first;
            if (first > 0) --first;
            while (++last < arc_rows.size() && !decisions.breaks[last]) {
            }
        }
        for (std::size_t k = first; k < last; ++k)
            leave_out(rows[arc_rows[k]], *excursion.ramps.front(), Reason::model, axes);
    }
}

}  // namespace

void mark_rows(std::vector<ScreenedEpoch>& rows, std::span<const std::size_t> arc_rows,
               const ArcDecisions& decisions, TestedAxes axes, const MarkOptions& options) {
    leave_out_drifting(rows, arc_rows, decisions, axes, options.on_the_ground);
    for (std::size_t k = 0; k < arc_rows.size(); ++k) {
        ScreenedEpoch& row = rows[arc_rows[k]];
        if (const auto& decision = decisions.left_out[k]) {
            const Reason reason = decision->hypothesis == Hypothesis::outlier ? Reason::outlier
                                  : decision->hypothesis == Hypothesis::burst ? Reason::burst
                                                                              : Reason::model;
            leave_out(row, *decision, reason, axes);
        }
    }
    const auto manoeuvre = axes == TestedAxes::vertical ? &ScreenedEpoch::manoeuvre_up_m_s2
                                                        : &ScreenedEpoch::manoeuvre_m_s2;
    for (std::size_t k = 0; k < arc_rows.size(); ++k)
        if (decisions.manoeuvres_m_s2[k] > 0.0)
            rows[arc_rows[k]].*manoeuvre = decisions.manoeuvres_m_s2[k];
    for (std::size_t k = 0; k < arc_rows.size(); ++k) {
        const auto& decision = decisions.breaks[k];
        if (!decision) continue;
        // Where that epoch is left out, the break shows at the next that is not.
        std::size_t at = k;
        while (at < arc_rows.size() && !rows[arc_rows[at]].usable)
            ++at;
        if (at == arc_rows.size()) continue;
        ScreenedEpoch& row = rows[arc_rows[at]];
        // The beginning of the arc, or what the other axes found, is break enough.
        if (row.break_before && *row.break_before != ArcBreak::bridged) continue;
        row.break_before = break_of(decision->hypothesis, options.bridge_steps);
        record(row, *decision, axes);
    }
}

void finish_arcs(std::vector<ScreenedEpoch>& rows, std::int64_t longest_hole,
                 std::int64_t min_arc_epochs) {
    struct Stretch {
        std::vector<ScreenedEpoch*> members;
        std::int64_t usable = 0;
    };
    std::vector<Stretch> stretches;
    std::optional<ArcBreak> pending;
    std::vector<ScreenedEpoch*> hole;  // left out since the last usable row
    for (ScreenedEpoch& row : rows) {
        if (!row.arc) continue;
        if (row.break_before && (!pending || *pending == ArcBreak::bridged))
            pending = row.break_before;
        row.break_before.reset();
        row.arc.reset();
        if (!row.usable) {
            hole.push_back(&row);
            continue;
        }
        const bool long_hole = std::ssize(hole) > longest_hole;
        if (long_hole && (!pending || *pending == ArcBreak::bridged)) pending = ArcBreak::gap;
        if (stretches.empty() && !pending) pending = ArcBreak::start;
        const bool begins = stretches.empty() || (pending && *pending != ArcBreak::bridged);
        if (begins)
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
