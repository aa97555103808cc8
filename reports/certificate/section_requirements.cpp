#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "reports/words/outcome.h"

namespace runcert {
namespace {

std::string decision_rule(const RuleView& rule) {
    const double level =
        rule.verdict.decision ? rule.verdict.decision->level : rule.profile.decision_probability;
    const std::string silent = silent_rule_text(rule.profile);
    return fmt::format(
               "Decision rule: it goes by the conformance probability, that the true speed reaches "
               "the required speed. At least {} counts as beaten, at most {} as not beaten, and "
               "anything between as not proven (guarded acceptance and rejection, JCGM 106).",
               level_text(level), level_text(1.0 - level)) +
           (silent.empty() ? "" : " " + silent);
}

std::string decision_words(const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    const Decision& decision = *verdict.decision;
    const SpeedUnit& unit = rule.unit();
    std::string words = verdict.outcome == Outcome::not_certifiable
                            ? "The speed cannot be certified, so that no comparison counts. "
                            : "";
    words += fmt::format("Conformance probability: {} (at least {} required).",
                         probability_text(decision.probability), level_text(decision.level));
    if (decision.required_speed_standard_uncertainty_m_s > 0.0)
        words += fmt::format(
            " It includes the standard uncertainty of the record itself, {} {} of the required "
            "speed.",
            uncertainty_text(decision.required_speed_standard_uncertainty_m_s * unit.per_m_s),
            unit.name);
    if (decision.attempts_made > 1)
        words += fmt::format(" As the best of {} attempts it needs {}.", decision.attempts_made,
                             level_text(decision.level));
    for (const std::string& more : decision_sentences(verdict, unit))
        words += " " + more;
    return words;
}

/// "From a secondary source: press reports", "This program's own requirement".
std::string source_line(const Requirement& requirement) {
    const std::string source = source_text(requirement);
    if (source.starts_with("this program's own")) return capitalised(source);
    return fmt::format("{}: {}", capitalised(words_of(requirement.certainty)), source);
}

Block requirements_table(const RuleView& rule) {
    Block block = table({"State|13", "Requirement|47", "Evidence|40"});
    block.slot = "clauses/" + rule.verdict.profile;
    for (const Requirement& requirement : rule.verdict.requirements) {
        TableRow& row = add_row(
            block,
            {std::string(words_of(requirement.status)),
             fmt::format("{}: {}", requirement.clause, requirement.text), requirement.evidence},
            std::string(to_text(requirement.status)));
        row.clause = requirement.clause;
        for (const Figure& figure : requirement.figures)
            row.further.push_back(fmt::format("{}: {}{}{}", figure.name, figure_value_text(figure),
                                              figure.note.empty() ? "" : "; ", figure.note));
        row.further.push_back(source_line(requirement));
    }
    return block;
}

void add_overrides(Section& section, const RuleView& rule) {
    if (rule.verdict.overrides.empty()) return;
    Block block = table({"Figure|34", ">The rule's|15", ">Used|15", "Reason|36"},
                        "Figures of the rule that the attempt replaced");
    for (const Override& figure : rule.verdict.overrides)
        add_row(block,
                {figure.figure, number_text(figure.rule, figure.unit),
                 number_text(figure.used, figure.unit),
                 figure.reason.empty() ? "none given" : figure.reason},
                "changed");
    add(section, std::move(block));
}

void add_unconfirmed(Section& section, const RuleView& rule) {
    std::vector<std::string> items;
    for (const Requirement& requirement : rule.verdict.requirements)
        if (requirement.certainty == Certainty::unconfirmed)
            items.push_back(fmt::format("{}: {} Source: {}", requirement.clause, requirement.text,
                                        sentence(requirement.source)));
    if (items.empty()) return;
    Block block = list_of(std::move(items));
    block.text = "What could not be confirmed of the rule";
    add(section, std::move(block));
}

void add_requirements_of(Section& section, const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    if (rule.inputs.profiles.size() > 1)
        add(section, heading(fmt::format("Rule “{}”: {}, {}", verdict.profile, verdict.title,
                                         verdict.body)));
    add(section, paragraph(verdict.reason));
    if (verdict.decision) add(section, paragraph(decision_words(rule)));
    if (rule.windows != nullptr && !rule.windows->missing.empty())
        add(section, paragraph(fmt::format("What is missing: {}.", rule.windows->missing)));
    Block standing =
        paragraph(fmt::format("{} in all: {}. Standing: {}.",
                              counted(std::ssize(verdict.requirements), "requirement"),
                              requirement_counts(verdict), standing_text(verdict.standing)),
                  "strong");
    standing.slot = "standing/" + verdict.profile;
    add(section, std::move(standing));
    add(section, requirements_table(rule));
    if (!verdict.notes.empty()) add(section, list_of(verdict.notes));
    add_overrides(section, rule);
    add_unconfirmed(section, rule);
    add(section, paragraph(fmt::format("{} {} {}", rule_words(rule.profile), decision_rule(rule),
                                       agreement_text(rule.inputs.attempt.decision_rule_agreed,
                                                      verdict.window)),
                           "note"));
}

}  // namespace

Section requirements_section(const ReportInputs& inputs) {
    Section section{.anchor = "requirements", .title = "Requirements of the rules"};
    for (const RuleView& rule : rule_views(inputs))
        add_requirements_of(section, rule);
    Block said = facts({}, "Who says what the figures rest on");
    for (const InputsOfOrigin& one : inputs_by_origin(inputs.verdict.origins))
        add_fact(said, one.label, one.text);
    if (!said.facts.empty()) add(section, std::move(said));
    Block answers = facts({}, "Answers");
    answers.slot = "answers";
    add_fact(answers, "Given", "none when this report was made");
    add(section, std::move(answers));
    return section;
}

}  // namespace runcert
