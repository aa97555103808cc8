#include <fmt/format.h>

#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/explain/parts.h"
#include "reports/explain/words.h"

namespace runcert {
namespace {

std::string title(const ProfileView& view) {
    return heading(
        words_of(view.verdict.outcome),
        fmt::format("{}: {}, {}", view.verdict.profile, view.verdict.title, view.verdict.body));
}

std::string window_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    if (!verdict.window)
        return fmt::format("None of {} could be certified.", window_words(view.profile));
    const WindowSpan& span = *verdict.window;
    const std::string asked =
        view.profile.opposite_runs_within_s
            ? fmt::format("The rule asks for the mean of two runs over {}. The faster:",
                          window_words(view.profile))
        : view.profile.windows > 1
            ? fmt::format("The rule asks for the mean of {} windows of {}. The fastest:",
                          view.profile.windows, window_words(view.profile))
            : fmt::format("The rule asks for {}. The window:", window_words(view.profile));
    return fmt::format("{} {} s from {} s after the first epoch{}.", asked,
                       format_fixed(span.duration.seconds(), 3),
                       format_fixed(span.start.seconds(), 3),
                       span.start_gps ? " (" + to_utc_iso(*span.start_gps, 3) + ")" : "");
}

std::string record_text(const ProfileView& view) {
    const auto& record = view.verdict.record;
    if (!record) return "The attempt names none.";
    const std::string own =
        record->expanded_uncertainty && *record->expanded_uncertainty > 0.0
            ? fmt::format("Its own expanded uncertainty is {} (k = 2).",
                          plain_figure(*record->expanded_uncertainty, record->unit))
            : "No uncertainty of its own is stated, so that it is taken as exact.";
    return fmt::format("{}, by: {} {}", plain_figure(record->speed, record->unit),
                       sentence(record->source), own);
}

std::string speed_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    std::string text = fmt::format("{}.", speed_words(*verdict.speed_m_s, unit_of(view)));
    if (verdict.shown)
        text += fmt::format(" To be read as {} {}, rounded down.", verdict.shown->speed,
                            verdict.shown->unit);
    if (verdict.current_subtracted_m_s)
        text += fmt::format(
            " The current's component along the course, {}, has been subtracted from it.",
            speed_words(*verdict.current_subtracted_m_s, unit_of(view)));
    return text;
}

std::string uncertainty_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    const std::string unit = unit_of(view);
    const double expanded_m_s = verdict.expanded_uncertainty_m_s.value_or(0.0);
    const double limit_m_s = verdict.decision ? verdict.decision->bias_limit_m_s : 0.0;
    const double standard_m_s = (expanded_m_s - limit_m_s) / verdict.coverage_factor;
    std::string text =
        limit_m_s > 0.0
            ? fmt::format(
                  "{} expanded: {:.3g} times the standard uncertainty, {}, and the limit of what "
                  "choosing the fastest window may have left in the speed, {}.",
                  uncertainty_words(expanded_m_s, unit), verdict.coverage_factor,
                  uncertainty_words(standard_m_s, unit), uncertainty_words(limit_m_s, unit))
            : fmt::format("{} expanded (k = {:.3g}), so {} standard.",
                          uncertainty_words(expanded_m_s, unit), verdict.coverage_factor,
                          uncertainty_words(standard_m_s, unit));
    if (verdict.decision && verdict.decision->required_speed_standard_uncertainty_m_s > 0.0)
        text += fmt::format(
            " The required speed has a standard uncertainty of {}, from the record's own; the two "
            "are combined.",
            uncertainty_words(verdict.decision->required_speed_standard_uncertainty_m_s, unit));
    return text;
}

