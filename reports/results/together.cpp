#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "core/prose.h"
#include "core/rounding.h"
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

/// What a source contributes under a rule, in its unit; empty where its budget has no such row.
std::string contribution_of(const RuleView& rule, const std::string& source) {
    const auto& budget = rule.best()->budget;
    const auto row = std::ranges::find(budget, source, &BudgetRow::source);
    return row == budget.end() ? ""
                               : significant_text(row->contribution_m_s * rule.unit().per_m_s, 2);
}

/// A requirement under a rule.
struct AskedBy {
    const RuleView* rule = nullptr;
    const Requirement* requirement = nullptr;
};

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
        return;
    }
    for (const AskedBy& one : asked)
        row.further.push_back(
            fmt::format("{}: {}{}", one.rule->profile.id,
                        one_state ? "" : state_text(one.requirement->status) + ": ",
                        one.requirement->evidence));
    row.further.push_back(requirement_lines(first).back());
}

}  // namespace

Block requirements_of_all(const std::vector<RuleView>& rules) {
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

std::vector<std::string> said_of_all(const std::vector<RuleView>& rules) {
    std::vector<std::string> shared;
    for (const std::string& note : rules.front().verdict.notes)
        if (std::ranges::all_of(rules, [&](const RuleView& rule) {
                return std::ranges::find(rule.verdict.notes, note) != rule.verdict.notes.end();
            }))
            shared.push_back(note);
    return shared;
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
    return blocks;
}

std::vector<Block> budgets_of_all(const std::vector<RuleView>& rules) {
    std::vector<RuleView> certified;
    std::vector<std::string> sources;
    for (const RuleView& rule : rules) {
        if (rule.best() == nullptr) continue;
        certified.push_back(rule);
        for (const BudgetRow& row : rule.best()->budget)
            if (std::ranges::find(sources, row.source) == sources.end())
                sources.push_back(row.source);
    }
    if (certified.empty()) return {};
    constexpr std::size_t of_sources = 30;
    const std::size_t width = (100 - of_sources) / certified.size();
    std::vector<std::string> heads{
        fmt::format("Contribution to the standard uncertainty|{}", of_sources)};
    Block legend = facts({}, "Budgets", "narrow");
    for (std::size_t i = 0; i < certified.size(); ++i) {
        heads.push_back(fmt::format(">Rule {}, {}|{}", i + 1, certified[i].unit().name, width));
        add_fact(legend, fmt::format("Rule {}", i + 1),
                 fmt::format("{}: {}", certified[i].profile.id,
                             measured_speed_text(certified[i].shown(),
                                                 certified[i].verdict.coverage_factor)));
    }
    Block block = table(heads, {}, "small");
    const auto add_each = [&](const std::string& name, const auto& cell, const char* mark) {
        std::vector<std::string> cells{name};
        for (const RuleView& rule : certified)
            cells.push_back(cell(rule));
        add_row(block, std::move(cells), mark);
    };
    for (const std::string& source : sources)
        add_each(
            source, [&](const RuleView& rule) { return contribution_of(rule, source); }, "");
    add_each(
        "Combined standard uncertainty",
        [](const RuleView& rule) {
            return significant_text(rule.best()->standard_uncertainty_m_s * rule.unit().per_m_s, 2);
        },
        "total");
    add_each(
        "Expanded uncertainty, with the limit of the bias of choosing",
        [](const RuleView& rule) {
            return uncertainty_rounded_up(
                expanded_uncertainty_m_s(*rule.best(), rule.verdict.coverage_factor) *
                rule.unit().per_m_s);
        },
        "total");
    return {std::move(legend), std::move(block),
            paragraph("Estimates, distributions, sensitivities and undetected errors of each rule: "
                      "runcert audit RUN_FOLDER.",
                      "note")};
}

}  // namespace runcert
