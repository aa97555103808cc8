#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

std::string decision_words(const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    const Decision& decision = *verdict.decision;
    const SpeedUnit& unit = rule.unit();
    std::string words = verdict.outcome == Outcome::not_certifiable
                            ? "The speed cannot be certified, so that no comparison counts. "
                            : "";
    words += fmt::format("Conformance probability: {}.", conformance_text(decision));
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

Block overrides_table(const ProfileVerdict& verdict) {
    Block block = table({"Figure|34", ">The rule's|15", ">Used|15", "Reason|36"},
                        "Figures of the rule that the attempt replaced");
    for (const Override& figure : verdict.overrides)
        add_row(block,
                {figure.figure, number_text(figure.rule, figure.unit),
                 number_text(figure.used, figure.unit),
                 figure.reason.empty() ? "none given" : figure.reason},
                "changed");
    return block;
}

std::vector<std::string> unconfirmed(const ProfileVerdict& verdict) {
    std::vector<std::string> items;
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.certainty == Certainty::unconfirmed)
            items.push_back(fmt::format("{}: {} Source: {}", requirement.clause, requirement.text,
                                        sentence(requirement.source)));
    return items;
}

Block standing_block(const ProfileVerdict& verdict) {
    Block standing =
        paragraph(fmt::format("{} in all: {}. Standing: {}.",
                              counted(std::ssize(verdict.requirements), "requirement"),
                              requirement_counts(verdict), standing_text(verdict.standing)),
                  "strong");
    standing.slot = "standing/" + verdict.profile;
    return standing;
}

}  // namespace

std::string state_text(RequirementStatus status) {
    return status == RequirementStatus::not_met ? upper_case(words_of(status))
                                                : std::string(words_of(status));
}

TableRow requirement_row(const Requirement& requirement) {
    const std::string doubt = requirement.certainty == Certainty::unconfirmed
                                  ? " (Not confirmed that the rule says so.)"
                                  : "";
    return {.cells = {state_text(requirement.status), requirement.clause},
            .mark = std::string(to_text(requirement.status)),
            .clause = requirement.clause,
            .further = {sentence(requirement.text) + doubt, sentence(requirement.evidence)}};
}

std::vector<std::string> requirement_lines(const Requirement& requirement) {
    std::vector<std::string> lines;
    for (const Figure& figure : requirement.figures)
        lines.push_back(figure_text(figure));
    lines.push_back(source_line(requirement));
    return lines;
}

std::vector<std::string> override_words(const ProfileVerdict& verdict,
                                        const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const Override& figure : verdict.overrides)
        if (names.empty() || std::ranges::find(names, figure.figure) != names.end())
            words.push_back(fmt::format(
                "{} is {} in place of the rule's {}. {}", figure.figure,
                number_text(figure.used, figure.unit), number_text(figure.rule, figure.unit),
                figure.reason.empty() ? "The attempt gives no reason."
                                      : sentence("Reason: " + figure.reason)));
    return words;
}

Block requirements_table(const RuleView& rule) {
    Block block = table({"State|13", "Requirement|47", "Evidence|40"});
    block.slot = "clauses/" + rule.verdict.profile;
    for (const Requirement& requirement : rule.verdict.requirements) {
        TableRow& row = add_row(
            block,
            {state_text(requirement.status),
             fmt::format("{}: {}", requirement.clause, requirement.text), requirement.evidence},
            std::string(to_text(requirement.status)));
        row.clause = requirement.clause;
        row.further = requirement_lines(requirement);
    }
    return block;
}

std::vector<Block> verdict_blocks(const RuleView& rule, Block requirements,
                                  const std::vector<std::string>& said) {
    const ProfileVerdict& verdict = rule.verdict;
    std::vector<Block> blocks{paragraph(verdict.reason)};
    if (verdict.decision) blocks.push_back(paragraph(decision_words(rule)));
    if (rule.windows != nullptr && !rule.windows->missing.empty())
        blocks.push_back(paragraph(fmt::format("What is missing: {}.", rule.windows->missing)));
    blocks.push_back(standing_block(verdict));
    if (!requirements.rows.empty()) blocks.push_back(std::move(requirements));
    std::vector<std::string> notes = verdict.notes;
    std::erase_if(notes, [&](const std::string& note) {
        return std::ranges::find(said, note) != said.end();
    });
    if (!notes.empty()) blocks.push_back(list_of(std::move(notes)));
    if (!verdict.overrides.empty()) blocks.push_back(overrides_table(verdict));
    if (auto items = unconfirmed(verdict); !items.empty())
        blocks.push_back(titled_list("What could not be confirmed of the rule", std::move(items)));
    blocks.push_back(
        paragraph(fmt::format("{} Decision rule: it goes by the conformance probability, that the "
                              "true speed reaches the required speed. {} {}",
                              rule_words(rule.profile), decision_rule_text(rule.profile, verdict),
                              agreement_text(rule.attempt.decision_rule_agreed, verdict.window)),
                  "note"));
    return blocks;
}

}  // namespace runcert
