#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "reports/results/results.h"
#include "reports/words/decision.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

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

std::vector<std::string> requirement_lines(const Requirement& requirement) {
    std::vector<std::string> lines;
    for (const Figure& figure : requirement.figures)
        lines.push_back(figure_text(figure));
    lines.push_back(source_line(requirement));
    return lines;
}

Block requirement_rows(const ProfileVerdict& verdict, Level level) {
    const bool whole = level >= Level::record;
    Block rows = whole ? table({"state", "clause", "decided by"}, "Requirements") : table({"", ""});
    for (const Requirement& requirement : verdict.requirements) {
        const std::string doubt = requirement.certainty == Certainty::unconfirmed
                                      ? " (Not confirmed that the rule says so.)"
                                      : "";
        TableRow& row = add_row(rows, {state_text(requirement.status), requirement.clause},
                                std::string(to_text(requirement.status)));
        row.clause = requirement.clause;
        row.further = {sentence(requirement.text) + doubt, sentence(requirement.evidence)};
        if (!whole) continue;
        row.cells.emplace_back(to_text(requirement.decided_by));
        std::ranges::move(requirement_lines(requirement), std::back_inserter(row.further));
    }
    return rows;
}

Block outcome_facts(const ProfileVerdict& verdict, const std::string& vouched_by) {
    OutcomeState state = state_of(verdict);
    state.vouched_by = vouched_by;
    return facts(
        {{"Outcome", outcome_words(state).title + "."}, {"By", rule_identity_text(verdict) + "."}});
}

Block origin_facts(const std::vector<VerdictInput>& origins) {
    Block told = facts({});
    for (const InputsOfOrigin& said : inputs_by_origin(origins))
        add_fact(told, said.label, sentence(said.text));
    return told;
}

std::vector<std::string> override_words(const ProfileVerdict& verdict,
                                        const std::vector<std::string>& names) {
    std::vector<std::string> words;
    for (const Override& figure : verdict.overrides)
        if (std::ranges::find(names, figure.figure) != names.end())
            words.push_back(fmt::format(
                "{} is {} in place of the rule's {}. {}", figure.figure,
                number_text(figure.used, figure.unit), number_text(figure.rule, figure.unit),
                figure.reason.empty() ? "The attempt gives no reason."
                                      : sentence("Reason: " + figure.reason)));
    return words;
}

std::vector<Block> verdict_blocks(const RuleView& rule, Level from, Level to,
                                  const SaidOfAll& said) {
    const ProfileVerdict& verdict = rule.verdict;
    Block told = decision_facts(rule, from, to);
    std::erase_if(told.facts, [&](const Fact& fact) { return holds(said.facts, fact); });
    std::vector<Block> blocks{paragraph(sentence(verdict.reason)), std::move(told)};
    if (rule.windows != nullptr && !rule.windows->missing.empty())
        blocks.push_back(paragraph(fmt::format("What is missing: {}.", rule.windows->missing)));
    blocks.push_back(standing_block(verdict));
    std::vector<std::string> notes = verdict.notes;
    std::erase_if(notes, [&](const std::string& note) {
        return std::ranges::find(said.notes, note) != said.notes.end() ||
               std::ranges::any_of(verdict.overrides, [&](const Override& figure) {
                   return note.find(figure.figure) != std::string::npos;
               });
    });
    if (!notes.empty()) blocks.push_back(list_of(std::move(notes)));
    if (!verdict.overrides.empty()) blocks.push_back(overrides_table(verdict));
    if (auto items = unconfirmed(verdict); !items.empty() && !rule.several)
        blocks.push_back(titled_list("What could not be confirmed of the rule", std::move(items)));
    return blocks;
}

}  // namespace runcert
