#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"

namespace runcert {
namespace {

/// By which key of the attempt epochs are left out for that reason, and what to write; or empty.
std::string_view what_decides(Reason reason, const ReceiverFindings& judged) {
    constexpr std::pair<Reason, std::string_view> by_key[] = {
        {Reason::accuracy_absurd, "screen.accuracy_max_m decides"},
        {Reason::few_satellites, "screen.satellites_min decides"},
        {Reason::low_ratio, "screen.ratio_min decides"},
        {Reason::old_corrections, "screen.correction_age_max_s decides"},
        {Reason::short_arc, "screen.min_arc_epochs decides"},
        {Reason::no_position, "where heights alone are missing, give height_m"}};
    if (reason == Reason::float_ambiguities || reason == Reason::other_fix)
        return judged.solution_source == SolutionSource::unknown
                   ? "the recording states no fix type, which counts as single: if they are fixed "
                     "solutions, write solution: fixed in the receiver, a claim that somebody must "
                     "attest"
                   : "to use other fix types, write parameters: {screen: {allowed_fixes: [fixed, "
                     "float, ...]}}";
    if (reason == Reason::accuracy_missing)
        return judged.facts.vertical_measured
                   ? "state it in the attempt, accuracy: {horizontal_m: ..., vertical_m: ...}"
                   : "state it in the attempt, accuracy: {horizontal_m: ...}";
    const auto* const found =
        std::ranges::find(by_key, reason, &std::pair<Reason, std::string_view>::first);
    return found == std::end(by_key) ? std::string_view() : found->second;
}

/// Why no epoch is usable: the three most frequent reasons, with the first epoch of each.
std::string nothing_usable(const ReceiverFindings& judged) {
    constexpr std::size_t named = 3;
    const ScreeningSummary& screening = judged.screening;
    std::int64_t epochs = 0;
    std::vector<std::pair<std::int64_t, Reason>> reasons;
    for (const auto& [reason, count] : screening.reasons) {
        epochs += count;
        if (reason != Reason::none) reasons.emplace_back(count, reason);
    }
    std::stable_sort(reasons.begin(), reasons.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::string> words;
    for (std::size_t i = 0; i < std::min(named, reasons.size()); ++i) {
        const auto [count, reason] = reasons[i];
        const auto& [epoch, time] = screening.first_of.at(reason);
        const std::string_view decides = what_decides(reason, judged);
        words.push_back(fmt::format("{} {} (first epoch {}, {}{}{})", count, words_of(reason),
                                    epoch, instant_text(judged.facts.first_epoch, time),
                                    decides.empty() ? "" : "; ", decides));
    }
    return fmt::format("none of the {} epochs is usable: {}{}", epochs, fmt::join(words, ", "),
                       reasons.size() > named ? ", and other reasons" : "");
}

double longest_stretch_s(const std::vector<TrajectoryEpoch>& rows) {
    double longest_s = 0.0;
    const TrajectoryEpoch* first = nullptr;
    for (const TrajectoryEpoch& row : rows) {
        if (!row.arc || !row.usable) continue;
        if (!first || first->arc != row.arc) first = &row;
        longest_s = std::max(longest_s, row.time.seconds() - first->time.seconds());
    }
    return longest_s;
}

/// Why there is no certifiable window.
std::string why_no_window(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    if (judged.screening.usable == 0) return nothing_usable(judged);
    const std::string wanted = window_words(context.profile);
    std::string evidence = context.windows.missing;
    if (evidence.empty())
        evidence = fmt::format(
            "no {} of the recording are without a break and without an unusable epoch, the longest "
            "arc having {}",
            wanted, time_span_text(longest_stretch_s(judged.trajectory)));
    if (const auto& indicated = context.windows.indicated;
        indicated && !indicated->refusals.empty())
        evidence += fmt::format("; the fastest {} as recorded hold {}", wanted,
                                fmt::join(indicated->refusals, ", "));
    return evidence;
}

/// The times at which the lines of a course were crossed, since the first epoch. A position error
/// is one of time at the craft's speed. The epoch next to a crossing represents it.
std::vector<Figure> crossing_figures(const ClauseContext& context) {
    const CertifiableWindow& best = *context.windows.best;
    std::vector<Figure> figures;
    const auto add = [&](const char* name, std::int64_t epoch, double time_s) {
        const auto& rows = context.input.judged.trajectory;
        const auto row = std::ranges::find(rows, epoch, &TrajectoryEpoch::epoch);
        if (row == rows.end() || !row->sigma_east_m || !row->speed_m_s) return;
        const double slow_m = best.bound ? best.bound->sigma_m : 0.0;
        const double position_m =
            std::hypot(std::max(*row->sigma_east_m, *row->sigma_north_m), slow_m);
        figures.push_back({.name = name,
                           .value = time_s,
                           .unit = "s",
                           .expanded_uncertainty = 2.0 * position_m / *row->speed_m_s,
                           .note = "from the first epoch"});
    };
    const double start_s = best.span.start.seconds();
    add("start line crossed", best.span.first_epoch, start_s);
    add("finish line crossed", best.span.last_epoch, start_s + best.span.duration.seconds());
    return figures;
}

/// The expanded uncertainty in the unit of the rule's limit, rounded up as the page shows it; with
/// its own decimals where those of the page would hide on which side of the limit it is.
std::string uncertainty_at_limit(double uncertainty_m_s, const ClauseContext& context) {
    const SpeedUnit& unit = speed_unit(context.profile.accuracy_unit);
    const double limit_m_s = *context.profile.accuracy_limit_m_s;
    std::string shown = shown_speed(SpeedKind::uncertainty, uncertainty_m_s, *context.shown, unit);
    const bool below = parse_double(shown).value_or(0.0) <= limit_m_s * unit.per_m_s + 1e-9;
    if (below != (uncertainty_m_s <= limit_m_s))
        shown = uncertainty_rounded_up(uncertainty_m_s * unit.per_m_s);
    return fmt::format("{} {}", shown, unit.name);
}

}  // namespace

Figure plain(std::string name, double value, std::string unit) {
    return {.name = std::move(name), .value = value, .unit = std::move(unit)};
}

Figure at_most(Figure figure, double limit) {
    figure.relation = LimitRelation::at_most;
    figure.limit = limit;
    return figure;
}

Figure speed_figure(std::string name, double speed_m_s, const std::string& unit,
                    std::string shown) {
    return {.name = std::move(name),
            .value = speed_m_s / metres_per_second(unit),
            .unit = unit,
            .shown = std::move(shown)};
}

Finding computation::speed_of(const Clause&, const ClauseContext& context) {
    Finding finding =
        to_attest("the rule does not say whose speed counts, and the antenna's is judged");
    const auto& best = context.windows.best;
    if (!best || !context.shown) return finding;
    const CraftSpeeds& points = best->points;
    if (!points.reference_point_speed_m_s) {
        finding.evidence +=
            "; by how much the craft was slower or faster over the window is not known";
        return finding;
    }
    const double craft_m_s = *points.reference_point_speed_m_s;
    const double expanded_m_s = *points.reference_point_expanded_uncertainty_m_s;
    const ComparedSpeeds shown =
        compared_speeds(context, craft_m_s, expanded_m_s, *points.antenna_speed_m_s);
    finding.evidence += fmt::format(
        "; the craft's reference point made {} over the same window, {} against the antenna's {}",
        shown.other, shown.difference, shown.judged);
    if (context.required_speed)
        finding.evidence += fmt::format(
            ": it {} the required {} {}",
            craft_m_s - expanded_m_s >= context.required_speed->speed_m_s  ? "reaches"
            : craft_m_s + expanded_m_s < context.required_speed->speed_m_s ? "stays below"
                                                                           : "may or may not reach",
            context.shown->required_speed, context.shown->unit);
    Figure craft = speed_figure("speed of the craft's reference point", craft_m_s,
                                context.shown->unit, shown.other);
    const double unit_m_s = metres_per_second(context.shown->unit);
    craft.expanded_uncertainty = expanded_m_s / unit_m_s;
    if (context.required_speed) {
        craft.relation = LimitRelation::at_least;
        craft.limit = context.required_speed->speed_m_s / unit_m_s;
    }
    finding.figures = {std::move(craft)};
    return finding;
}

Finding computation::window_complete(const Clause&, const ClauseContext& context) {
    const ProfileWindows& windows = context.windows;
    if (!windows.best) return not_met("{}", why_no_window(context));
    if (!figure_of(windows))
        return not_met(
            "of {} windows of {} that the rule takes the mean of, {} are certifiable without "
            "overlapping",
            context.profile.windows, window_words(context.profile), windows.further.size() + 1);
    const WindowSpan& span = windows.best->span;
    Finding finding =
        met("{:.3f} s from epoch {} to epoch {}, no break and no unusable epoch inside; the {}",
            span.duration.seconds(), span.first_epoch, span.last_epoch,
            windows.candidates == 1 ? "only such window"
                                    : fmt::format("best of {} such windows", windows.candidates));
    if (!windows.further.empty())
        finding.evidence += fmt::format("; with {} more the mean", windows.further.size());
    if (context.profile.window_kind == WindowKind::course)
        finding.figures = crossing_figures(context);
    finding.figures.insert(finding.figures.begin(),
                           plain("length of the window", span.duration.seconds(), "s"));
    return finding;
}

/// Decides whether the fastest speed that the recording shows is the certified one.
Finding computation::fastest_certifiable(const Clause&, const ClauseContext& context) {
    const auto& best = context.windows.best;
    if (!best) return not_met(no_window);
    const auto& indicated = context.windows.indicated;
    if (!indicated || indicated->refusals.empty())
        return met("the fastest window that the recording shows could be certified");
    const double least_m_s = best->speed_m_s + 2.0 * best->standard_uncertainty_m_s;
    const std::string words =
        fmt::format("the recording{} {} {} in a window that cannot be certified ({})",
                    indicated->source == SpeedSource::velocity ? "'s velocities show" : " shows",
                    speed_of_rule(context, indicated->speed_m_s), beginning_text(indicated->span),
                    fmt::join(indicated->refusals, ", "));
    // The standard deviations stated by its own epochs make this much of it worthless.
    Finding finding = indicated->speed_m_s - indicated->stated_expanded_uncertainty_m_s <= least_m_s
                          ? met("{}, which shows no more than the certified one", words)
                          : not_met("{}: what the score would be is not known", words);
    return std::move(finding).by({plain("fastest as recorded", indicated->speed_m_s, "m/s")});
}

Finding computation::opposite_runs(const Clause&, const ClauseContext& context) {
    const ProfileWindows& windows = context.windows;
    if (!windows.best || windows.further.empty())
        return not_met("{}", windows.missing.empty() ? "there are no two certifiable windows"
                                                     : windows.missing);
    const FurtherWindow& other = windows.further.front();
    const WindowSpan &a = windows.best->span, &b = other.span;
    const double from_s = std::min(a.start, b.start).seconds();
    const double to_s = std::max(a.start.seconds() + a.duration.seconds(),
                                 b.start.seconds() + b.duration.seconds());
    const double within_s = *context.profile.opposite_runs_within_s;
    return met("two runs in opposite directions, {} and {}, within {:.1f} s, at most {:g} s",
               speed_of_rule(context, windows.best->speed_m_s),
               speed_of_rule(context, other.speed_m_s), to_s - from_s, within_s)
        .by({plain("speed of the one", windows.best->speed_m_s, "m/s"),
             plain("speed of the other", other.speed_m_s, "m/s"),
             at_most(plain("time that holds both", to_s - from_s, "s"), within_s)});
}

Finding computation::accuracy(const Clause&, const ClauseContext& context) {
    const auto& limit_m_s = context.profile.accuracy_limit_m_s;
    if (!context.speed || !limit_m_s)
        return not_met("there is no certifiable window whose accuracy could be stated");
    const double u = *context.expanded_uncertainty_m_s;
    const double bias_limit_m_s = context.speed->bias_limit_m_s;
    const SpeedUnit& unit = speed_unit(context.profile.accuracy_unit);
    Figure uncertainty = speed_figure("expanded uncertainty", u, std::string(unit.name),
                                      uncertainty_at_limit(u, context));
    uncertainty.relation = LimitRelation::at_most;
    uncertainty.limit = *limit_m_s * unit.per_m_s;
    return {u <= *limit_m_s ? RequirementStatus::met : RequirementStatus::not_met,
            fmt::format(
                "expanded uncertainty {} (k = {}{}), limit {}; {}", uncertainty.shown,
                coverage_text(context.coverage_factor),
                bias_limit_m_s > 0.0 ? fmt::format(", with {} for the choice of the window",
                                                   uncertainty_at_limit(bias_limit_m_s, context))
                                     : "",
                number_text(*uncertainty.limit, unit.name),
                context.profile.speed_source == SpeedSource::velocity
                    ? "it rests on what the recording shows and states of its velocities' errors"
                    : "it includes the bound on time-correlated errors and, as mean square, an "
                      "error of any kind that nothing found"),
            {uncertainty}};
}

Finding computation::margin(const Clause&, const ClauseContext& context) {
    if (context.record == nullptr) return to_attest("the attempt names no record to beat");
    if (!context.speed) return not_met(no_window);
    const Decision& decision = *context.decision;
    const ShownFigures& shown = *context.shown;
    const double unit_m_s = metres_per_second(shown.unit);
    const double required_u = 2.0 * context.required_speed->standard_uncertainty_m_s;
    Figure speed = speed_figure("measured speed", context.speed->speed_m_s, shown.unit,
                                measured_speed_text(shown, context.coverage_factor));
    speed.expanded_uncertainty = *context.expanded_uncertainty_m_s / unit_m_s;
    Figure required = speed_figure("required speed", context.required_speed->speed_m_s, shown.unit,
                                   fmt::format("{} {}", shown.required_speed, shown.unit));
    required.expanded_uncertainty = required_u / unit_m_s;
    if (required_u > 0.0)
        required.shown += fmt::format(" ± {} {} (k = 2)",
                                      in_decimals_of(shown, required_u, SafeSide::up), shown.unit);
    const std::string probability = probability_text(decision.probability);
    return {
        decision.probability >= decision.level ? RequirementStatus::met
                                               : RequirementStatus::not_met,
        fmt::format("measured speed {}, required {} {}: conformance probability {} (at least "
                    "{} required); acceptance limit {} {}",
                    measured_speed_text(shown), shown.required_speed, shown.unit, probability,
                    level_text(decision.level), shown.acceptance_limit, shown.unit),
        {std::move(speed),
         std::move(required),
         {.name = "conformance probability", .value = decision.probability, .shown = probability}}};
}

Finding computation::georeferenced(const Clause&, const ClauseContext& context) {
    if (context.input.judged.facts.georeferenced)
        return met("WGS 84 positions, taken to a local frame without a grid's scale factor");
    return to_attest(
        "the recording holds engineering coordinates, not georeferenced: their unit must be the "
        "true metre on the ground");
}

Finding computation::attest(const Clause&, const ClauseContext&) {
    return to_attest("not decidable from the recording");
}

}  // namespace runcert
