#include "attest_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "trust/roster.h"
#include "trust/run_standing.h"

namespace runcert {
namespace {

constexpr std::size_t indent = 6;

std::string full_name(const DueClause& clause) {
    return clause.profile + "/" + clause.clause;
}

std::string indented(const std::string& text) {
    return std::string(indent, ' ') + wrapped(text, indent, indent);
}

std::vector<std::string> names_of(const std::vector<DueClause>& clauses) {
    std::vector<std::string> names;
    for (const DueClause& clause : clauses)
        names.push_back(shown(full_name(clause)));
    return names;
}

[[noreturn]] void refuse_name(const std::string& name, const std::vector<DueClause>& due) {
    throw Failure(shown(name), "nothing of that name is to be attested",
                  due.empty() ? std::string("Every requirement of this report is decided by itself")
                              : "Name one of these: " + listed(names_of(due)));
}

/// What one role answers for.
void print_role(const RunStanding& standing, const std::string& role, const std::string& run) {
    std::string open;
    std::set<std::string> named;
    fmt::print("{} answers:\n", plain_text(role));
    for (const RuleStanding& rule : standing.rules)
        for (const ClauseStanding& clause : rule.clauses) {
            if (clause.due.answered_by.role != role) continue;
            fmt::print("{}{}", clause_heading(clause.due), clause_figures(clause.due));
            for (const std::string& words : clause_words(clause))
                fmt::print("{}", indented(words));
            if (clause.missing > 0 && named.insert(clause.due.clause).second)
                open += " " + shell_word(plain_text(clause.due.clause));
        }
    if (!open.empty())
        fmt::print("  to answer: runcert attest {}{} --role {} --key KEY\n", shell_word(run), open,
                   plain_text(role));
    fmt::print("\n");
}

}  // namespace

std::string clause_heading(const DueClause& clause) {
    return fmt::format("  {}\n{}", plain_text(full_name(clause)), indented(clause.text));
}

std::string clause_figures(const DueClause& clause) {
    return indented(clause.shown);
}

std::vector<DueClause> chosen_clauses(const ReportFacts& report,
                                      const std::vector<std::string>& names,
                                      const std::string& profile, const std::string& role) {
    const std::vector<DueClause> due = due_clauses(report);
    std::vector<DueClause> chosen;
    for (const std::string& name : names) {
        std::vector<DueClause> named;
        std::ranges::copy_if(due, std::back_inserter(named), [&](const DueClause& one) {
            return (name == one.clause || name == full_name(one)) &&
                   (profile.empty() || profile == one.profile);
        });
        if (named.empty()) refuse_name(name, due);
        for (const DueClause& one : named)
            if (one.answered_by.role != role)
                throw Failure(shown(full_name(one)),
                              fmt::format("{} answers for it, not {}", one.answered_by.role, role),
                              "Have it answered in that role; `runcert attest RUN` lists who "
                              "answers what");
        for (DueClause& one : named)
            if (std::ranges::none_of(chosen, [&](const DueClause& other) {
                    return full_name(other) == full_name(one);
                }))
                chosen.push_back(std::move(one));
    }
    return chosen;
}

int list_clauses(const std::filesystem::path& run_dir, const std::string& known_as,
                 const std::string& roster) {
    const ReportFacts report = read_report_facts(run_dir);
    const RunStanding standing = stated_standing(run_dir, report, read_roster(roster));
    std::vector<std::string> roles;
    for (const DueClause& clause : due_clauses(report))
        if (std::ranges::find(roles, clause.answered_by.role) == roles.end())
            roles.push_back(clause.answered_by.role);
    fmt::print("report  {} of {}\n\n", report.report_id, report.attempt_id);
    for (const std::string& role : roles)
        print_role(standing, role, known_as);
    for (const GivenAnswer& one : standing.given.whole)
        fmt::print("{}\n", plain_text(answer_words(one)));
    for (const std::string& fault : standing.given.faults)
        fmt::print("{}\n", plain_text(fault));
    for (const std::string& line : standing_lines(standing, true))
        fmt::print("{}\n", plain_text(line));
    return 0;
}

}  // namespace runcert
