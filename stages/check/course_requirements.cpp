#include <algorithm>
#include <cmath>

#include "core/figures.h"
#include "core/text.h"
#include "stages/check/notes.h"

// What a rule limits of course and craft, of wind and current, and all that is known of them.

namespace runcert {
namespace {

// What figures of the course are called, in requirements and beside them.
constexpr const char* height_of_track = "highest less lowest height of the run";
constexpr const char* height_of_ground = "highest less lowest ground under the run";
constexpr const char* slope_of_track = "slope of the window";
constexpr const char* slope_of_ground = "slope of the ground under the window";
constexpr const char* off_the_chord = "largest distance of the track from its chord";
constexpr const char* turned = "change of direction in the window";
constexpr const char* slowest_before = "smallest speed of the run before the window";
constexpr const char* run_up_length = "run-up";
constexpr const char* without_sign = ", without sign";

/// The size of a figure of the course.
Quantity of_course(std::string name, const CourseFigure& figure) {
    return {.name = std::move(name),
            .value = std::abs(figure.value),
            .expanded_uncertainty = figure.expanded_uncertainty};
}

/// A surface that heights of the recording contradict does not decide by itself: the ground may
/// have been where they were.
std::optional<Finding> doubt_of_surface(const ReceiverFindings& judged) {
    const auto& surface = judged.tests.surface;
    if (!surface || surface->rejected == 0) return std::nullopt;
    return to_attest(
        "; {} of {} heights of the recording contradict the surface and were left out, so that "
        "the heights of the ground are to be attested",
        surface->rejected, surface->compared);
}

/// Heights that do not scatter as stated are typed, smoothed or of a formula. What follows from
/// them was not measured.
std::optional<Finding> doubt_of_heights(const ReceiverFindings& judged) {
    constexpr double too_smooth = 0.3;
    const auto& models = judged.tests.models;
    const auto model = std::ranges::find(models, TestedAxes::vertical, &ScreeningModel::axes);
    if (model == models.end() ||
        (model->noise == NoiseBasis::fitted && model->white_scale >= too_smooth))
        return std::nullopt;
    return to_attest(
        "; but the heights were not shown to scatter as stated (noise: {}, {:.2g} times as stated)",
        to_text(model->noise), model->white_scale);
}

/// A figure of heights: of the ground by the surface that was handed in, with the track's beside
/// it, else of the track.
struct HeightFigure {
    const char* of_ground;
    CourseFigure GroundFacts::*by_surface;
    const char* of_track;
    std::optional<CourseFigure> CourseFacts::*by_track;
    const char* sign;     ///< what is said of it
    const char* missing;  ///< why the track has none
};

Finding of_heights(const HeightFigure& figure, const Clause& clause, const ClauseContext& context) {
    const CourseFindings& course = context.course;
    if (!course.facts) return unknown("{}", course.missing);
    const std::optional<CourseFigure>& track = *course.facts.*figure.by_track;
    if (!course.ground && !track) return unknown("{}", figure.missing);
    Quantity quantity =
        course.ground
            ? of_course(fmt::format("{}{}, by the surface", figure.of_ground, figure.sign),
                        *course.ground.*figure.by_surface)
            : of_course(fmt::format("{}{}", figure.of_track, figure.sign), *track);
    if (course.ground && track)
        quantity.note =
            fmt::format("{} {} by the heights of the track",
                        format_fixed(std::abs(in_unit(track->value, clause.unit)), 2), clause.unit);
    quantity.if_met = course.ground ? doubt_of_surface(context.input.judged)
                                    : doubt_of_heights(context.input.judged);
    return against_limit(quantity, clause);
}

/// Whether the recording shows the craft at its slowest before the run. If the craft was always
/// faster, by more than the uncertainty, after the first available second, it may have been slower
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

/// The mean or the strongest of a flow in the window, by the attempt's series. Where its
/// uncertainty is not stated, the number of samples is said beside it.
Finding of_flow(const char* what, const std::optional<FlowInWindow>& flow,
                double FlowInWindow::*speed_m_s, std::optional<double> expanded_uncertainty_m_s,
                const Clause& clause) {
    if (!flow) return unknown("the attempt gives no series of the {}", what);
    if (!flow->missing.empty()) return not_met("{}", flow->missing);
    return against_limit(
        {.name = fmt::format("{} {} in the window",
                             speed_m_s == &FlowInWindow::mean_m_s ? "mean" : "strongest", what),
         .value = *flow.*speed_m_s,
         .expanded_uncertainty = expanded_uncertainty_m_s,
         .note = expanded_uncertainty_m_s ? ""
                                          : fmt::format("{} {} in the window", flow->samples,
                                                        flow->samples == 1 ? "sample" : "samples")},
        clause);
}

void add_flow_figures(const std::optional<FlowInWindow>& flow, const std::string& what,
                      const char* from, bool heading_known, std::vector<Figure>& figures) {
    if (!flow || !flow->missing.empty()) return;
    figures.push_back(plain("mean " + what, flow->mean_m_s, "m/s"));
    figures.push_back(plain("strongest " + what, flow->gust_m_s, "m/s"));
    figures.push_back(plain(what + " direction, " + from, flow->direction_deg, "deg"));
    if (!heading_known) return;
    figures.push_back(plain(what + " along the heading", flow->along_m_s, "m/s"));
    figures.push_back(plain(what + " across the heading, to the right", flow->across_m_s, "m/s"));
}

}  // namespace

Finding computation::flatness(const Clause& clause, const ClauseContext& context) {
    return of_heights({.of_ground = height_of_ground,
                       .by_surface = &GroundFacts::height_difference_m,
                       .of_track = height_of_track,
                       .by_track = &CourseFacts::height_difference_m,
                       .sign = "",
                       .missing = "not every epoch of the run has a height"},
                      clause, context);
}

Finding computation::slope(const Clause& clause, const ClauseContext& context) {
    return of_heights({.of_ground = slope_of_ground,
                       .by_surface = &GroundFacts::slope,
                       .of_track = slope_of_track,
                       .by_track = &CourseFacts::slope,
                       .sign = without_sign,
                       .missing = "the window's ends have no heights"},
                      clause, context);
}

Finding computation::straightness(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit(of_course(off_the_chord, facts->straightness_m), clause);
}

Finding computation::turning(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit(of_course(fmt::format("{}{}", turned, without_sign), facts->turning_deg),
                         clause);
}

Finding computation::standing_start(const Clause&, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    const CourseFigure& speed = facts->speed_before_m_s;
    const CraftRun& run = *context.course.run;
    Figure slowest = plain(slowest_before, speed.value, "m/s");
    slowest.expanded_uncertainty = speed.expanded_uncertainty;
    const std::string words = fmt::format(
        "{} {}", slowest.name, quantity_text(speed.value, speed.expanded_uncertainty, "m/s"));
    if (facts->standing_start &&
        speed.value + speed.expanded_uncertainty.value_or(1.0) > CourseErrors{}.moving_above_m_s)
        return to_attest("{}, too uncertain to tell standing from moving", words).by({slowest});
    if (facts->standing_start)
        return met("{}, which is standing still; what moved it first is not decidable from the "
                   "recording",
                   words)
            .by({slowest});
    if (context.profile.speed_of == SpeedOf::reference_point)
        return to_attest("{}, of the antenna, which may swing while the craft stands", words)
            .by({slowest});
    if (run.began == RunEdge::standing && start_was_seen(run, speed, context))
        return not_met("{}: it was moving when the run began", words).by({slowest});
    return to_attest("{}: {}, so the start was not seen", words,
                     run.began == RunEdge::turn  ? "the run begins with a turn"
                     : run.began == RunEdge::gap ? "the run begins after a gap"
                     : run.began == RunEdge::standing
                         ? "the recording begins with the craft moving, if slowly"
                         : "the recording begins with the craft moving")
        .by({slowest});
}

Finding computation::run_up(const Clause& clause, const ClauseContext& context) {
    const auto& facts = context.course.facts;
    if (!facts) return unknown("{}", context.course.missing);
    return against_limit({.name = run_up_length,
                          .value = facts->run_up_m,
                          .note = fmt::format("in {:.1f} s", facts->run_up_s)},
                         clause);
}

Finding computation::wind_mean(const Clause& clause, const ClauseContext& context) {
    return of_flow("wind", context.wind, &FlowInWindow::mean_m_s, std::nullopt, clause);
}

Finding computation::wind_gust(const Clause& clause, const ClauseContext& context) {
    return of_flow("wind", context.wind, &FlowInWindow::gust_m_s, std::nullopt, clause);
}

Finding computation::current(const Clause& clause, const ClauseContext& context) {
    const auto& series = context.input.attempt.current;
    return of_flow("current", context.current, &FlowInWindow::gust_m_s,
                   series ? series->expanded_uncertainty_m_s : 0.0, clause);
}

std::vector<Figure> course_figures(const ClauseContext& context) {
    std::vector<Figure> figures;
    const auto add = [&](const char* name, const CourseFigure& figure, const char* unit,
                         const char* note = "") {
        const std::optional<double>& u = figure.expanded_uncertainty;
        figures.push_back(
            {.name = name,
             .value = in_unit(figure.value, unit),
             .unit = unit,
             .expanded_uncertainty = u ? std::optional(in_unit(*u, unit)) : std::nullopt,
             .note = note});
    };
    const auto& facts = context.course.facts;
    if (facts) {
        if (facts->height_difference_m)
            add(height_of_track, *facts->height_difference_m, "m",
                "above the ellipsoid; noise makes it larger, never smaller");
        if (facts->slope) add(slope_of_track, *facts->slope, "%", "upwards positive");
        if (const auto& ground = context.course.ground) {
            add(height_of_ground, ground->height_difference_m, "m", "by the surface");
            add(slope_of_ground, ground->slope, "%", "by the surface; upwards positive");
        }
        add("heading", facts->heading_deg, "deg", "from north over east");
        add(off_the_chord, facts->straightness_m, "m");
        add(turned, facts->turning_deg, "deg", "to the right positive");
        add(slowest_before, facts->speed_before_m_s, "m/s",
            facts->standing_start ? "standing still" : "not standing still");
        add(run_up_length, {facts->run_up_m, std::nullopt}, "m");
        add("time of the run-up", {facts->run_up_s, std::nullopt}, "s");
    }
    add_flow_figures(context.wind, "wind", "where it comes from", facts.has_value(), figures);
    add_flow_figures(context.current, "current", "where it sets to", facts.has_value(), figures);
    return figures;
}

}  // namespace runcert
