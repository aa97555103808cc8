#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "core/text.h"
#include "reports/results/results.h"
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

/// The state in words, in capitals where it must be seen: "met", "NOT MET".
std::string state_text(RequirementStatus status) {
    return status == RequirementStatus::not_met ? upper_case(words_of(status))
                                                : std::string(words_of(status));
}

bool holds(const std::vector<Fact>& facts, const Fact& one) {
    return std::ranges::any_of(
        facts, [&](const Fact& fact) { return fact.name == one.name && fact.value == one.value; });
}

bool holds(const std::vector<std::string>& notes, const std::string& one) {
    return std::ranges::find(notes, one) != notes.end();
}

/// A requirement under a rule.
struct AskedBy {
    const std::string* rule;
    const Requirement* requirement;
};

/// A requirement that several rules have: once what is alike, and beneath it what differs. A rule's
/// text may be quoted where another's is not confirmed.
void add_clause(Block& block, const std::vector<AskedBy>& asked, std::size_t rules) {
    const Requirement& first = *asked.front().requirement;
    const auto alike = [&](auto what) {
        return std::ranges::all_of(asked, [&](const AskedBy& one) {
            return std::invoke(what, *one.requirement) == std::invoke(what, first);
        });
    };
    const bool one_state = alike(&Requirement::status),
               one_evidence = alike(&Requirement::evidence);
    std::vector<std::string> names;
    RequirementStatus worst = first.status;
    for (const AskedBy& one : asked) {
        names.push_back(*one.rule);
        if (one.requirement->status == RequirementStatus::not_met ||
            worst == RequirementStatus::met)
            worst = one.requirement->status;
    }
    TableRow& row = add_row(
        block,
        {one_state ? state_text(first.status) : "by rule",
         fmt::format("{}: {}{}", first.clause, first.text,
                     asked.size() == rules ? "" : fmt::format(" (Asked by {}.)", listed(names))),
         one_evidence ? first.evidence : "by rule, below"},
        std::string(to_text(worst)));
    row.clause = first.clause;
    const auto add_each = [&](auto words) {
        for (const AskedBy& one : asked)
            row.further.push_back(fmt::format("{}: {}", *one.rule, words(*one.requirement)));
    };
    if (one_state && one_evidence)
        for (const Figure& figure : first.figures)
            row.further.push_back(figure_text(figure));
    else
        add_each([&](const Requirement& one) {
            return (one_state ? "" : state_text(one.status) + ": ") + one.evidence;
        });
    if (alike(source_line))
        row.further.push_back(source_line(first));
    else
        add_each(source_line);
}

}  // namespace

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
        for (const Figure& figure : requirement.figures)
            row.further.push_back(figure_text(figure));
        row.further.push_back(source_line(requirement));
    }
    return rows;
}

Block requirements_table(const std::vector<RuleView>& rules) {
    std::vector<AskedBy> asked;
    for (const RuleView& rule : rules)
        for (const Requirement& requirement : rule.verdict.requirements)
            asked.push_back({&rule.profile.id, &requirement});
    Block block = table({"State|13", "Requirement|47", "Evidence|40"});
    block.slot = "clauses";
    for (const auto& clause : grouped(asked, [](const AskedBy&a, const AskedBy&b) {
             return a.requirement->clause == b.requirement->clause &&
                    a.requirement->text == b.requirement->text;
         }))
        add_clause(block, clause, rules.size());
    return block;
}

Block outcome_facts(const ProfileVerdict& verdict, const std::string& vouched_by) {
    OutcomeState state = state_of(verdict);
    state.vouched_by = vouched_by;
    return facts(
        {{"Outcome", outcome_words(state).title + "."}, {"By", rule_identity_text(verdict) + "."}});
}

Block origin_facts(const std::vector<VerdictInput>& origins) {
    Block block = facts({});
    for (const InputsOfOrigin& said : inputs_by_origin(origins))
        add_fact(block, said.label, sentence(said.text));
    return block;
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

SaidOfAll said_of_all(const std::vector<RuleView>& rules, Level from, Level to) {
    if (rules.size() < 2) return {};
    SaidOfAll said{.facts = decision_facts(rules.front(), from, to).facts,
                   .notes = rules.front().verdict.notes};
    for (const RuleView& rule : rules) {
        const std::vector<Fact> own = decision_facts(rule, from, to).facts;
        std::erase_if(said.facts, [&](const Fact& fact) { return !holds(own, fact); });
        std::erase_if(said.notes,
                      [&](const auto& note) { return !holds(rule.verdict.notes, note); });
    }
    return said;
}

std::vector<Block> verdict_blocks(const RuleView& rule, Level from, Level to,
                                  const SaidOfAll& said) {
    const ProfileVerdict& verdict = rule.verdict;
    Block block = decision_facts(rule, from, to);
    std::erase_if(block.facts, [&](const Fact& fact) { return holds(said.facts, fact); });
    std::vector<Block> blocks{paragraph(sentence(verdict.reason)), std::move(block)};
    if (rule.windows != nullptr && !rule.windows->missing.empty())
        blocks.push_back(paragraph(fmt::format("What is missing: {}.", rule.windows->missing)));
    const auto count = [&](RequirementStatus status) {
        return std::ranges::count(verdict.requirements, status, &Requirement::status);
    };
    blocks.push_back(
        paragraph(fmt::format("{} in all: {} met, {} not met, {} to be attested. Standing: {}.",
                              counted(std::ssize(verdict.requirements), "requirement"),
                              count(RequirementStatus::met), count(RequirementStatus::not_met),
                              count(RequirementStatus::attest), standing_text(verdict.standing)),
                  "strong"));
    blocks.back().slot = "standing/" + verdict.profile;
    std::vector<std::string> notes = verdict.notes;
    std::erase_if(notes, [&](const std::string& note) {
        return holds(said.notes, note) ||
               std::ranges::any_of(verdict.overrides, [&](const Override& figure) {
                   return note.find(figure.figure) != std::string::npos;
               });
    });
    if (!notes.empty()) blocks.push_back(list_of(std::move(notes)));
    if (!verdict.overrides.empty()) blocks.push_back(overrides_table(verdict));
    std::vector<std::string> unconfirmed;
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.certainty == Certainty::unconfirmed && !rule.several)
            unconfirmed.push_back(fmt::format("{}: {} Source: {}", requirement.clause,
                                              requirement.text, sentence(requirement.source)));
    if (!unconfirmed.empty())
        blocks.push_back(
            titled_list("What could not be confirmed of the rule", std::move(unconfirmed)));
    return blocks;
}

}  // namespace runcert
