#include <fmt/format.h>

#include <cmath>
#include <map>

#include "arcs/window_ends.h"
#include "stages/window/window.h"

namespace runcert {
namespace {

/// Rows with a position whose time is later than that of every such row before.
std::vector<std::size_t> rows_in_time(const ScreenedTable& screened) {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (row.east_m && row.north_m &&
            (rows.empty() || row.time > screened.rows[rows.back()].time))
            rows.push_back(i);
    }
    return rows;
}

double displacement_m(const ScreenedEpoch& first, const ScreenedEpoch& last) {
    return std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
}

std::string describe(Reason reason, std::int64_t count) {
    static const std::map<Reason, std::string_view> sentences{
        {Reason::no_position, "without a position"},
        {Reason::no_fix, "without a fix"},
        {Reason::float_ambiguities, "with float ambiguities, not fixed ones"},
        {Reason::other_fix, "of a kind of solution that is not allowed"},
        {Reason::duplicate_time, "with the time of the epoch before"},
        {Reason::backward_time, "with a time out of order"},
        {Reason::accuracy_missing, "without a stated accuracy"},
        {Reason::accuracy_absurd, "with an absurd stated accuracy"},
        {Reason::few_satellites, "from too few satellites for a check of the position"},
        {Reason::low_ratio, "whose ambiguities are hardly better than others"},
        {Reason::old_corrections, "with corrections that are too old"},
        {Reason::innovation, "rejected by the innovation test"},
        {Reason::short_arc, "in a stretch too short to be used"},
        {Reason::outlier, "contradicted by those before and after"},
        {Reason::burst, "in a run of wrong positions"},
        {Reason::model, "in a stretch that no single error explains"},
        {Reason::velocity, "contradicted by the recorded velocity"},
        {Reason::physical_limit, "of a motion that the craft cannot make"},
        {Reason::baseline, "contradicted by the other receiver"}};
    return fmt::format("{} {} {}", count, count == 1 ? "epoch" : "epochs", sentences.at(reason));
}

/// Breaks inside a window, by what they mean for it.
struct Breaks {
    std::int64_t gaps = 0;
    std::int64_t steps = 0;    ///< positions, or their times, do not go on as they were
    std::int64_t bridged = 0;  ///< such a step whose offset the estimate takes out
};

void add_break(ArcBreak arc_break, Breaks& breaks) {
    switch (arc_break) {
        case ArcBreak::start:
        case ArcBreak::gap:
            ++breaks.gaps;
            break;
        case ArcBreak::innovation:
        case ArcBreak::step:
        case ArcBreak::ramp:
        case ArcBreak::time_shift:
            ++breaks.steps;
            break;
        case ArcBreak::bridged:
            ++breaks.bridged;
            break;
    }
}

std::vector<std::string> refusals_of(const ScreenedTable& screened, std::size_t first,
                                     std::size_t last, BridgedSteps bridged) {
    std::map<Reason, std::int64_t> reasons;
    std::vector<std::string> refusals;
    Breaks breaks;
    for (std::size_t i = first; i <= last; ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable) ++reasons[row.reason];
        if (i != first && row.break_before) add_break(*row.break_before, breaks);
    }
    refusals.reserve(reasons.size() + 3);
    for (const auto& [reason, count] : reasons)
        refusals.push_back(describe(reason, count));
    if (breaks.steps > 0)
        refusals.push_back(
            fmt::format("{} {} that the motion cannot explain: positions before and "
                        "after do not belong together",
                        breaks.steps, breaks.steps == 1 ? "step" : "steps"));
    if (breaks.bridged > 0 && bridged == BridgedSteps::refused)
        refusals.push_back(
            fmt::format("{} repaired {}: the recorded positions before and after belong together "
                        "only by an estimated offset",
                        breaks.bridged, breaks.bridged == 1 ? "step" : "steps"));
    if (breaks.gaps > 0 && reasons.empty())
        refusals.push_back(
            fmt::format("{} {} in time", breaks.gaps, breaks.gaps == 1 ? "gap" : "gaps"));
    return refusals;
}

}  // namespace

std::optional<IndicatedWindow> fastest_indicated(const ScreenedTable& screened, double duration_s,
                                                 const WindowConfig& config, BridgedSteps bridged) {
    const std::vector<std::size_t> rows = rows_in_time(screened);
    std::vector<ElapsedTime> times;
    times.reserve(rows.size());
    for (const std::size_t row : rows)
        times.push_back(screened.rows[row].time);
    const auto ends = window_ends(times, duration_s, config.duration_tolerance_s,
                                  screened.facts.nominal_interval_s);
    std::optional<EpochPair> best;
    double best_speed_mps = -1.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!ends[i]) continue;
        const ScreenedEpoch& first = screened.rows[rows[i]];
        const ScreenedEpoch& last = screened.rows[rows[*ends[i]]];
        const double speed_mps =
            displacement_m(first, last) / (last.time.seconds() - first.time.seconds());
        if (speed_mps > best_speed_mps) {
            best_speed_mps = speed_mps;
            best = EpochPair{rows[i], rows[*ends[i]]};
        }
    }
    if (!best) return std::nullopt;
    return IndicatedWindow{
        .span = window_span(screened.facts, screened.rows[best->first].epoch,
                            screened.rows[best->last].epoch, screened.rows[best->first].time,
                            screened.rows[best->last].time),
        .speed_mps = best_speed_mps,
        .refusals = refusals_of(screened, best->first, best->last, bridged)};
}

}  // namespace runcert
