#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text.h"
#include "reports/explain/explain.h"

namespace runcert {
namespace {

/// A clause of this program's own, and who answers for it.
std::string with_role(const Clause& own) {
    return fmt::format("{} ({})", own.id, own.answered_by.role);
}

/// By whom: the clauses of this program's own that its computations decide, or what a rule's is
/// about; else the clause that it names.
std::string answered_in(const FieldOrigin& origin) {
    const std::vector<Clause>& own = own_clauses();
    std::vector<std::string> clauses;
    for (const std::string& computation : origin.decides) {
        const auto decided = std::ranges::find(
            own, computation, [](const Clause& clause) { return to_text(clause.decided_by); });
        clauses.push_back(decided == own.end() ? fmt::format("the rule's by `{}`", computation)
                                               : with_role(*decided));
    }
    if (const auto named = std::ranges::find(own, origin.clause, &Clause::id); named != own.end())
        clauses.push_back((clauses.empty() ? "" : "else ") + with_role(*named));
    return fmt::format("{}", fmt::join(clauses, ", "));
}

}  // namespace

std::string inputs_table_text() {
    std::string text =
        "| input | origin | can change | answered for in (by) |\n|---|---|---|---|\n";
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!rule.origin || rule.origin->changes.empty()) continue;
        std::string origin = rule.origin->origin;
        std::ranges::replace(origin, '_', ' ');
        text += fmt::format("| `{}` | {} | {} | {} |\n", rule.path, origin,
                            fmt::join(rule.origin->changes, ", "), answered_in(*rule.origin));
    }
    return text;
}

Document profiles_document(const std::vector<Profile>& profiles) {
    Block rules = table({"", ""});
    for (const Profile& profile : profiles) {
        TableRow& row = add_row(rules, {profile.id, sentence(profile.title)});
        row.further = {
            sentence(profile.body),
            profile.evidence
                ? "Evidence, asked under every other rule of the attempt."
                : fmt::format(
                      "Speed over {}{}.", window_words(profile),
                      profile.windows == 1 ? "" : fmt::format(", mean of {}", profile.windows))};
        const auto add_line = [&](std::string_view what, const std::string& value) {
            if (!value.empty()) row.further.push_back(fmt::format("{} {}.", what, value));
        };
        add_line("Texts looked at until", profile.looked_at);
        add_line("For runs from", profile.valid_from);
        add_line("Superseded by", profile.superseded_by);
    }
    return {.title = "Rules that come with the program",
            .sections = {{.anchor = "rules", .blocks = {std::move(rules)}}}};
}

std::string citations_text(const std::vector<Profile>& profiles) {
    std::string text =
        "| rule | clause | source | edition | where | certainty | decided by |\n"
        "|---|---|---|---|---|---|---|\n";
    const auto add = [&](std::string_view rule, const Clause& clause) {
        text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", rule, clause.id,
                            clause.source, clause.edition, clause.where, to_text(clause.certainty),
                            to_text(clause.decided_by));
    };
    for (const Profile& profile : profiles) {
        for (const Clause& clause : profile.clauses)
            add(profile.id, clause);
        for (const RuleQuestion& question : profile.questions)
            text += fmt::format("| {} | {} | {} | | | not known | question for the body |\n",
                                profile.id, question.id, question.source);
    }
    for (const Clause& own : own_clauses())
        add("every rule", own);
    return text;
}

}  // namespace runcert
