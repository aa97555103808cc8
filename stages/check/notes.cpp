#include "stages/check/notes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/prose.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"
#include "witness/roster.h"

namespace runcert {
namespace {

/// A definition of speed, worded for comparison with others. The full wording of a mean is longer.
std::string_view definition_in_prose(SpeedDefinition definition) {
    if (definition == SpeedDefinition::mean_n_plus_1) return "the mean of all speeds";
    if (definition == SpeedDefinition::mean_n) return "the mean without the first speed";
    return words_of(definition);
}

/// A short description of a rule's speed, for a list.
std::string_view speed_in_short(const Profile& profile) {
    if (profile.speed_source == SpeedSource::velocity) return "recorded velocities";
    switch (profile.definition) {
        case SpeedDefinition::displacement:
        case SpeedDefinition::path_length:
            return words_of(profile.definition);
        case SpeedDefinition::elapsed_time:
            return "length over elapsed time";
        default:
            return "mean of speeds";
    }
}

/// Notes where the definitions of speed disagree on whether the required speed is reached.
void add_straddle(const ClauseContext& context, Sentences& say) {
    const auto& best = context.windows.best;
    if (!best || !context.required_speed || !context.shown ||
        context.profile.speed_source == SpeedSource::velocity ||
        context.profile.dimension == Dimension::space ||
        context.profile.window_kind == WindowKind::course)
        return;
    std::vector<std::string> above, below;
    const ShownFigures& shown = *context.shown;
    for (const SpeedDefinition one : {SpeedDefinition::displacement, SpeedDefinition::path_length,
                                      SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
        const double speed_m_s = speed_by(best->definitions, one);
        (speed_m_s >= context.required_speed->speed_m_s ? above : below)
            .push_back(fmt::format("{} ({} {})", definition_in_prose(one),
                                   in_decimals_of(shown, speed_m_s, SafeSide::down), shown.unit));
    }
    if (above.empty() || below.empty()) return;
    say("The definition of speed matters here: {} would reach the required {} {}, {} would not. "
        "The rule counts {}.",
        fmt::join(above, ", "), shown.required_speed, shown.unit, fmt::join(below, ", "),
        definition_in_prose(context.profile.definition));
}

/// Notes what the surface that the craft ran on says of a receiver's heights, and what it cannot
/// say.
void add_surface(const ReceiverFindings& receiver, Sentences& say) {
    if (!receiver.ground) return;
    const auto& found = receiver.tests.surface;
    if (!found) {
        say("The surface says nothing of receiver \"{}\", whose heights were not measured.",
            receiver.receiver);
        return;
    }
    if (found->offset_removed)
        say("The antenna of receiver \"{}\" is {} m {} where surface and antenna height have it, "
            "everywhere alike: the survey's height datum or the stated height of the antenna is "
            "wrong by that. Positions were compared without it.",
            receiver.receiver, format_fixed(std::abs(found->offset_m), 2),
            found->offset_m > 0.0 ? "above" : "below");
    if (found->outside > 0)
        say("{} of {} usable positions of receiver \"{}\" do not lie over the surface.",
            found->outside, found->outside + found->compared, receiver.receiver);
}

void add_surfaces(const ClauseContext& context, Sentences& say) {
    const ReceiverFindings& judged = context.input.judged;
    add_surface(judged, say);
    if (judged.ground && judged.tests.surface && context.course.facts && !context.course.ground)
        say("The surface does not lie under the whole run; height difference and slope are those "
            "of the track.");
    if (context.input.secondary) add_surface(*context.input.secondary, say);
}

/// The names of witnesses, as "The carrier phases and the displacements by the IMU".
std::string names_of(const std::vector<const WitnessedSpeed*>& witnesses) {
    std::vector<std::string> names;
    for (const WitnessedSpeed* const one : witnesses)
        names.push_back(witness_name(*one));
    return capitalised(listed(names));
}

/// Whether a witness would contradict positions that were off by as much as another one says, by
/// what chance does once in a thousand.
bool would_show(const WitnessedSpeed& one, const WitnessedSpeed& other) {
    constexpr double by_chance = 3.29;
    return !one.compared_over_s &&
           std::abs(other.difference_m_s) >
               by_chance *
                   std::hypot(one.standard_uncertainty_m_s, one.position_standard_uncertainty_m_s);
}

/// What contradicts a window's positions, whether anything that agrees with them speaks against
/// that, and what to check. Empty if nothing contradicts them.
std::string contradiction_of(const std::vector<WitnessedSpeed>& witnesses) {
    std::vector<const WitnessedSpeed*> against, agreeing;
    for (const WitnessedSpeed& one : witnesses)
        if (one.kind != WitnessKind::positions && contradicts(one)) against.push_back(&one);
    if (against.empty()) return {};
    const auto least = std::ranges::min_element(
        against, {}, [](const WitnessedSpeed* one) { return std::abs(one->difference_m_s); });
    for (const WitnessedSpeed& one : witnesses)
        if (one.kind != WitnessKind::positions && !contradicts(one) && would_show(one, **least))
            agreeing.push_back(&one);
    std::string text = names_of(against) + " contradict the positions there";
    if (agreeing.empty())
        text += ", and nothing else says which of them errs.";
    else
        text += fmt::format(
            "{}. {} agree with the positions, and would have shown a difference of that size.",
            against.size() == 1 ? " and stand alone" : "", names_of(agreeing));
    for (const WitnessedSpeed* const one : against)
        text += fmt::format(" {}", witness_entry(one->kind).remedy);
    return text;
}

/// Notes why there is no window, the fastest one where it is not certified, windows of the speed
/// that a witness contradicts, and how a mean is made.
void add_windows(const ClauseContext& context, Sentences& say) {
    const ProfileWindows& windows = context.windows;
    const auto& fastest = windows.fastest;
    if (!windows.missing.empty() && !windows.best)
        say("There is no window{}{}{}", windows.missing.ends_with('.') ? ". " : " because ",
            windows.missing, windows.missing.ends_with('.') ? "" : ".");
    const auto text_of = [&](const auto& window) {
        return speed_with_uncertainty_text(
            window.speed_m_s, expanded_uncertainty_m_s(window, context.coverage_factor),
            context.unit());
    };
    if (const std::string found = fastest ? contradiction_of(fastest->witnesses) : "";
        !found.empty())
        say("The fastest window is not certified: {}, {}. {} A window is certified only where no "
            "witness contradicts it.",
            text_of(*fastest), beginning_text(fastest->span), found);
    for (const FurtherWindow& window : context.counted)
        if (const std::string found = contradiction_of(window.witnesses); !found.empty())
            say("Of the window {}: {}", beginning_text(window.span), found);
    if (fastest && std::ranges::none_of(fastest->witnesses, &contradicts) &&
        !(windows.best && text_of(*windows.best) == text_of(*fastest)))
        say("Another window is faster and proves less: {}, {}. Certified is the window of the "
            "highest speed that can be claimed, its expanded uncertainty taken off.",
            text_of(*fastest), beginning_text(fastest->span));
    if (context.counted.size() > 1 && figure_of(windows)) {
        std::vector<std::string> speeds;
        for (const FurtherWindow& one : context.counted)
            speeds.push_back(speed_of_rule(context, one.speed_m_s));
        say("The speed is the mean of {} windows ({}); their errors are taken as equal, so "
            "averaging does not reduce the uncertainty.",
            speeds.size(), fmt::join(speeds, ", "));
    }
    if (windows.indicated && windows.indicated->mean_m_s)
        say("The unscreened recording shows a mean of {} over as many windows.",
            speed_of_rule(context, *windows.indicated->mean_m_s));
}

/// Names the measurand of a mean of so few samples that it differs from the mean over time.
void add_mean_of_samples(const ClauseContext& context, Sentences& say) {
    const auto& best = context.windows.best;
    const Profile& profile = context.profile;
    const bool both_ends = profile.definition == SpeedDefinition::mean_n_plus_1;
    if (!best || !context.shown || (!both_ends && profile.definition != SpeedDefinition::mean_n))
        return;
    const double samples_m_s = speed_by(best->definitions, profile.definition);
    const double time_m_s = best->definitions.path_length_m_s;
    if (std::abs(samples_m_s - time_m_s) <= 0.1 * *context.expanded_uncertainty_m_s) return;
    const std::string of_samples = in_decimals_of(*context.shown, samples_m_s, SafeSide::down);
    const std::string over_time = in_decimals_of(*context.shown, time_m_s, SafeSide::down);
    say("The rule counts the mean of the {} {}, not the mean over time. The smoothed track gives "
        "{} {} by such samples and {} {} over time ({} {}).",
        context.epochs().size() - (both_ends ? 0 : 1),
        profile.speed_source == SpeedSource::velocity ? "recorded speeds" : "speeds at its epochs",
        of_samples, context.shown->unit, over_time, context.shown->unit,
        signed_difference(over_time, of_samples), context.shown->unit);
}

void add_flow(const ClauseContext& context, Sentences& say) {
    if (const auto between = subtracted_current(context))
        say("The current along the course, {}, is subtracted from {} over the ground.",
            between->current, between->over_ground);
    for (const auto* flow : {&context.wind, &context.current})
        if (*flow && !(*flow)->missing.empty())
            say("The series of the {} gives no figure for the window: {}.",
                flow == &context.wind ? "wind" : "current", (*flow)->missing);
}

/// Notes the result of the second method, whether or not the rule requires one, and witnesses that
/// agree with anything.
void add_second_methods(const ClauseContext& context, Sentences& say) {
    if (const auto& second = context.declared; second && !second->missing.empty())
        say("The second method ({}) gives no figure: {}.", second->method, second->missing);
    else if (second)
        say("By the attempt's own statement, {}", second_method_text(context));
    for (const std::string& one : context.unsure_witnesses)
        say("{}. That is too uncertain to confirm the speed: it would have agreed with another, "
            "too.",
            capitalised(one));
}

/// Notes what would determine the next run's speed well enough, where this one's was not.
void add_next_time(const ClauseContext& context, Sentences& say) {
    const auto& best = context.windows.best;
    if (!best || !best->expected_beside_velocities_m_s || !context.expanded_uncertainty_m_s ||
        context.profile.windows > 1)
        return;
    const double u_m_s = *context.expanded_uncertainty_m_s;
    const auto& limit_m_s = context.profile.accuracy_limit_m_s;
    const auto& decision = context.decision;
    const bool not_proven = decision && decision->probability < decision->level &&
                            decision->probability > 1.0 - decision->level;
    if (!not_proven && !(limit_m_s && u_m_s > *limit_m_s)) return;
    if (2.0 * *best->expected_beside_velocities_m_s > u_m_s) return;
    say("Velocities by the receiver's own Doppler measurement, recorded beside the positions, "
        "would bring this speed to about ± {} {} in the next run.",
        uncertainty_rounded_up(*best->expected_beside_velocities_m_s * context.unit().per_m_s),
        context.unit().name);
}

/// Notes of the rule: whose it is, figures of it that the attempt replaces, what is not confirmed,
/// and what nobody who reads its sources can know, and the body can say.
void add_rule(const Profile& rule, Sentences& say) {
    if (rule.origin == RuleOrigin::own)
        say("The rule {} is the attempt's own. It does not come with the program, and no body's "
            "authority for it was checked.",
            rule.id);
    for (const FigureOverride& one : rule.overrides) {
        const std::string unit = one.unit.empty() ? "" : " " + one.unit;
        say("The attempt replaces a figure of the rule: {} is {:g}{}, not {:g}{} ({}).", one.figure,
            one.used, unit, one.rule, unit, one.reason.empty() ? "no reason is given" : one.reason);
    }
    for (const Clause& clause : rule.clauses)
        if (clause.certainty == Certainty::unconfirmed)
            say("Not confirmed: {}: {}", clause.id, clause.text);
    for (const RuleQuestion& question : rule.questions)
        say("Question for the body: {} ({})", question.text, question.id);
}

double path_m(const std::vector<TrajectoryEpoch>& rows, const CraftRun& run) {
    double length_m = 0.0;
    const TrajectoryEpoch* before = nullptr;
    for (std::size_t i = run.first_row; i <= run.last_row; ++i) {
        const TrajectoryEpoch& row = rows[i];
        if (!row.arc) continue;
        if (before != nullptr)
            length_m += std::hypot(*row.east_m - *before->east_m, *row.north_m - *before->north_m);
        before = &row;
    }
    return length_m;
}

}  // namespace

std::vector<std::string> notes_of(const ClauseContext& context) {
    Sentences say;
    // This must be seen before any figure.
    for (const ReceiverFindings* receiver : {&context.input.judged, context.input.secondary})
        if (receiver && receiver->simulated)
            say("The recording of receiver \"{}\" says that it was simulated: this is an example "
                "of a report, and no craft was measured.",
                receiver->receiver);
    add_straddle(context, say);
    add_windows(context, say);
    add_mean_of_samples(context, say);
    add_surfaces(context, say);
    add_flow(context, say);
    add_second_methods(context, say);
    add_next_time(context, say);
    add_rule(context.profile, say);
    return say.said;
}

std::vector<RunSummary> run_summaries(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    std::vector<RunSummary> summaries;
    for (const CraftRun& run : runs_under(context.profile, judged)) {
        const TrajectoryEpoch& first = judged.trajectory[run.first_row];
        const TrajectoryEpoch& last = judged.trajectory[run.last_row];
        RunSummary& summary = summaries.emplace_back(RunSummary{
            .span = window_span(judged.facts, first.epoch, last.epoch, first.time, last.time),
            .length_m = path_m(judged.trajectory, run),
            .heading_deg =
                azimuth_deg(*last.east_m - *first.east_m, *last.north_m - *first.north_m),
            .began = run.began,
            .ended = run.ended});
        for (std::size_t i = run.first_row; i <= run.last_row; ++i)
            summary.top_speed_m_s =
                std::max(summary.top_speed_m_s, judged.trajectory[i].speed_m_s.value_or(0.0));
    }
    return summaries;
}

std::string compared_rules(const std::vector<Profile>& profiles,
                           const std::vector<ProfileVerdict>& verdicts) {
    std::vector<std::string> speeds;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        if (!verdicts[i].speed_m_s) continue;
        const Profile& profile = profiles[i];
        const ShownFigures shown = shown_of(verdicts[i], rule_unit_name(profile));
        speeds.push_back(fmt::format(
            "{} {} {} ({}{}{}, {})", profile.id, shown.speed, shown.unit,
            profile.windows > 1 ? fmt::format("{} x ", profile.windows) : "", window_words(profile),
            profile.dimension == Dimension::horizontal
                ? ""
                : fmt::format(", {}", to_text(profile.dimension)),
            speed_in_short(profile)));
    }
    if (speeds.size() < 2) return {};
    return fmt::format("The rules do not measure the same: {}.", fmt::join(speeds, "; "));
}

}  // namespace runcert
