#include <fmt/format.h>

#include "core/speed_unit.h"
#include "reports/explain/parts.h"
#include "reports/explain/words.h"

namespace runcert {
namespace {

std::string certainty_words(Certainty certainty) {
    switch (certainty) {
        case Certainty::quoted:
            return "These are the rule's own words, or this program's own rule.";
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

}  // namespace

std::string ClauseView::limit() const {
    const Profile& profile = of.profile;
    if (requirement.decided_by == Computation::accuracy && profile.accuracy_limit_m_s)
        return number_text(*profile.accuracy_limit_m_s / metres_per_second(profile.accuracy_unit),
                           profile.accuracy_unit);
    return clause != nullptr && clause->limit ? number_text(*clause->limit, clause->unit) : "";
}

std::vector<std::string> ClauseView::answers() const {
    const auto found = of.options.answers.find(of.verdict.profile + "/" + requirement.clause);
    return found == of.options.answers.end() ? std::vector<std::string>() : found->second;
}

std::string clause_text(const ClauseView& view) {
    const Requirement& requirement = view.requirement;
    std::string text = heading(words_of(requirement.status),
                               fmt::format("{}/{}", view.of.verdict.profile, requirement.clause));
    text += labelled("The rule", requirement.text);
    text += labelled("Its source", fmt::format("{} {}", sentence(requirement.source),
                                               certainty_words(requirement.certainty)));
    text += labelled("Decided by", computation_words(view));
    for (std::size_t i = 0; i < requirement.figures.size(); ++i)
        text += labelled(i == 0 ? "Figures" : "", sentence(figure_text(requirement.figures[i])));
    if (const std::string limit = view.limit(); !limit.empty()) text += labelled("Limit", limit);
    for (const std::string& words : override_words(view.of.verdict, figures_behind(view)))
        text += labelled("Replaced", words);
    text += labelled("Outcome", outcome_sentence(requirement));
    if (requirement.status == RequirementStatus::attest)
        text += labelled("To do", std::string(phrase_of(view.requirement.decided_by)));
    if (requirement.answered_by)
        text +=
            labelled("Answered by", fmt::format("{} in the role {}", requirement.answered_by->count,
                                                requirement.answered_by->role));
    for (const std::string& answer : view.answers())
        text += labelled("Answers", answer);
    return text;
}

std::string clause_in_short(const ClauseView& view) {
    const Requirement& requirement = view.requirement;
    constexpr std::size_t indent = 13;
    const std::string blanks(indent, ' ');
    std::string text = fmt::format("  {:<{}}{}", upper_case(words_of(requirement.status)),
                                   indent - 2, wrapped(requirement.clause, indent, indent));
    const std::string doubt = requirement.certainty == Certainty::unconfirmed
                                  ? " (Not confirmed that the rule says so.)"
                                  : "";
    text += blanks + wrapped(requirement.text + doubt, indent, indent);
    text += blanks + wrapped(sentence(requirement.evidence), indent, indent);
    for (const std::string& answer : view.answers())
        text += blanks + wrapped(answer, indent, indent);
    return text;
}

}  // namespace runcert
