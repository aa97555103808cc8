#include "stages/screen/decisions.h"

#include <Eigen/Core>

namespace runcert {
namespace {

void record(ScreenedEpoch& row, const Decision& decision, TestedAxes axes) {
    row.hypothesis = decision.hypothesis;
    row.tested_axes = axes;
    row.statistic = decision.statistic;
    row.threshold = decision.threshold;
    row.estimated = decision.estimated;
}

void leave_out(ScreenedEpoch& row, const Decision& decision, Reason reason, TestedAxes axes) {
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

/// Ramps of an arc that belong together: they follow one another within a minute.
struct Excursion {
    std::vector<const Decision*> ramps;

    /// Whether the rates add up to none: what drifted has come to an end.
    bool ends() const {
        Eigen::Vector3d rate = Eigen::Vector3d::Zero();
        double variance = 0.0;
        for (const Decision* ramp : ramps) {
            const EstimatedError& by = ramp->estimated;
            rate += Eigen::Vector3d(by.rate_east_mps.value_or(0.0), by.rate_north_mps.value_or(0.0),
                                    by.rate_up_mps.value_or(0.0));
            variance += ramp->sigma_rate_mps * ramp->sigma_rate_mps;
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

void leave_out_drifting(std::vector<ScreenedEpoch>& rows, std::span<const std::size_t> arc_rows,
                        const ArcDecisions& decisions, TestedAxes axes) {
    for (const Excursion& excursion : excursions_of(rows, arc_rows, decisions)) {
        std::size_t first = excursion.ramps.front()->first;
        std::size_t last = excursion.ramps.back()->first;
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
               const ArcDecisions& decisions, TestedAxes axes, bool bridge_steps) {
    leave_out_drifting(rows, arc_rows, decisions, axes);
    for (std::size_t k = 0; k < arc_rows.size(); ++k) {
        ScreenedEpoch& row = rows[arc_rows[k]];
        if (const auto& decision = decisions.left_out[k]) {
            const Reason reason = decision->hypothesis == Hypothesis::outlier ? Reason::outlier
                                  : decision->hypothesis == Hypothesis::burst ? Reason::burst
                                                                              : Reason::model;
            leave_out(row, *decision, reason, axes);
        }
    }
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
        row.break_before = break_of(decision->hypothesis, bridge_steps);
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
