#include <fmt/format.h>

#include <algorithm>

#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/explain/parts.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

std::string window_complete_words(const Profile& profile) {
    const std::string ends = profile.ends == WindowEnds::any
                                 ? "beginning and ending at any instant"
                                 : "beginning and ending at measured epochs";
    return fmt::format(
        "Every stretch of {}, {}, is looked at. Those that hold a break of the recording or an "
        "epoch that screening left out are passed over. Met where {} left: the fastest {} the "
        "speed. No uncertainty enters.",
        window_words(profile),
        profile.window_kind == WindowKind::course ? "from one line to the other" : ends,
        profile.windows == 1
            ? std::string("one is")
            : fmt::format("{} that do not overlap are", counted(profile.windows, "stretch")),
        profile.windows == 1 ? "gives" : "give");
}

std::string accuracy_words(const ClauseView& view) {
    const Profile& profile = view.of.profile;
    return fmt::format(
        "The expanded uncertainty of the speed is {:.3g} times the combined standard uncertainty "
        "of its budget. What choosing the fastest window may have left in the speed is added. The "
        "factor is the rule's k = {:.3g}, or more where the budget has few degrees "
        "of freedom. Met where it is at most the limit.",
        view.of.verdict.coverage_factor, profile.coverage_factor);
}

std::string margin_clause_words(const Profile& profile) {
    return fmt::format(
        "The required speed is {}; {}. From the speed and its standard uncertainty, the record's "
        "own taken in where it has one, follows the probability that the true speed reaches it. "
        "Met where that is at least {}: this is the decision itself, which `decision` explains.",
        margin_words(profile), rounding_words(profile), level_text(profile.decision_probability));
}

std::string bound_words(Computation computation) {
    const ClauseLimit limit = limit_of(computation);
    // Its own words say when it is met: below its limit nothing is refused.
    if (limit.units.empty() || computation == Computation::least_speed) return {};
    return fmt::format(
        " Met where it is {0} the limit with all of its expanded uncertainty, not met where it is "
        "{1} the limit with all of it. In between the recording does not decide it, and an "
        "official must attest it.",
        limit.at_most ? "at most" : "at least", limit.at_most ? "above" : "below");
}

std::string how(const ClauseView& view) {
    const Profile& profile = view.of.profile;
    const Computation computation = view.requirement.decided_by;
    switch (computation) {
        case Computation::window_complete:
            return window_complete_words(profile);
        case Computation::accuracy:
            return accuracy_words(view);
        case Computation::margin:
            return margin_clause_words(profile);
        default:
            break;
    }
    std::string words(words_of(computation));
    words += bound_words(computation);
    if (computation == Computation::opposite_runs && profile.opposite_runs_within_s)
        words += fmt::format(" Met where both lie within {}.",
                             number_text(*profile.opposite_runs_within_s, "s"));
    return words;
}

std::string certainty_words(Certainty certainty, RuleOrigin origin) {
    switch (certainty) {
        case Certainty::quoted:
            return origin == RuleOrigin::own
                       ? "The attempt's own rule says so; nobody checked whether a body's does."
                       : "These are the rule's own words, or this program's own rule.";
        case Certainty::secondary:
            return "The rule text was unavailable; the wording is from a secondary source. Compare "
                   "it with the body's text before relying on it.";
        case Certainty::unconfirmed:
            break;
    }
    return "It could not be confirmed that the rule has this clause, or that it says so: ask the "
           "body.";
}

/// The figures of a profile, as an attempt names them, on which a clause hangs.
std::vector<std::string> figures_behind(const ClauseView& view) {
    switch (view.requirement.decided_by) {
        case Computation::window_complete:
            return {"window.duration_s", "window.distance_m"};
        case Computation::accuracy:
            return {"accuracy.limit", "accuracy.coverage_factor"};
        case Computation::margin:
            return {"margin.value", "decision.probability"};
        case Computation::opposite_runs:
            return {"opposite_runs.within_s"};
        default:
            return {fmt::format("clauses.{}.limit", view.requirement.clause)};
    }
}

std::string outcome_sentence(const Requirement& requirement) {
    const std::string evidence = sentence(requirement.evidence);
    if (requirement.status == RequirementStatus::met) return "Met. " + evidence;
    if (requirement.status == RequirementStatus::not_met) return "Not met. " + evidence;
    return "To be attested. " + evidence;
}

/// How a computation makes its figure and compares it, in sentences.
std::string computation_words(const ClauseView& view) {
    const Computation computation = view.requirement.decided_by;
    if (computation == Computation::attest) return std::string(words_of(computation));
    return fmt::format("{}. {}", to_text(computation), how(view));
}

}  // namespace

std::string ClauseView::limit() const {
    const Profile& profile = of.profile;
    if (requirement.decided_by == Computation::accuracy && profile.accuracy_limit_m_s)
        return number_text(*profile.accuracy_limit_m_s / metres_per_second(profile.accuracy_unit),
                           profile.accuracy_unit);
    return clause != nullptr && clause->limit ? number_text(*clause->limit, clause->unit) : "";
}

std::vector<std::string> ClauseView::answers() const {
    const auto found = options.answers.find(of.verdict.profile + "/" + requirement.clause);
    return found == options.answers.end() ? std::vector<std::string>() : found->second;
}

Section clause_section(const ClauseView& view) {
    const Requirement& requirement = view.requirement;
    const std::string name = fmt::format("{}/{}", view.of.verdict.profile, requirement.clause);
    Block told =
        facts({{"The rule", requirement.text},
               {"Its source",
                fmt::format("{} {}", sentence(source_text(requirement)),
                            certainty_words(requirement.certainty, view.of.profile.origin))},
               {"Decided by", computation_words(view)}});
    for (const Figure& figure : requirement.figures)
        add_fact(told, "Figure", sentence(figure_text(figure)));
    add_fact(told, "Limit", view.limit());
    for (std::string& words : override_words(view.of.verdict, figures_behind(view)))
        add_fact(told, "Replaced", std::move(words));
    add_fact(told, "Outcome", outcome_sentence(requirement));
    if (requirement.status == RequirementStatus::attest)
        add_fact(told, "To do", std::string(phrase_of(view.requirement.decided_by)));
    if (requirement.answered_by)
        add_fact(told, "Answered by",
                 fmt::format("{} in the role {}", requirement.answered_by->count,
                             requirement.answered_by->role));
    for (std::string& answer : view.answers())
        add_fact(told, "Answer", std::move(answer));
    return {.anchor = name,
            .title = fmt::format("{}: {}", name, upper_case(words_of(requirement.status))),
            .blocks = {std::move(told)}};
}

}  // namespace runcert