std::string why_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    if (verdict.outcome == Outcome::not_certifiable)
        return "The speed cannot be certified, so that no comparison with a record counts: " +
               sentence(verdict.reason);
    if (!verdict.decision) return sentence(verdict.reason);
    const Decision& decision = *verdict.decision;
    const std::string probability = probability_text(decision.probability);
    const std::string level = level_text(decision.level);
    const std::string refusal = level_text(1.0 - decision.level);
    if (verdict.outcome == Outcome::beaten)
        return fmt::format(
            "Beaten, because the conformance probability is {}, at least the {} required.",
            probability, level);
    if (verdict.outcome == Outcome::not_beaten)
        return fmt::format(
            "Not beaten, because the conformance probability is {}, at most {}: the required speed "
            "was missed as surely as the rule wants it reached.",
            probability, refusal);
    return fmt::format(
        "Not proven, because the conformance probability of {} is below the {} required and above "
        "{}: the uncertainty leaves both open. A more accurate measurement of the same run could "
        "decide it.",
        probability, level, refusal);
}

std::string level_sentence(const Decision& decision) {
    const std::string why =
        decision.attempts_made > 1
            ? fmt::format("As the best of {} attempts it may take one share of the risk. So ",
                          decision.attempts_made)
            : std::string();
    return why + fmt::format(
                     "{} or more counts as beaten, {} or less as not beaten, and anything between "
                     "as not proven (guarded acceptance and rejection, JCGM 106).",
                     level_text(decision.level), level_text(1.0 - decision.level));
}

/// What compares the speed with a record.
std::string comparison_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    const std::string unit = unit_of(view);
    std::string text = labelled("Record", record_text(view));
    if (verdict.required_speed_m_s) {
        text +=
            labelled("Margin", fmt::format("The rule asks for {}; {}.", margin_words(view.profile),
                                           rounding_words(view.profile)));
        text += labelled("Required speed", speed_words(*verdict.required_speed_m_s, unit) + ".");
    }
    if (verdict.speed_m_s) {
        text += labelled("Speed", speed_text(view));
        text += labelled("Uncertainty", uncertainty_text(view));
    }
    if (verdict.decision) {
        text += labelled("Conformance", probability_text(verdict.decision->probability) +
                                            " that the true speed reaches the required speed.");
        text += labelled("Level", level_sentence(*verdict.decision));
        text += labelled("Acceptance limit",
                         fmt::format("{}: the least speed that would count as beaten with this "
                                     "uncertainty.",
                                     speed_words(verdict.decision->acceptance_limit_m_s, unit)));
    }
    return text;
}

}  // namespace

std::string decision_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    std::string text = title(view);
    text += labelled("Window", window_text(view));
    text += comparison_text(view);
    text += labelled("Why", why_text(view));
    for (const std::string& words : override_words(verdict, {}))
        text += labelled("Replaced", words);
    for (const std::string& note : notes_of(verdict))
        text += labelled("Note", note);
    if (verdict.indicated)
        text += labelled("Refused",
                         fmt::format("{} at {} s, of the raw positions: {}.",
                                     speed_words(verdict.indicated->speed_m_s, unit_of(view)),
                                     format_fixed(verdict.indicated->span.start.seconds(), 3),
                                     listed(verdict.indicated->refusals)));
    return text;
}

std::string decision_in_short(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    std::string text = title(view);
    if (const std::string speed = speed_shown(view); !speed.empty()) {
        const std::string unit = unit_of(view);
        const std::string required_speed =
            !verdict.required_speed_m_s ? ""
            : verdict.shown && !verdict.shown->required_speed.empty()
                ? fmt::format("; required {} {}", verdict.shown->required_speed, unit)
                : fmt::format("; required {}", speed_words(*verdict.required_speed_m_s, unit));
        text += labelled("Speed", speed + required_speed);
    }
    if (verdict.decision && verdict.outcome != Outcome::not_certifiable)
        text += labelled("Conformance", fmt::format("probability {} (at least {} required)",
                                                    probability_text(verdict.decision->probability),
                                                    level_text(verdict.decision->level)));
    return text + labelled("Why", sentence(verdict.reason));
}

}  // namespace runcert
