#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "core/prose.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// A table with a row for each rule that has a certified window.
Block row_for_each(const std::vector<std::string>& heads, const std::string& title,
                   const std::vector<RuleView>& rules,
                   const std::function<std::vector<std::string>(const RuleView&)>& cells) {
    Block block = table(heads, title, "small");
    for (const RuleView& rule : rules) {
        if (rule.best() == nullptr) continue;
        std::vector<std::string> row = cells(rule);
        row.insert(row.begin(), rule.profile.id);
        add_row(block, std::move(row));
    }
    return block;
}

/// A speed in the rule's unit, with the decimals of its figures; empty where there is none.
std::string speed_of(const RuleView& rule, const std::optional<double>& speed_m_s) {
    return speed_m_s ? shown_speed(SpeedKind::measured, *speed_m_s, rule.shown(), rule.unit()) : "";
}

/// A requirement under a rule.
struct AskedBy {
    const RuleView* rule = nullptr;
    const Requirement* requirement = nullptr;
};

/// Where a requirement is known from, by rule where that differs: one rule's text may be quoted,
/// and another's not be confirmed.
void add_sources(TableRow& row, const std::vector<AskedBy>& asked) {
    const auto source_of = [](const AskedBy& one) {
        return requirement_lines(*one.requirement).back();
    };
    const std::string first = source_of(asked.front());
    if (std::ranges::all_of(asked, [&](const AskedBy& one) { return source_of(one) == first; })) {
        row.further.push_back(first);
        return;
    }
    for (const AskedBy& one : asked)
        row.further.push_back(fmt::format("{}: {}", one.rule->profile.id, source_of(one)));
}

/// A requirement that several rules have: once what is alike, and beneath it what differs.
void add_clause(Block& block, const std::vector<AskedBy>& asked, std::size_t rules) {
    const Requirement& first = *asked.front().requirement;
    const auto alike = [&](auto member) {
        return std::ranges::all_of(
            asked, [&](const AskedBy& one) { return one.requirement->*member == first.*member; });
    };
    const bool one_state = alike(&Requirement::status),
               one_evidence = alike(&Requirement::evidence);
    std::vector<std::string> names;
    RequirementStatus worst = first.status;
    for (const AskedBy& one : asked) {
        names.push_back(one.rule->profile.id);
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
    if (one_state && one_evidence) {
        row.further = requirement_lines(first);
        row.further.pop_back();
        add_sources(row, asked);
        return;
    }
    for (const AskedBy& one : asked)
        row.further.push_back(
            fmt::format("{}: {}{}", one.rule->profile.id,
                        one_state ? "" : state_text(one.requirement->status) + ": ",
                        one.requirement->evidence));
    add_sources(row, asked);
}

}  // namespace

Block requirements_table(const std::vector<RuleView>& rules) {
    std::vector<std::vector<AskedBy>> clauses;
    for (const RuleView& rule : rules)
        for (const Requirement& requirement : rule.verdict.requirements) {
            const auto same = std::ranges::find_if(clauses, [&](const auto& one) {
                return one.front().requirement->clause == requirement.clause &&
                       one.front().requirement->text == requirement.text;
            });
            if (same == clauses.end())
                clauses.push_back({{&rule, &requirement}});
            else
                same->push_back({&rule, &requirement});
        }
    Block block = table({"State|13", "Requirement|47", "Evidence|40"});
    block.slot = "clauses";
    for (const std::vector<AskedBy>& clause : clauses)
        add_clause(block, clause, rules.size());
    return block;
}

bool holds(const std::vector<Fact>& facts, const Fact& one) {
    return std::ranges::any_of(
        facts, [&](const Fact& fact) { return fact.name == one.name && fact.value == one.value; });
}

SaidOfAll said_of_all(const std::vector<RuleView>& rules, Level from, Level to) {
    if (rules.size() < 2) return {};
    SaidOfAll said{.facts = decision_facts(rules.front(), from, to).facts,
                   .notes = rules.front().verdict.notes};
    for (const RuleView& rule : rules) {
        const std::vector<Fact> own = decision_facts(rule, from, to).facts;
        std::erase_if(said.facts, [&](const Fact& fact) { return !holds(own, fact); });
        std::erase_if(said.notes, [&](const std::string& note) {
            return std::ranges::find(rule.verdict.notes, note) == rule.verdict.notes.end();
        });
    }
    return said;
}

std::vector<Block> windows_of_all(const std::vector<RuleView>& rules) {
    std::vector<Block> blocks;
    blocks.push_back(row_for_each(
        {"Rule|26", "Begins (UTC, or from the first epoch)|27", ">Length|13", ">Ends apart|13",
         ">95 % radius|10", ">Compared|11"},
        "Windows", rules, [](const RuleView& rule) {
            const CertifiableWindow& best = *rule.best();
            return std::vector<std::string>{
                best.span.start_gps ? to_utc_iso(*best.span.start_gps, 3)
                                    : seconds_text(best.span.start),
                seconds_text(best.span.duration), format_fixed(best.displacement_m, 3) + " m",
                format_fixed(best.position_r95_m, 3) + " m", counted(rule.windows->candidates)};
        }));
    blocks.push_back(
        row_for_each({"Rule|26", "Unit|8", ">The rule's|14", ">Displacement|14", ">Path length|13",
                      ">Mean, both ends|13", ">Mean after the first|12"},
                     "Speed by each definition", rules, [](const RuleView& rule) {
                         const CertifiableWindow& best = *rule.best();
                         std::vector<std::string> cells{std::string(rule.unit().name),
                                                        speed_of(rule, best.speed_m_s)};
                         for (const SpeedDefinition name :
                              {SpeedDefinition::displacement, SpeedDefinition::path_length,
                               SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n})
                             cells.push_back(speed_of(rule, speed_by(best.definitions, name)));
                         return cells;
                     }));
    Block own = facts({}, "By each rule's own arithmetic", "narrow");
    for (const RuleView& rule : rules)
        add_fact(own, rule.profile.id, own_arithmetic_text(rule.verdict.own_arithmetic));
    blocks.push_back(std::move(own));
    for (const RuleView& rule : rules) {
        if (rule.best() == nullptr) continue;
        std::vector<Block> more = points_and_further_blocks(rule);
        if (more.empty()) continue;
        blocks.push_back(heading(rule.titled("Window")));
        add(blocks, std::move(more));
    }
    return blocks;
}

}  // namespace runcert
