#include <fmt/format.h>

#include <cmath>

#include "stages/check/against_limit.h"

namespace runcert {
namespace {

Compared compared(std::string name, const CourseFigure& figure, double factor = 1.0,
                  bool magnitude = false) {
    Compared result{.name = std::move(name),
                    .value = factor * figure.value,
                    .expanded_uncertainty = figure.expanded_uncertainty};
    if (magnitude) result.value = std::abs(result.value);
    if (result.expanded_uncertainty) *result.expanded_uncertainty *= factor;
    return result;
}

/// The finding of what the trajectory says of the course, or that it says nothing.
template <class Find>
Finding with_facts(const ClauseContext& context, Find&& find) {
    if (!context.course.facts) return unknown(context.course.missing);
    return find(*context.course.facts);
}

/// Whether the recording holds the craft at its slowest before the run: not where it was faster, by
/// more than the uncertainty, ever after the first second of what there is. It may have been slower
/// before.
bool start_was_seen(const CraftRun& run, const CourseFigure& slowest,
                    const ClauseContext& context) {
    constexpr double beginning_s = 1.0;
    const auto& rows = context.input.judged.trajectory;
    const std::size_t from = run.stood_from_row.value_or(run.first_row);
    for (std::size_t i = 0; i < from; ++i)
        if (rows[i].arc) return true;
    const double least_m_s = slowest.value + slowest.expanded_uncertainty.value_or(0.0);
    for (std::size_t i = from; i <= run.first_row; ++i)
        if (rows[i].arc && rows[i].time.seconds() - rows[from].time.seconds() > beginning_s &&
            std::hypot(*rows[i].velocity_east_m_s, *rows[i].velocity_north_m_s) <= least_m_s)
            return true;
    return false;
}

}  // namespace

Finding computation::flatness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (!facts.height_difference_m) return unknown("not every epoch of the run has a height");
        return against_limit(
            compared("highest less lowest height of the run", *facts.height_difference_m), clause);
    });
}

Finding computation::slope(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        if (!facts.slope) return unknown("the window's ends have no heights");
        return against_limit(
            compared("slope of the window, without sign", *facts.slope, 100.0, true), clause);
    });
}

Finding computation::straightness(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(
            compared("largest distance of the track from its chord", facts.straightness_m), clause);
    });
}

Finding computation::turning(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit(compared("change of direction in the window, without sign",
                                      facts.turning_deg, 1.0, true),
                             clause);
    });
}

Finding computation::standing_start(const Clause&, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) -> Finding {
        const CourseFigure& speed = facts.speed_before_m_s;
        const std::string words =
            fmt::format("smallest speed of the run before the window {}",
                        quantity_text(speed.value, speed.expanded_uncertainty, "m/s"));
        std::vector<Figure> figures{{.name = "smallest speed of the run before the window",
                                     .value = speed.value,
                                     .unit = "m/s",
                                     .expanded_uncertainty = speed.expanded_uncertainty}};
        if (facts.standing_start)
            return {RequirementStatus::met,
                    words +
                        ", which is standing still; what moved it first is not decidable from the "
                        "recording",
                    std::move(figures)};
        const CraftRun& run = *context.course.run;
        const RunEdge began = run.began;
        if (began == RunEdge::standing && start_was_seen(run, speed, context))
            return {RequirementStatus::not_met, words + ": it was moving when the run began",
                    std::move(figures)};
        return {RequirementStatus::attest,
                fmt::format("{}: {}, so the start was not seen", words,
                            began == RunEdge::turn  ? "the run begins with a turn"
                            : began == RunEdge::gap ? "the run begins after a gap"
                            : began == RunEdge::standing
                                ? "the recording begins with the craft moving, if slowly"
                                : "the recording begins with the craft moving"),
                std::move(figures)};
    });
}

Finding computation::run_up(const Clause& clause, const ClauseContext& context) {
    return with_facts(context, [&](const CourseFacts& facts) {
        return against_limit({.name = "run-up",
                              .value = facts.run_up_m,
                              .expanded_uncertainty = std::nullopt,
                              .note = fmt::format("in {:.1f} s", facts.run_up_s)},
                             clause);
    });
}

}  // namespace runcert
